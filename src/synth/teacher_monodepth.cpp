#include "synth/teacher_monodepth.h"

#include <cmath>
#include <unordered_map>

#include "synth/depth_jumps.h"
#include "synth/noise.h"

namespace aligngs {

MonoDepthSettings mono_depth_settings(TeacherLevel level) {
  const double k = level == TeacherLevel::kLow ? 0.6 : (level == TeacherLevel::kHigh ? 1.5 : 1.0);
  MonoDepthSettings s;
  s.view_scale *= k;
  s.view_shift *= k;
  s.warp_rms *= k;
  s.object_offset *= k;
  s.edge_width_low *= k;
  s.edge_width_high *= k;
  return s;
}

ImageF simulate_mono_depth(const RenderedView& view, size_t view_number, const MonoDepthSettings& s,
                           const Random& random) {
  Random r = random.fork(1000 + view_number);
  const int w = view.depth.width, h = view.depth.height;
  // Uniform with the given root mean square, and spread evenly over the views of a scene. Steps are the golden ratio
  // and the square root of two from a random start. Every scene hence gets a network of the same quality.
  const double root3 = std::sqrt(3.0), number = static_cast<double>(view_number);
  Random start = random.fork(3);
  const auto spread = [&](double step) {
    const double u = start.uniform() + number * step;
    return root3 * (2 * (u - std::floor(u)) - 1);
  };
  const double scale = 1 + s.view_scale * spread(0.618033988749895);
  const double shift = s.view_shift * spread(0.414213562373095);
  const double edge = r.uniform(s.edge_width_low, s.edge_width_high);
  const ImageF warp = smooth_random_map(w, h, 4, 4, s.warp_rms, r);
  std::unordered_map<uint16_t, double> offsets;
  const auto offset_of = [&](uint16_t instance) {
    const auto known = offsets.find(instance);
    if (known != offsets.end()) return known->second;
    Random shared = random.fork(50000 + instance), own = random.fork(500000 + 1009 * view_number + instance);
    const double value = s.object_offset * std::sqrt(0.5) * (shared.normal() + own.normal());
    offsets[instance] = value;
    return value;
  };
  ImageF moved = view.depth;
  for (size_t i = 0; i < moved.data.size(); ++i) {
    if (!(moved.data[i] > 0)) continue;
    const uint16_t instance = view.instances.data[i];
    double factor = 1 + offset_of(instance);
    if (view.unreliable.data[i] != 0) {  // glass, screens, black gloss: +-10 to 30 %
      Random own = random.fork(700000 + 1013 * view_number + instance);
      const double size = own.uniform(0.1, 0.3);
      factor *= 1 + (own.chance(0.5) ? size : -size);
    }
    moved.data[i] = static_cast<float>(moved.data[i] * factor);
  }
  ImageF out = mix_across_edges(moved, find_depth_jumps(view, static_cast<int>(std::ceil(1.5 * edge))), edge);
  for (size_t i = 0; i < out.data.size(); ++i) {
    if (!(out.data[i] > 0)) continue;
    const double z = out.data[i] * scale * (1 + warp.data[i]) + shift;
    out.data[i] = static_cast<float>(z > 0.05 ? z : 0.05);
  }
  return out;
}

}  // namespace aligngs
