#include "refine/hole_depth.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"

namespace aligngs {
namespace {

bool has_value(float depth) { return depth > 0 && std::isfinite(depth); }

/// Median |log ratio| where sensor and stereo both measured; 0 with too few such pixels.
double disagreement_of(const ImageF& sensor, const PhotoDepth& stereo, int least_common) {
  std::vector<float> ratios;
  for (size_t i = 0; i < sensor.data.size(); ++i) {
    if (!has_value(sensor.data[i]) || !(stereo.certainty.data[i] > 0) || !has_value(stereo.depth.data[i])) continue;
    ratios.push_back(std::abs(std::log(stereo.depth.data[i] / sensor.data[i])));
  }
  if (ratios.size() < static_cast<size_t>(least_common)) return 0;
  return static_cast<double>(median_of(std::move(ratios)));
}

HoleDepth fill(const ImageF& sensor, const PhotoDepth& stereo, const HoleDepthSettings& settings) {
  HoleDepth out;
  out.depth = sensor;
  out.confidence = ImageF(sensor.width, sensor.height, 1);
  const double share = sensor.data.empty() ? 0 : 1 / static_cast<double>(sensor.data.size());
  const bool seen = stereo.depth.data.size() == sensor.data.size();
  if (seen) out.disagreement = disagreement_of(sensor, stereo, settings.least_common);
  const bool usable = seen && out.disagreement <= settings.largest_disagreement;
  for (size_t i = 0; i < sensor.data.size(); ++i) {
    if (has_value(sensor.data[i])) {
      out.confidence.data[i] = 1;
      continue;
    }
    out.depth.data[i] = 0;
    if (!usable || !(stereo.certainty.data[i] > 0) || !has_value(stereo.depth.data[i])) continue;
    out.depth.data[i] = stereo.depth.data[i];
    out.confidence.data[i] = kFilledConfidence * std::min(stereo.certainty.data[i], 1.0f);
    out.filled += share;
  }
  return out;
}

}  // namespace

std::vector<HoleDepth> fill_depth_holes(const std::vector<MatchView>& views, const std::vector<Vec3f>& points,
                                        const HoleDepthSettings& settings, ThreadPool& pool,
                                        const std::function<void(double share)>& progress) {
  const std::vector<PhotoDepth> stereo = photo_depth(views, points, settings.stereo, pool, progress);
  std::vector<HoleDepth> filled;
  for (size_t i = 0; i < views.size(); ++i) filled.push_back(fill(views[i].depth, stereo[i], settings));
  return filled;
}

}  // namespace aligngs
