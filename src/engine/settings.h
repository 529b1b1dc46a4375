// The request for one training step: plain numbers, which train/schedule.h makes of the settings for each step. Losses
// are off, and lengths are in scene units. The table of the settings alone has what a setting means and its value
// (train/config_keys.h). Constants of the rasteriser and of Adam have their published values.
#pragma once

#include <cstdint>

#include "engine/formulas/opacity_dropout.h"
#include "engine/formulas/semantic_sample.h"
#include "engine/loss_catalogue.h"

namespace aligngs {

/// Constants of the rasteriser (3DGS, Kerbl et al. 2023).
struct RasterSettings {
  float near_plane = 0.01f;         ///< camera z below which a Gaussian is culled, scene units
  float low_pass = 0.3f;            ///< pixels^2 added to the diagonal of the 2-D covariance
  float alpha_min = 1.0f / 255.0f;  ///< contributions below are skipped
  float alpha_max = 0.99f;          ///< alpha is clamped to this
  float transmittance_min = 1e-4f;  ///< blending stops before transmittance falls below
  /// t_x / t_z is clamped to this multiple of the image's half angle in the Jacobian
  float guard_band = 1.3f;
  float background[3] = {0, 0, 0};
  OpacityDropout dropout;  ///< of a training step; pictures are drawn without
  /// Tests only: replaces the hard alpha_min cut by a C1 ramp over [alpha_min, 2 alpha_min] so that finite
  /// differences hold near the threshold. The clamp at alpha_max has zero gradient above it, also in use.
  bool smooth_cutoff = false;
};

enum class SemanticBlend {
  kLogits,        ///< of the paper: P = sum w s, softmax per pixel
  kProbabilities  ///< ours: pi = softmax(s) per Gaussian, Q = sum w pi + (1 - A) / C
};

enum class SemanticCoupling {
  kPlain,  ///< the gradient of the loss as printed reaches alpha, multiplied by coupling_strength
  /// ours, for experiments: gradient of 1/2 |Q - t|^2 with Q / A, scaled to a share of the photometric gradient
  kBounded,
  kOpacity  ///< a control: as much as kBounded, but every weight is pushed up alike, whatever the classes
};
/// Whether the coupling is scaled to a share of the photometric gradient and weighted by omega.
constexpr bool is_balanced(SemanticCoupling coupling) { return coupling != SemanticCoupling::kPlain; }

/// Weights and switches of the losses.
struct LossSettings {
  /// A weight of 0 turns a loss off and costs nothing. The multi-view losses act in steps with a neighbour alone
  /// (StepRequest::neighbour).
  PerLoss<float> weight;

  SemanticSample semantic_sample;  ///< pixels that the two semantic terms and their coupling take in this step
  SemanticBlend semantic_blend{};
  SemanticCoupling coupling{};
  /// kPlain: factor on the gradient (0 = release, 1 = paper). Else: target ratio of RMS gradients.
  float coupling_strength = 0;

  float log_depth_huber = 0;  ///< Huber delta of L_z, log units; L_z needs one above 0
  /// a_v of L_z: this view's prior depth is multiplied by it (train/prior_alignment.h); 1 leaves it as it is
  float prior_depth_scale = 1.0f;
  /// L_ng and L_nb as printed, without discontinuity guards, over pixels with a normal
  bool paper_normals = false;

  /// Some loss of this stage has a weight.
  constexpr bool has(LossStage stage) const {
    for (const LossRow& row : kLossCatalogue) {
      if (row.stage == stage && weight[row.loss] != 0) return true;
    }
    return false;
  }
  /// Some loss looks at normal, distance or alpha.
  constexpr bool has_geometry_terms(bool neighbour) const {
    return has(LossStage::kGeometry) || (neighbour && has(LossStage::kTwoViews));
  }
  /// Some loss that acts needs one of these inputs; `needs`: bits of LossNeeds.
  constexpr bool needs(unsigned needs, bool neighbour) const {
    for (const LossRow& row : kLossCatalogue) {
      if (weight[row.loss] != 0 && (row.needs & needs) != 0 && (neighbour || row.stage != LossStage::kTwoViews))
        return true;
    }
    return false;
  }
};

/// Adam rates of one step. Positions and scales are in scene units, so the trainer multiplies by the extent.
struct LearningRates {
  float position = 0, sh_dc = 0, sh_rest = 0, opacity = 0, scale = 0, rotation = 0, semantic = 0;
};

struct AdamSettings {
  float beta1 = 0.9f, beta2 = 0.999f, epsilon = 1e-15f;
  /// Semantic rows that no pixel used this step keep parameters and moments.
  bool skip_invisible_semantics = false;
};

/// Hard limits applied after the optimiser step; 0 = off.
struct ShapeLimits {
  float flat_ratio_max = 0;  ///< smallest scale <= this share of the middle one
  float aspect_max = 0;      ///< largest scale <= this multiple of the middle one
  float scale_max = 0;       ///< largest scale, scene units
};

/// The other view of a step's multi-view terms; nothing of it is trained in this step.
struct NeighbourRequest {
  int view = -1;         ///< index into the training views, not that of the step; -1: the step has no neighbour
  float near_plane = 0;  ///< RasterSettings::near_plane of that view
  uint64_t seed = 0;     ///< draws the pixels of the photometric term
};

struct StepRequest {
  int view = 0;      ///< index into the training views
  int64_t step = 1;  ///< 1-based, for Adam's bias correction
  int sh_degree = 0;
  LossSettings losses;
  LearningRates rates;
  AdamSettings adam;
  ShapeLimits limits;
  RasterSettings raster;
  bool collect_density = true;  ///< accumulate density statistics (photometric gradients only)
  bool pose_gradient = false;   ///< report how the losses change with the pose of the view
  float extent = 1;             ///< robust scene extent, scene units
  NeighbourRequest neighbour;

  /// How the neighbour is drawn: whole, from its own near plane.
  RasterSettings neighbour_raster() const {
    RasterSettings r = raster;
    r.near_plane = neighbour.near_plane;
    r.dropout = {};
    return r;
  }
  bool has_multi_view_terms() const { return neighbour.view >= 0 && losses.has(LossStage::kTwoViews); }
  bool has_geometry_terms() const { return losses.has_geometry_terms(neighbour.view >= 0); }
};

}  // namespace aligngs
