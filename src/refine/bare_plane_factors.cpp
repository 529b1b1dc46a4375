#include "refine/bare_plane_factors.h"

#include <algorithm>
#include <cmath>

#include "core/is_depth.h"

namespace aligngs {

BarePlaneFactors bare_plane_factors(const std::vector<MatchView>& photos, const std::vector<Image<uint16_t>>& labels,
                                    const std::vector<ImageF>& certainty, const BarePlaneSettings& settings,
                                    const StereoSettings& stereo, const KnownSurfaces& known, ThreadPool& pool) {
  std::vector<PhotoDepth> depths;
  for (size_t i = 0; i < photos.size(); ++i) {
    depths.push_back({photos[i].depth, certainty[i], 0});
    ImageF& sure = depths.back().certainty;
    if (sure.empty()) sure = ImageF(photos[i].depth.width, photos[i].depth.height, 1);
    for (float& value : sure.data) value = std::min(value, 1.0f);
  }
  BarePlaneFactors result;
  result.report = lay_on_bare_planes(photos, labels, settings, stereo, pool, depths, known);
  for (size_t i = 0; i < photos.size(); ++i) {
    const ImageF &before = photos[i].depth, &after = depths[i].depth;
    ImageF factor(before.width, before.height, 1);
    for (size_t p = 0; p < factor.data.size(); ++p) {
      if (is_depth(before.data[p]) && is_depth(after.data[p]))
        factor.data[p] = std::log(after.data[p] / before.data[p]);
    }
    result.log_factors.push_back(std::move(factor));
  }
  return result;
}

}  // namespace aligngs
