// Removal of Gaussians that float in free space.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "gaussians/gaussian_model.h"
#include "scene/camera.h"

namespace aligngs {

/// Free space of one training view. Maps have the camera's size; pointers are borrowed.
struct FreeSpaceView {
  Camera camera;
  const ImageF* prior_depth = nullptr;   ///< metric prior, 0 = none; null: no prior
  const ImageF* prior_weight = nullptr;  ///< confidence of it in [0, 1]; null: 1
  float prior_scale = 1;                 ///< a_v by which the prior is multiplied
  const ImageF* median_depth = nullptr;  ///< rendered median intersection depth, 0 = none
};

struct FreeSpaceRule {
  double prior_relative = 0.04;     ///< in front of the prior by more than this share of its depth ...
  double prior_offset = 0;          ///< ... plus this length, scene units (about 2 cm in a room)
  double prior_weight_min = 0.5;    ///< a prior below this confidence carves nothing
  double rendered_relative = 0.05;  ///< in front of the rendered median depth by more than this share
  double agreement = 0.03;          ///< a view supports a Gaussian within this share of its rendered depth
  int support_pixels = 4;           ///< on at least so many of the 3 x 3 pixels around the projected centre
  int support_views = 2;            ///< a Gaussian with this many supporting views stays
};

/// One flag per Gaussian, 0 = remove: its centre lies in front of the surface in at least one view and fewer
/// than `support_views` views support it. Centres outside every view stay. The same for any thread count.
std::vector<uint8_t> free_space_keep(const GaussianModel& model, const std::vector<FreeSpaceView>& views,
                                     const FreeSpaceRule& rule, ThreadPool& pool);

}  // namespace aligngs
