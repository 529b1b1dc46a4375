#include "refine/search_photos.h"

#include <algorithm>
#include <cmath>

#include "io/resample.h"
#include "scene/corners.h"

namespace aligngs {

SearchPhotos::SearchPhotos(const std::vector<TrackPhoto>& photos, bool wide) {
  for (const TrackPhoto& photo : photos) {
    const MatchView& given = *photo.match;
    const double shrink = wide ? std::sqrt(std::max(1.0, relative_size(given.luma))) : 1;
    if (!(shrink > 1)) {
      photos_.push_back({photo.match, photo.mask, 1, 1});
      continue;
    }
    const int width = std::max(1, static_cast<int>(std::lround(given.luma.width / shrink)));
    const int height = std::max(1, static_cast<int>(std::lround(given.luma.height / shrink)));
    Copy& copy = copies_.emplace_back();
    copy.match.camera = given.camera.resized(width, height);
    copy.match.luma = resize_area(given.luma, width, height);
    if (!given.depth.empty()) copy.match.depth = resize_depth(given.depth, width, height);
    if (photo.mask && !photo.mask->empty()) copy.mask = resize_nearest(*photo.mask, width, height);
    photos_.push_back({&copy.match, &copy.mask, static_cast<double>(given.luma.width) / width,
                       static_cast<double>(given.luma.height) / height});
  }
}

const ImageF& SearchPhotos::mask(size_t photo) const {
  static const ImageF none;
  return photos_[photo].mask ? *photos_[photo].mask : none;
}

std::vector<const MatchView*> SearchPhotos::matches() const {
  std::vector<const MatchView*> out;
  for (const Searched& photo : photos_) out.push_back(photo.match);
  return out;
}

Vec2d SearchPhotos::to_given(size_t photo, const Vec2d& pixel) const {
  return {pixel.x * photos_[photo].across, pixel.y * photos_[photo].down};
}

Vec2d SearchPhotos::from_given(size_t photo, const Vec2d& pixel) const {
  return {pixel.x / photos_[photo].across, pixel.y / photos_[photo].down};
}

Match SearchPhotos::to_given(size_t photo, Match found) const {
  const Searched& p = photos_[photo];
  found.pixel = to_given(photo, found.pixel);
  found.covariance.xx *= p.across * p.across;
  found.covariance.xy *= p.across * p.down;
  found.covariance.yy *= p.down * p.down;
  return found;
}

}  // namespace aligngs
