// Opinion of each training photo about each Gaussian that it shows, and its weight.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "engine/settings.h"
#include "engine/training_view.h"
#include "gaussians/gaussian_model.h"

namespace aligngs {

/// One photo's word on one Gaussian.
struct PhotoOpinion {
  static constexpr size_t kNames = 4;  ///< what is beyond the fourth class is next to nothing
  enum Trait { kConfidence, kDistance, kAngle, kBorder, kTraits };

  uint32_t gaussian = 0;
  float votes = 0;                ///< pixels: blending weights times probabilities, all classes together
  uint16_t channel[kNames] = {};  ///< of the teacher's maps, most votes first
  float share[kNames] = {};       ///< of the votes; 0: no further class
  /// share of the first class; distance; |cosine| of the viewing angle; distance to the image's border, pixels
  float trait[kTraits] = {};
  float weight = 1;  ///< times which its votes count
};

struct PhotoOpinions {
  int channels = 0;                                 ///< of the teacher's maps
  std::vector<std::vector<PhotoOpinion>> of_photo;  ///< by ascending Gaussian
};

/// Gathers them. `views` have their cameras in place; near_planes are theirs. Gaussians hidden in a photo get only as
/// much of it as light reaches them. Less than a hundredth of a pixel is no opinion. The same for any number of
/// threads.
PhotoOpinions gather_opinions(const GaussianModel& model, const std::vector<TrainingView>& views,
                              const std::vector<float>& near_planes, const RasterSettings& raster, ThreadPool& pool);

/// Sums of votes times weights, [N][channels].
std::vector<float> sum_votes(const PhotoOpinions& opinions, size_t gaussians);

/// Sets the weights to the log-odds that such an opinion is right, by its traits. An opinion is right if it agrees with
/// the other photos' votes. The share of right opinions is measured for eight ranges of each trait. The traits'
/// log-odds against the mean add up as those of independent witnesses (naive Bayes). Never below a tenth, so that the
/// only photo of a thing still names it. Needs no truth.
void calibrate_opinions(size_t gaussians, PhotoOpinions& opinions);

}  // namespace aligngs
