// Growing and pruning: decisions from per-Gaussian statistics, expressed as a plan that an engine carries out.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/random.h"
#include "gaussians/gaussian_model.h"

namespace aligngs {

/// Sums since the last reset, one entry per Gaussian. Gradients are of the photometric loss only,
/// and of the 2-D mean in normalised device coordinates (pixels * size / 2), as in 3DGS.
struct DensityStatistics {
  std::vector<float> gradient;      ///< sum over views of |d L / d mean2D|
  std::vector<float> gradient_abs;  ///< sum over views of | sum over pixels of |d L / d mean2D| | (AbsGS)
  std::vector<float> visible;       ///< number of views in which the Gaussian touched a pixel
  std::vector<float> radius;        ///< largest 2-D radius seen, pixels
  std::vector<float> weight;        ///< sum of blending weights w
  std::vector<float> residual;      ///< sum of w * photometric residual (mean absolute colour difference)
  std::vector<float> unsupported;   ///< sum of w on pixels whose prior depth is absent or disagrees (> 5 %)
};

/// One row of the model after restructuring.
struct RowOrigin {
  enum class Kind : uint8_t {
    kKeep,   ///< the source row with its moments
    kClone,  ///< a copy of the parameters displaced by `offset`, zero moments
    kSplit   ///< a copy displaced by `offset` with scales divided by `shrink`, zero moments
  };
  uint32_t source = 0;
  Kind kind = Kind::kKeep;
  float offset[3] = {0, 0, 0};  ///< world units, added to the position
  float shrink = 1;             ///< scales are divided by this
  /// Value of a copy; NaN: that of the source.
  float opacity_logit = std::numeric_limits<float>::quiet_NaN();
};

/// The rows of the new model in order. Rows absent from the plan are gone.
struct RestructurePlan {
  std::vector<RowOrigin> rows;
  size_t cloned = 0, split = 0, pruned = 0;
};

/// Parameters of adaptive density control (3DGS, Kerbl et al. 2023, and ours). Lengths are scene units.
/// Without values nothing grows and nothing is removed; the settings (densify.*) have the values.
struct DensityRule {
  /// mean 2-D gradient above which a Gaussian grows
  float gradient_threshold = std::numeric_limits<float>::infinity();
  float gradient_abs_threshold = 0;  ///< mean absolute gradient above which a large one splits; 0 = off
  float abs_min_radius = 20;         ///< pixels; the absolute rule needs a larger radius
  size_t abs_max_splits = 50000;     ///< per call
  float small_scale = 0;             ///< at most this: clone; larger: split (0.001 * extent)
  float prune_opacity = 0;           ///< below it a Gaussian is removed
  float prune_scale = 0;             ///< largest scale above which a Gaussian is removed; 0 = off
  size_t max_gaussians = 0;          ///< cap; growth stops there, the largest gradients first; 0 = none
  float residual_quantile = 0;       ///< grow only in the top (1 - q) of mean residual; 0 = off
  float unsupported_min = 0;         ///< grow only where this share of the weight lacks prior support; 0 = off
  bool grow = true;                  ///< false: prune only
  bool morton_order = false;         ///< the plan's rows in the order of morton_order.h
};

/// The plan of one call of adaptive density control (3DGS, Kerbl et al. 2023, section 5.2). First, rows with a large
/// mean gradient are cloned when small, the copy drawn from the Gaussian itself. When large, they are split into two of
/// 1 / 1.6 the size. Then transparent and oversized rows are removed, children included. New rows follow the kept ones,
/// unless the rule orders them. Random numbers are drawn only for rows that grow, in row order. Error{kFailed} when the
/// statistics do not have one entry per Gaussian.
RestructurePlan plan_density_control(const GaussianModel& model, const DensityStatistics& statistics,
                                     const DensityRule& rule, Random& random);

/// A plan that keeps the rows whose flag is set.
RestructurePlan plan_keep(const std::vector<uint8_t>& keep);

}  // namespace aligngs
