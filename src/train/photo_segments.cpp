#include "train/photo_segments.h"

#include <algorithm>

#include "core/half.h"
#include "train/photo_opinions.h"

namespace aligngs {
namespace {

/// A map of ones: a channel for each thing of the photo, and a last one for the rest.
SemanticTarget one_hot(const SegmentMap& map, const std::vector<uint16_t>& channel_of, int channels) {
  SemanticTarget target;
  target.channels = channels;
  target.width = map.width;
  target.height = map.height;
  target.probabilities.assign(map.of_pixel.size() * static_cast<size_t>(channels), 0);
  const uint16_t one = float_to_half(1.0f);
  for (size_t p = 0; p < map.of_pixel.size(); ++p) {
    const uint16_t segment = map.of_pixel[p];
    const size_t channel = segment == SegmentMap::kNone ? static_cast<size_t>(channels - 1) : channel_of[segment];
    target.probabilities[p * static_cast<size_t>(channels) + channel] = one;
  }
  target.confidence.assign(map.of_pixel.size(), 1.0f);
  return target;
}

}  // namespace

PhotoSegments sighted_segments(const GaussianModel& model, const SegmentedView& view, const RasterSettings& raster,
                               ThreadPool& pool) {
  PhotoSegments out;
  out.segments = view.segments.list;
  std::vector<uint16_t> things, channel_of;
  for (size_t s = 0; s < out.segments.size(); ++s) {
    channel_of.push_back(static_cast<uint16_t>(things.size()));
    if (out.segments[s].is_thing()) things.push_back(static_cast<uint16_t>(s));
  }
  if (things.empty() || model.size() == 0) return out;
  for (size_t s = 0; s < out.segments.size(); ++s) {
    if (!out.segments[s].is_thing()) channel_of[s] = static_cast<uint16_t>(things.size());
  }
  std::vector<TrainingView> one(1);
  one[0].data.camera = view.camera;
  one[0].data.semantics = one_hot(view.segments, channel_of, static_cast<int>(things.size()) + 1);
  const PhotoOpinions opinions = gather_opinions(model, one, {view.near_plane}, raster, pool);
  for (const PhotoOpinion& o : opinions.of_photo[0]) {
    for (size_t k = 0; k < PhotoOpinion::kNames; ++k) {
      if (!(o.share[k] > 0)) continue;
      const uint16_t segment = o.channel[k] < things.size() ? things[o.channel[k]] : SegmentMap::kNone;
      out.seen.push_back({o.gaussian, segment, o.votes * o.share[k]});
    }
  }
  return out;
}

}  // namespace aligngs
