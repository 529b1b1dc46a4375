#include "train/loss_schedule.h"

#include <cmath>

namespace aligngs {
namespace {

template <auto Group, auto Member>
const double& setting(const TrainConfig& config) {
  return config.*Group.*Member;
}

using C = TrainConfig;
using L = LossConfig;
using S = SemanticConfig;

// clang-format off
constexpr std::array<ScheduledLoss, kLosses> kSchedule = {{
    {Loss::kL1,                     "loss.l1",                      setting<&C::loss, &L::l1>,                     nullptr,                                 kAlways},
    {Loss::kSsim,                   "loss.ssim",                    setting<&C::loss, &L::ssim>,                   nullptr,                                 kAlways},
    // the engine divides the scales by the extent
    {Loss::kFlatten,                "loss.flatten",                 setting<&C::loss, &L::flatten>,                nullptr,                                 kAlways},
    {Loss::kSemanticSoft,           "semantic.soft",                setting<&C::semantic, &S::soft>,               nullptr,                                 kGateSemantics},
    {Loss::kSemanticHard,           "semantic.hard",                setting<&C::semantic, &S::hard>,               nullptr,                                 kGateSemantics},
    {Loss::kPearson,                "loss.pearson",                 setting<&C::loss, &L::pearson>,                nullptr,                                 kGateDepth | kGateCorrelated},
    {Loss::kLogDepth,               "loss.log_depth",               setting<&C::loss, &L::log_depth>,              setting<&C::loss, &L::log_depth_end>,    kGateDepth | kGateMetric},
    {Loss::kNormalConsistency,      "loss.normal_consistency",      setting<&C::loss, &L::normal_consistency>,     nullptr,                                 kGateNormals},
    {Loss::kNormalBoundary,         "loss.normal_boundary",         setting<&C::loss, &L::normal_boundary>,        nullptr,                                 kGateNormals | kGateSemantics},
    {Loss::kCrease,                 "loss.crease",                  setting<&C::loss, &L::crease>,                 nullptr,                                 kGateNormals | kGateSemantics | kGateMetric},
    {Loss::kPriorNormal,            "loss.prior_normal",            setting<&C::loss, &L::prior_normal>,           setting<&C::loss, &L::prior_normal_end>, kGateMetric},
    {Loss::kOpacityL1,              "loss.opacity_l1",              setting<&C::loss, &L::opacity_l1>,             nullptr,                                 kAlways},
    {Loss::kScaleL1,                "loss.scale_l1",                setting<&C::loss, &L::scale_l1>,               nullptr,                                 kAlways},
    {Loss::kMultiViewGeometric,     "loss.multi_view_geometric",    setting<&C::loss, &L::multi_view_geometric>,   nullptr,                                 kGateTwoViews},
    {Loss::kMultiViewPhotometric,   "loss.multi_view_photometric",  setting<&C::loss, &L::multi_view_photometric>, nullptr,                                 kGateTwoViews},
}};
// clang-format on

constexpr bool follows_the_catalogue() {
  for (size_t i = 0; i < kLosses; ++i) {
    if (index_of(kSchedule[i].loss) != i) return false;
  }
  return true;
}
static_assert(follows_the_catalogue(), "row i of the schedule belongs to row i of the catalogue");

}  // namespace

const std::array<ScheduledLoss, kLosses>& scheduled_losses() { return kSchedule; }

PerLoss<float> scheduled_weights(const TrainConfig& config, unsigned open, double share) {
  PerLoss<float> weights;
  for (const ScheduledLoss& row : kSchedule) {
    if ((row.gates & ~open) != 0) continue;
    const double start = row.start(config);
    weights[row.loss] = static_cast<float>(row.end == nullptr ? start : log_linear(start, row.end(config), share));
  }
  return weights;
}

bool settings_need(const TrainConfig& config, unsigned needs) {
  for (const ScheduledLoss& row : kSchedule) {
    if (row.start(config) > 0 && (row_of(row.loss).needs & needs) != 0) return true;
  }
  return false;
}

double log_linear(double start, double end, double t) {
  if (start <= 0) return 0;
  return std::exp((1 - t) * std::log(start) + t * std::log(end));
}

}  // namespace aligngs
