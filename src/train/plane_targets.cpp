#include "train/plane_targets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "engine/formulas/depth_terms.h"
#include "train/rendered_view.h"

namespace aligngs {
namespace {

constexpr double kLevels = 255;  // of a stored weight

ViewPlanes stored(const PlaneMeasurement& measured, std::vector<CameraPlane> planes, float depth_scale) {
  ViewPlanes out;
  std::array<uint8_t, 256> place{};  // of a plane of the scene among those of the view
  for (size_t i = 0; i < planes.size(); ++i) place[planes[i].number] = static_cast<uint8_t>(i + 1);
  out.planes = std::move(planes);
  out.depth_scale = depth_scale;
  out.plane = measured.plane;
  out.weight = Image<uint8_t>(measured.plane.width, measured.plane.height, 1);
  for (size_t i = 0; i < out.plane.data.size(); ++i) {
    out.plane.data[i] = place[out.plane.data[i]];
    const double weight = std::clamp(static_cast<double>(measured.weight.data[i]), 0.0, 1.0);
    out.weight.data[i] = static_cast<uint8_t>(std::lround(kLevels * weight));
  }
  return out;
}

/// A pixel's prior, and how much it counts.
struct Prior {
  double depth = 0, weight = 0;
  Vec3d normal;  ///< zero: none
};

Prior drawn_to(const Prior& prior, double plane_depth, const Vec3d& plane_normal, double plane_weight) {
  const double total = prior.weight + plane_weight;
  const double share = plane_weight / total;
  Prior out;
  out.depth = prior.depth > 0 && share < 1 ? prior.depth * std::pow(plane_depth / prior.depth, share) : plane_depth;
  out.weight = std::min(1.0, total);
  const Vec3d normal = prior.normal * (1 - share) + plane_normal * share;
  const double length = std::sqrt(dot(normal, normal));
  out.normal = length > 0 ? normal * (1 / length) : plane_normal;
  return out;
}

/// One training view, whose maps may be absent and are made where a plane needs them.
class DrawnView {
 public:
  explicit DrawnView(TrainingView& view)
      : view_(view), width_(view.data.camera.width), height_(view.data.camera.height) {
    if (view.data.prior_depth.empty()) view.data.prior_depth = ImageF(width_, height_, 1);
    if (view.depth_weight.empty()) view.depth_weight = ImageF(width_, height_, 1, 1.0f);
  }

  Prior at(int x, int y) const {
    Prior out;
    out.depth = static_cast<double>(usable_prior_depth(view_.data.prior_depth.at(x, y)));
    if (out.depth > 0) out.weight = static_cast<double>(usable_weight(view_.depth_weight.at(x, y)));
    if (!view_.prior_normal.empty()) {
      const float* n = view_.prior_normal.pixel(x, y);
      out.normal = {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
    }
    return out;
  }

  void set(int x, int y, const Prior& prior) {
    view_.data.prior_depth.at(x, y) = static_cast<float>(prior.depth);
    view_.depth_weight.at(x, y) = static_cast<float>(prior.weight);
    if (view_.prior_normal.empty()) return;  // the normal term is off
    float* n = view_.prior_normal.pixel(x, y);
    n[0] = static_cast<float>(prior.normal.x);
    n[1] = static_cast<float>(prior.normal.y);
    n[2] = static_cast<float>(prior.normal.z);
  }

  int width() const { return width_; }
  int height() const { return height_; }

 private:
  TrainingView& view_;
  int width_, height_;
};

void draw_view(const ViewPlanes& pixels, double strength, TrainingView& out) {
  if (!(pixels.depth_scale > 0)) return;  // L_z takes no depth of this view
  DrawnView view(out);
  for (int y = 0; y < view.height(); ++y) {
    for (int x = 0; x < view.width(); ++x) {
      const int from_x = x * pixels.plane.width / view.width(), from_y = y * pixels.plane.height / view.height();
      const double weight = strength * pixels.weight.at(from_x, from_y) / kLevels;
      const size_t number = pixels.plane.at(from_x, from_y);
      if (number == 0 || !(weight > 0)) continue;
      const CameraPlane& plane = pixels.planes.at(number - 1);
      const double depth = plane.depth(out.data.camera.ray(x + 0.5, y + 0.5)) / static_cast<double>(pixels.depth_scale);
      // L_z multiplies the depth by a_v again
      if (depth > 0) view.set(x, y, drawn_to(view.at(x, y), depth, plane.normal, weight));
    }
  }
}

}  // namespace

double PlaneTargets::share() const {
  size_t all = 0, on_plane = 0;
  for (const ViewPlanes& view : views) {
    all += view.plane.data.size();
    on_plane += view.plane.data.size() -
                static_cast<size_t>(std::count(view.plane.data.begin(), view.plane.data.end(), uint8_t(0)));
  }
  return all == 0 ? 0 : static_cast<double>(on_plane) / static_cast<double>(all);
}

PlaneTargets fit_plane_targets(const Engine& engine, const PlaneFitRequest& request, ThreadPool& pool) {
  std::vector<PlaneView> views;
  for (const GuideView& guide : request.views) {
    Rendering seen = render_labelled(engine, guide, guide.camera, request.render);
    PlaneView view = plane_view_of(guide.camera, seen);
    view.label_share = std::move(seen.label_probability);
    views.push_back(std::move(view));
  }
  PlaneDepthSettings settings;
  settings.strength = 1;  // weights are shares; the caller's strength comes when they are used
  settings.square = request.square;
  const PlaneDepthResult found = measure_planes(views, request.classes, settings, pool);
  PlaneTargets out;
  for (size_t i = 0; i < views.size(); ++i) {
    out.views.push_back(stored(found.views[i], in_frame_of(views[i].camera, found.planes), request.depth_scales[i]));
  }
  return out;
}

void draw_to_planes(const PlaneTargets& targets, double strength, std::vector<TrainingView>& views) {
  if (targets.empty()) return;
  if (targets.views.size() != views.size()) {
    throw Error({ErrorKind::kFailed,
                 "the planes are of another number of views",
                 {},
                 "planes",
                 "start again with --overwrite"});
  }
  for (size_t i = 0; i < views.size(); ++i) draw_view(targets.views[i], strength, views[i]);
}

}  // namespace aligngs
