// The one table of losses. Their values, weights, total, checks, events, charts, benchmark and test cases follow from
// it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>

#include "core/host_device.h"

namespace aligngs {

/// Rows of kLossCatalogue, in its order.
enum class Loss : uint8_t {
  kL1,
  kSsim,
  kFlatten,
  kSemanticSoft,
  kSemanticHard,
  kPearson,
  kLogDepth,
  kNormalConsistency,
  kNormalBoundary,
  kCrease,
  kPriorNormal,
  kOpacityL1,
  kScaleL1,
  kMultiViewGeometric,
  kMultiViewPhotometric
};

/// The part of a training step that computes a loss.
enum class LossStage : uint8_t {
  kColor,      ///< of blended colours (losses/photometric.h)
  kGeometry,   ///< of blended normals and distances (losses/map_losses.h)
  kTwoViews,   ///< of those and a neighbouring view (losses/neighbour_view.h)
  kSemantics,  ///< in the visit of the tiles (formulas/semantic_loss.h)
  kShape       ///< of the Gaussians' own parameters (formulas/shape_terms.h)
};

/// The stages in words, as titles of charts have them.
struct LossStageRow {
  LossStage stage;
  std::string_view title;  ///< behind "losses on"; ends with a 0
};
inline constexpr LossStageRow kLossStages[] = {{LossStage::kColor, "colour"},
                                               {LossStage::kGeometry, "depth and normals"},
                                               {LossStage::kTwoViews, "two views"},
                                               {LossStage::kSemantics, "classes"},
                                               {LossStage::kShape, "shape of the Gaussians"}};

/// Inputs of a loss; bits.
enum LossNeeds : uint8_t {
  kNeedsNothing = 0,
  kNeedsDepth = 1,         ///< plane depth; the loss has a gradient by it
  kNeedsGuardedDepth = 2,  ///< plane depth decides which pixels take part, unless LossSettings::paper_normals
  kNeedsUnitNormal = 4,    ///< directions of blended normals
  kNeedsPriorDepth = 8,
  kNeedsPriorNormal = 16,
  kNeedsLabels = 32
};

/// Those that a view may lack, beside what is rendered.
struct GivenInputs {
  bool prior_depth = false, prior_normal = false, labels = false;
  /// The view has all inputs that a loss with these `needs` (bits of LossNeeds) takes.
  ALIGNGS_HD constexpr bool suffice(unsigned needs) const {
    return ((needs & kNeedsPriorDepth) == 0 || prior_depth) && ((needs & kNeedsPriorNormal) == 0 || prior_normal) &&
           ((needs & kNeedsLabels) == 0 || labels);
  }
};

struct LossRow {
  Loss loss;
  std::string_view name;      ///< in events, charts and messages; ends with a 0
  std::string_view symbol;    ///< in docs/method.md
  std::string_view progress;  ///< in the line that a terminal shows during training; empty: not there
  LossStage stage;
  uint8_t needs;           ///< LossNeeds
  float benchmark_weight;  ///< of a step that is timed
};

// clang-format off
inline constexpr LossRow kLossCatalogue[] = {
    {Loss::kL1,                   "l1",                     "L1",           "L1",         LossStage::kColor,     kNeedsNothing,                                                          0.8f},
    {Loss::kSsim,                 "ssim",                   "SSIM",         "1-SSIM",     LossStage::kColor,     kNeedsNothing,                                                          0.2f},
    {Loss::kFlatten,              "flatten",                "flattening",   "",           LossStage::kShape,     kNeedsNothing,                                                          100.0f},
    {Loss::kSemanticSoft,         "semantic_soft",          "L_sem soft",   "semantic",   LossStage::kSemantics, kNeedsLabels,                                                           1.0f},
    {Loss::kSemanticHard,         "semantic_hard",          "L_sem hard",   "",           LossStage::kSemantics, kNeedsLabels,                                                           0.1f},
    {Loss::kPearson,              "pearson",                "L_d",          "1-rho",      LossStage::kGeometry,  kNeedsDepth | kNeedsPriorDepth,                                         0.05f},
    {Loss::kLogDepth,             "log_depth",              "L_z",          "depth",      LossStage::kGeometry,  kNeedsDepth | kNeedsPriorDepth,                                         0.5f},
    {Loss::kNormalConsistency,    "normal_consistency",     "L_ng",         "normal",     LossStage::kGeometry,  kNeedsDepth | kNeedsUnitNormal,                                         0.05f},
    {Loss::kNormalBoundary,       "normal_boundary",        "L_nb",         "",           LossStage::kGeometry,  kNeedsGuardedDepth | kNeedsUnitNormal | kNeedsLabels,                   0.01f},
    {Loss::kCrease,               "crease",                 "crease",       "",           LossStage::kGeometry,  kNeedsUnitNormal | kNeedsLabels | kNeedsPriorDepth | kNeedsPriorNormal, 0.05f},
    {Loss::kPriorNormal,          "prior_normal",           "prior normal", "",           LossStage::kGeometry,  kNeedsUnitNormal | kNeedsPriorNormal,                                   0.05f},
    {Loss::kOpacityL1,            "opacity_l1",             "mean opacity", "",           LossStage::kShape,     kNeedsNothing,                                                          0.01f},
    {Loss::kScaleL1,              "scale_l1",               "mean scale",   "",           LossStage::kShape,     kNeedsNothing,                                                          0.01f},
    {Loss::kMultiViewGeometric,   "multi_view_geometric",   "L_geo",        "views (px)", LossStage::kTwoViews,  kNeedsDepth,                                                            0.0f},
    {Loss::kMultiViewPhotometric, "multi_view_photometric", "L_ncc",        "1-NCC2",     LossStage::kTwoViews,  kNeedsDepth,                                                            0.0f},
};
// clang-format on
inline constexpr size_t kLosses = std::size(kLossCatalogue);

ALIGNGS_HD constexpr size_t index_of(Loss loss) { return static_cast<size_t>(loss); }
constexpr const LossRow& row_of(Loss loss) { return kLossCatalogue[index_of(loss)]; }

/// A number per loss.
template <class T>
struct PerLoss {
  T values[kLosses] = {};
  ALIGNGS_HD constexpr T& operator[](Loss loss) { return values[index_of(loss)]; }
  ALIGNGS_HD constexpr const T& operator[](Loss loss) const { return values[index_of(loss)]; }
};

/// Weights of a step that is timed.
constexpr PerLoss<float> benchmark_weights() {
  PerLoss<float> weights;
  for (const LossRow& row : kLossCatalogue) weights[row.loss] = row.benchmark_weight;
  return weights;
}

/// All losses of some stages, in the order of the catalogue.
template <class... Stages>
constexpr auto losses_of(Stages... stages) {
  struct Found {
    std::array<Loss, kLosses> losses{};
    size_t count = 0;
    constexpr const Loss* begin() const { return losses.data(); }
    constexpr const Loss* end() const { return losses.data() + count; }
  } found;
  for (const LossRow& row : kLossCatalogue) {
    if (((row.stage == stages) || ...)) found.losses[found.count++] = row.loss;
  }
  return found;
}

namespace loss_catalogue {
constexpr bool rows_are_in_order() {
  for (size_t i = 0; i < kLosses; ++i) {
    if (index_of(kLossCatalogue[i].loss) != i) return false;
  }
  return true;
}
static_assert(rows_are_in_order(), "row i of the catalogue belongs to value i of Loss");
constexpr bool every_stage_has_a_title() {
  for (const LossRow& row : kLossCatalogue) {
    bool found = false;
    for (const LossStageRow& stage : kLossStages) found = found || stage.stage == row.stage;
    if (!found) return false;
  }
  return true;
}
static_assert(every_stage_has_a_title());
}  // namespace loss_catalogue

}  // namespace aligngs
