// Work between steps: growing and pruning, free space, the scales of the prior depth.
#pragma once

#include <vector>

#include "core/random.h"
#include "core/thread_pool.h"
#include "engine/engine.h"
#include "gaussians/mcmc_growth.h"
#include "train/config.h"
#include "train/training_set.h"

namespace aligngs {

/// One call of density control: statistics from the engine, plan, restructuring, statistics reset.
RestructurePlan control_density(Engine& engine, const DensityRule& rule, Random& random);

/// The same as 3DGS-MCMC does it (gaussians/mcmc_growth.h).
RestructurePlan grow_by_mcmc(Engine& engine, const McmcRule& rule, Random& random);

/// Removes one Gaussian (the one that made a step non-finite).
RestructurePlan remove_gaussian(Engine& engine, int64_t row);

/// Renders every view's median depth and removes what floats in front of the surface (free_space.h).
RestructurePlan prune_free_space(Engine& engine, const std::vector<GuideView>& views,
                                 const std::vector<float>& depth_scales, const TrainConfig& config, double extent,
                                 const RasterSettings& raster, ThreadPool& pool);

/// Raises scales to `pixels` of the view that sees each Gaussian sharpest (smallest_scale.h).
void raise_small_scales(Engine& engine, const std::vector<GuideView>& views, double pixels, ThreadPool& pool);

/// The scale a_v of every view's prior depth (prior_alignment.h).
struct PriorScales {
  std::vector<float> scale;    ///< 1 where nothing tells; 0: depth that has no scale yet counts as none
  std::vector<uint8_t> known;  ///< 1: it stays; 0: renderings may change it
  std::vector<uint8_t> free;   ///< 1: to any value, as nothing else tells the scale of this view's depth
};

/// Depth of views that nothing places waits for the renderings.
void free_unplaced(const PriorUse& use, PriorScales& scales);

/// From the scene's points where a view sees enough of them.
PriorScales align_to_points(const std::vector<GuideView>& views, const PointCloud& cloud, double limit);

/// 1 for every view, to stay: of depth that was corrected or measured together with the cameras. The points of such a
/// scene may belong to the cameras before correction. They moved a development bedroom's walls outwards by 2 cm.
PriorScales scales_of_agreeing_depth(size_t views);

/// Updates the scales that are not known, from the rendered median depth. `known` and `free` as in PriorScales.
void align_to_renderings(const Engine& engine, const std::vector<GuideView>& views, const std::vector<uint8_t>& known,
                         const std::vector<uint8_t>& free, double limit, const RasterSettings& raster,
                         std::vector<float>& depth_scales);

}  // namespace aligngs
