// How well a photo shows a place.
#pragma once

#include <vector>

#include "edit/export/texture_bake.h"

namespace aligngs {

class PhotoWeight {
 public:
  struct Look {
    double weight = 0;  ///< [0, 1]; 0: the photo does not show the place
    Vec2d pixel;
  };

  PhotoWeight(const TexturePhoto& photo, double extent, double texel, const BakeSettings& settings);
  /// `normal`: unit.
  Look at(const Vec3f& place, const Vec3f& normal) const;
  /// sRGB in [0, 1], between pixel centres.
  Vec3d color(const Vec2d& pixel) const;

 private:
  const TexturePhoto& photo_;
  BakeSettings settings_;
  Vec3d centre_;
  double tolerance_;   ///< units
  double texel_;       ///< units
  ImageF silhouette_;  ///< weight of each pixel
};

std::vector<PhotoWeight> photo_weights(const TexturePhotos& photos, double extent, double texel,
                                       const BakeSettings& settings, ThreadPool& pool);

}  // namespace aligngs
