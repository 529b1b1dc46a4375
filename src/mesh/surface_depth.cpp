#include "mesh/surface_depth.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr float kSolid = 0.9f;  // alpha from which a pixel's depth counts as one surface's

/// Wall, floor and ceiling alone: what hangs on a wall or lies on a floor has a thickness of its own.
std::vector<PlaneClass> bare_surfaces(const LabelSet& labels) {
  std::vector<PlaneClass> classes = plane_classes(labels);
  for (size_t c = 0; c < classes.size(); ++c) {
    const int index = static_cast<int>(c);
    if (index != labels.find("wall") && index != labels.find("floor") && index != labels.find("ceiling"))
      classes[c] = {};
  }
  return classes;
}

PlaneView plane_view_of(const FusionFrame& frame) {
  PlaneView out;
  out.camera = frame.camera;
  out.depth = frame.depth;
  out.labels = frame.label;
  out.label_share = frame.label_probability;
  out.certainty = ImageF(frame.camera.width, frame.camera.height, 1, 1.0f);
  if (!frame.alpha.empty()) {
    for (size_t i = 0; i < out.certainty.data.size(); ++i)
      out.certainty.data[i] = frame.alpha.data[i] > kSolid ? 1.0f : 0.0f;
  }
  return out;
}

void draw_frame(FusionFrame& frame, const PlaneMeasurement& measured, const std::vector<CameraPlane>& planes,
                ImageF& drawn) {
  for (size_t i = 0; i < drawn.data.size(); ++i) {
    const float share = std::min(1.0f, measured.weight.data[i]);
    if (!(share > 0)) continue;
    drawn.data[i] = share;
    frame.depth.data[i] *= std::exp(share * measured.log_factor.data[i]);
    if (frame.normal.empty()) continue;
    const auto plane = std::find_if(planes.begin(), planes.end(),
                                    [&](const CameraPlane& p) { return p.number == measured.plane.data[i]; });
    if (plane == planes.end()) continue;
    float* n = frame.normal.data.data() + 3 * i;
    const Vec3d own{n[0], n[1], n[2]};
    const Vec3d mixed = normalized(own * (1.0 - double(share)) + plane->normal * double(share));
    for (int a = 0; a < 3; ++a) n[a] = static_cast<float>(mixed[a]);
  }
}

}  // namespace

ImageF agreeing_depth(const ImageF& plane, const ImageF& median, double agreement) {
  ImageF out = median;
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const float m = valid_depth(median, x, y), p = valid_depth(plane, x, y);
      out.at(x, y) = p > 0 && std::abs(p - m) <= static_cast<float>(agreement) * m ? p : m;
    }
  }
  return out;
}

ConfirmedDepth confirmed_depth(const ImageF& rendered, const ImageF& prior, double agreement) {
  ConfirmedDepth out{rendered, ImageF(rendered.width, rendered.height, 1)};
  for (int y = 0; y < rendered.height; ++y) {
    for (int x = 0; x < rendered.width; ++x) {
      const float z = valid_depth(rendered, x, y), p = valid_depth(prior, x, y);
      if (!(z > 0) || !(p > 0)) continue;
      const double difference = std::abs(double(z) / double(p) - 1);
      const auto share = static_cast<float>(std::clamp(2 - difference / agreement, 0.0, 1.0));
      out.share.at(x, y) = share;
      out.depth.at(x, y) = z + share * (p - z);
    }
  }
  return out;
}

std::vector<ImageF> draw_to_structure(std::vector<FusionFrame>& frames, const LabelSet& labels,
                                      const StructuralPlanes& options, ThreadPool& pool) {
  std::vector<ImageF> drawn(frames.size());
  std::vector<PlaneView> views;
  std::vector<size_t> source;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].label.empty() || frames[i].interpolated) continue;
    views.push_back(plane_view_of(frames[i]));
    source.push_back(i);
  }
  if (views.empty()) return drawn;
  PlaneDepthSettings settings;
  settings.reach = options.reach;
  settings.normal_angle = options.normal_angle;
  settings.strength = 2;  // the biweight is a half at half of the reach
  const PlaneDepthResult found = measure_planes(views, bare_surfaces(labels), settings, pool);
  for (size_t k = 0; k < views.size(); ++k) {
    FusionFrame& frame = frames[source[k]];
    drawn[source[k]] = ImageF(frame.camera.width, frame.camera.height, 1);
    draw_frame(frame, found.views[k], in_frame_of(frame.camera, found.planes), drawn[source[k]]);
  }
  return drawn;
}

}  // namespace aligngs
