#include "engine/cuda/training_maps.h"

#include <algorithm>
#include <vector>

#include "engine/losses/crease.h"
#include "engine/losses/depth_map.h"
#include "engine/losses/label_pairs.h"
#include "engine/losses/map_losses.h"

namespace aligngs::cuda {
namespace {

/// True when every value is what reading an 8-bit image gives.
bool is_eight_bit(const ImageF& image) {
  return std::all_of(image.data.begin(), image.data.end(), [](float v) {
    return v >= 0 && v <= 1 && static_cast<float>(static_cast<uint8_t>(v * 255.0f + 0.5f)) / 255.0f == v;
  });
}

/// Pixels to planes: out[3][H W].
template <class To, class Convert>
std::vector<To> planes_of(const ImageF& image, const Convert& convert) {
  const size_t pixels = image.pixels();
  std::vector<To> out(3 * pixels);
  for (size_t i = 0; i < pixels; ++i) {
    for (size_t c = 0; c < 3; ++c) out[c * pixels + i] = convert(image.data[3 * i + c]);
  }
  return out;
}

template <class T>
void fill(DeviceContext& context, const std::vector<T>& values, DeviceArray<T>& to) {
  to.assign(context, values, "training views");
}

std::vector<uint8_t> pixel_flags(const TrainingView& view) {
  const ViewData& data = view.data;
  const int width = data.camera.width, height = data.camera.height;
  std::vector<uint8_t> flags(data.color.pixels(), 0);
  for (size_t i = 0; i < flags.size(); ++i) {
    if (pixel_counts(view, i)) flags[i] |= kPixelCounts;
    if (!view.label_edge.empty() && view.label_edge.data[i] != 0) flags[i] |= kPixelLabelEdge;
  }
  if (data.labels.empty()) return flags;
  const bool priors = !view.prior_normal.empty() && !data.prior_depth.empty();
  for (int y = 0; y < height; ++y) {
    for_each_label_pair(data.labels, y, [&](const LabelPair& p) {
      uint8_t& f = flags[static_cast<size_t>(p.y) * width + p.x];
      f |= p.dx != 0 ? kPixelRightPair : kPixelLowerPair;
      const EdgeKind kind = priors ? prior_at_edge(view, p).kind : EdgeKind::kNothing;
      if (kind == EdgeKind::kCrease) f |= p.dx != 0 ? kPixelRightCrease : kPixelLowerCrease;
      if (kind == EdgeKind::kCoplanar) f |= p.dx != 0 ? kPixelRightCoplanar : kPixelLowerCoplanar;
    });
  }
  return flags;
}

}  // namespace

TrainingMaps::TrainingMaps(DeviceContext& context, const TrainingView& view) {
  const ViewData& data = view.data;
  require_map_sizes(view, data.camera.width, data.camera.height);
  const size_t pixels = data.color.pixels();
  shape_.width = data.camera.width;
  shape_.height = data.camera.height;
  shape_.rays = PixelRays<float>(data.camera);
  shape_.labels = !data.labels.empty();
  const std::vector<uint8_t> flags = pixel_flags(view);
  shape_.counted = static_cast<uint32_t>(
      std::count_if(flags.begin(), flags.end(), [](uint8_t f) { return (f & kPixelCounts) != 0; }));
  fill(context, flags, flags_);
  if (is_eight_bit(data.color)) {
    fill(context, planes_of<uint8_t>(data.color, [](float v) { return uint8_t(v * 255.0f + 0.5f); }), color_bytes_);
  } else {
    fill(context, planes_of<float>(data.color, [](float v) { return v; }), color_);
  }
  std::vector<float> values(pixels);
  if (!data.prior_depth.empty()) {
    for (size_t i = 0; i < pixels; ++i) values[i] = prior_depth_at(view, i);
    fill(context, values, prior_depth_);
  }
  if (!view.depth_weight.empty()) {
    for (size_t i = 0; i < pixels; ++i) values[i] = depth_weight_at(view, i);
    fill(context, values, depth_weight_);
  }
  if (!view.prior_normal.empty()) {
    std::vector<float> normals(3 * pixels);
    for (size_t i = 0; i < pixels; ++i) {
      const Vec3f n = prior_normal_at<float>(view, i);
      for (int c = 0; c < 3; ++c) normals[static_cast<size_t>(c) * pixels + i] = n[c];
    }
    fill(context, normals, prior_normal_);
  }
}

TrainingMapSpans TrainingMaps::spans() const {
  TrainingMapSpans s = shape_;
  s.color_bytes = color_bytes_.span();
  s.color = color_.span();
  s.flags = flags_.span();
  s.prior_depth = prior_depth_.span();
  s.depth_weight = depth_weight_.span();
  s.prior_normal = prior_normal_.span();
  return s;
}

uint64_t TrainingMaps::bytes(const TrainingView& view) {
  const uint64_t pixels = view.data.color.pixels();
  uint64_t per_pixel = sizeof(uint8_t) + 3 * (is_eight_bit(view.data.color) ? sizeof(uint8_t) : sizeof(float));
  if (!view.data.prior_depth.empty()) per_pixel += sizeof(float);
  if (!view.depth_weight.empty()) per_pixel += sizeof(float);
  if (!view.prior_normal.empty()) per_pixel += 3 * sizeof(float);
  return per_pixel * pixels;
}

}  // namespace aligngs::cuda
