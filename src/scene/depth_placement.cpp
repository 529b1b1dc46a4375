#include "scene/depth_placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/is_depth.h"
#include "core/median.h"
#include "io/resample.h"
#include "scene/prior_maps.h"
#include "scene/scene_check.h"
#include "scene/scene_json.h"

namespace aligngs {
namespace {

// Points that a placed view's depth gives to the others: a few hundred in each of them, which is what robust_log_scale
// needs.
constexpr int kCarriedPerSide = 48;
// Pixels: all maps are held at once, and medians over a view need no more.
constexpr int kLargestSide = 320;

/// A training view with its map at the map's own resolution, or smaller.
struct Map {
  ImageF depth;
  Camera camera;
};

Map load_map(const Scene& scene, int view) {
  const View& v = scene.views[static_cast<size_t>(view)];
  Map map;
  if (v.prior_depth.empty()) return map;
  FloatArray array = read_map(v.prior_depth);
  const MapShape shape = depth_map_shape(array.shape, v.prior_depth);
  require_same_aspect(shape, v.camera.width, v.camera.height, v.prior_depth, "shape");
  map.depth.width = shape.width;
  map.depth.height = shape.height;
  map.depth.channels = 1;
  map.depth.data = std::move(array.data);
  const double shrink = std::min(1.0, static_cast<double>(kLargestSide) / std::max(shape.width, shape.height));
  if (shrink < 1) {
    for (float& z : map.depth.data) z = is_depth(z) ? z : 0;
    map.depth = resize_depth(map.depth, std::max(1, static_cast<int>(std::lround(shrink * shape.width))),
                             std::max(1, static_cast<int>(std::lround(shrink * shape.height))));
  }
  map.camera = v.camera.resized(map.depth.width, map.depth.height);
  return map;
}

/// log(depth of a point / value of the map) over the points of the cloud that the view shows.
std::vector<double> log_ratios(const PointCloud& cloud, const Map& map) {
  std::vector<double> ratios;
  if (map.depth.empty() || cloud.size() == 0) return ratios;
  for (const uint32_t i : visible_points(cloud, map.camera)) {
    const Vec3d p = map.camera.world_to_camera * cloud.positions[i].cast<double>();
    const Vec2d pixel = map.camera.project(p);
    const float prior = map.depth.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
    if (is_depth(prior)) ratios.push_back(std::log(p.z / static_cast<double>(prior)));
  }
  return ratios;
}

/// Adds a grid of the view's pixels, at their depth times `factor`.
void add_points(const Map& map, double factor, PointCloud& cloud) {
  const int step_x = std::max(1, map.depth.width / kCarriedPerSide),
            step_y = std::max(1, map.depth.height / kCarriedPerSide);
  for (int y = step_y / 2; y < map.depth.height; y += step_y) {
    for (int x = step_x / 2; x < map.depth.width; x += step_x) {
      const float z = map.depth.at(x, y);
      if (is_depth(z))
        cloud.positions.push_back(
            map.camera.unproject(x + 0.5, y + 0.5, factor * static_cast<double>(z)).cast<float>());
    }
  }
}

class Placing {
 public:
  Placing(const Scene& scene, const DepthPlacementRule& rule) : scene_(scene), rule_(rule) {
    for (const int view : scene.train) {
      maps_.push_back(load_map(scene, view));
      ratios_.push_back(log_ratios(scene.cloud, maps_.back()));
    }
    out_.scale = scene.depth_scale;
    out_.views.resize(maps_.size());
  }

  DepthPlacement place() {
    if (scene_.depth_scale == DepthScale::kOwn) {
      place_together();
    } else {
      place_by_points();
      // Metres are the unit of a metric scene: a network's are a few per cent off in every photo, which the points
      // tell.
      const bool metres = scene_.depth_scale == DepthScale::kMetres;
      if (metres && scene_.metric && out_.placed() == 0) place_all(1, PlacedBy::kCameras);
      while (place_by_other_depth()) {
      }
      if (metres && out_.placed() > 0) place_all(std::exp(median_log()), PlacedBy::kOtherViews);
    }
    measure_residuals();
    return std::move(out_);
  }

 private:
  void place_by_points() {
    for (size_t v = 0; v < maps_.size(); ++v) {
      if (const auto found = robust_log_scale(ratios_[v], rule_)) set(v, std::exp(found->log), PlacedBy::kPoints);
    }
  }

  /// The views that have no factor yet.
  void place_all(double factor, PlacedBy by) {
    for (size_t v = 0; v < maps_.size(); ++v) {
      if (out_.views[v].factor == 0 && !maps_[v].depth.empty()) set(v, factor, by);
    }
  }

  /// One factor: views count alike, however many points they show. If no view shows enough, their samples count
  /// together.
  void place_together() {
    std::vector<double> logs, all;
    std::vector<uint8_t> told(maps_.size(), 0);
    for (size_t v = 0; v < maps_.size(); ++v) {
      all.insert(all.end(), ratios_[v].begin(), ratios_[v].end());
      const auto found = robust_log_scale(ratios_[v], rule_);
      if (!found) continue;
      logs.push_back(found->log);
      told[v] = 1;
    }
    if (logs.empty()) {
      const auto found = robust_log_scale(all, rule_);
      if (found) logs.push_back(found->log);
    }
    if (logs.empty()) return;
    const double factor = std::exp(median_of(logs));
    for (size_t v = 0; v < maps_.size(); ++v) {
      if (!maps_[v].depth.empty()) set(v, factor, told[v] ? PlacedBy::kPoints : PlacedBy::kOtherViews);
    }
  }

  /// Places views beside those that are placed. True while it finds any.
  bool place_by_other_depth() {
    if (out_.placed() == 0 || out_.placed() == maps_.size()) return false;
    PointCloud carried;
    for (size_t v = 0; v < maps_.size(); ++v) {
      if (out_.views[v].factor > 0) add_points(maps_[v], out_.views[v].factor, carried);
    }
    bool any = false;
    for (size_t v = 0; v < maps_.size(); ++v) {
      if (out_.views[v].factor > 0) continue;
      const auto found = robust_log_scale(log_ratios(carried, maps_[v]), rule_);
      if (!found) continue;
      set(v, std::exp(found->log), PlacedBy::kOtherDepth);
      any = true;
    }
    return any;
  }

  double median_log() const {
    std::vector<double> logs;
    for (const ViewPlacement& view : out_.views) {
      if (view.factor > 0) logs.push_back(std::log(view.factor));
    }
    return median_of(logs);
  }

  /// Against the scene's points, or, in a scene where no view shows enough of them, against the depth of the other
  /// views.
  void measure_residuals() {
    bool by_points = false;
    for (const std::vector<double>& ratios : ratios_) by_points |= ratios.size() >= rule_.min_samples;
    std::vector<double> residuals;
    for (size_t v = 0; v < maps_.size(); ++v) {
      ViewPlacement& view = out_.views[v];
      if (!(view.factor > 0)) continue;
      std::vector<double> off = by_points ? ratios_[v] : log_ratios(points_of_others(v), maps_[v]);
      if (off.size() < rule_.min_samples) continue;
      for (double& ratio : off) ratio = std::abs(ratio - std::log(view.factor));
      view.samples = off.size();
      view.residual = median_of(std::move(off));
      residuals.push_back(view.residual);
    }
    if (!residuals.empty()) out_.residual = median_of(residuals);
  }

  PointCloud points_of_others(size_t view) const {
    PointCloud cloud;
    for (size_t v = 0; v < maps_.size(); ++v) {
      if (v != view && out_.views[v].factor > 0) add_points(maps_[v], out_.views[v].factor, cloud);
    }
    return cloud;
  }

  void set(size_t v, double factor, PlacedBy by) {
    out_.views[v].factor = factor;
    out_.views[v].by = by;
  }

  const Scene& scene_;
  const DepthPlacementRule& rule_;
  std::vector<Map> maps_;
  std::vector<std::vector<double>> ratios_;  ///< against the scene's points, per view
  DepthPlacement out_;
};

}  // namespace

std::optional<LogScale> robust_log_scale(std::vector<double> ratios, const DepthPlacementRule& rule) {
  // the median of those near the first centre, then of those near that: a third changes nothing
  constexpr int kRounds = 2;
  if (ratios.empty() || ratios.size() < rule.min_samples) return std::nullopt;
  std::sort(ratios.begin(), ratios.end());
  const size_t half = ratios.size() / 2;
  size_t best = 0;
  for (size_t i = 0; i + half < ratios.size(); ++i) {
    if (ratios[i + half] - ratios[i] < ratios[best + half] - ratios[best]) best = i;
  }
  LogScale out;
  out.log = ratios[best + half / 2];
  out.samples = ratios.size();
  const double reach = std::log1p(rule.outlier);
  for (int round = 0; round < kRounds; ++round) {
    const auto low = std::lower_bound(ratios.begin(), ratios.end(), out.log - reach);
    const auto high = std::upper_bound(ratios.begin(), ratios.end(), out.log + reach);
    if (low < high) out.log = *(low + (high - low) / 2);
  }
  for (double& ratio : ratios) ratio = std::abs(ratio - out.log);
  out.spread = median_of(std::move(ratios));
  return out;
}

size_t DepthPlacement::count(PlacedBy by) const {
  return static_cast<size_t>(
      std::count_if(views.begin(), views.end(), [by](const ViewPlacement& view) { return view.by == by; }));
}

size_t DepthPlacement::placed() const { return views.size() - count(PlacedBy::kNothing); }

DepthPlacement place_prior_depth(const Scene& scene, const DepthPlacementRule& rule) {
  if (scene.depth_scale == DepthScale::kScene) return as_given(scene.train.size());
  return Placing(scene, rule).place();
}

DepthPlacement as_given(size_t views) {
  DepthPlacement out;
  ViewPlacement one;
  one.factor = 1;
  one.by = PlacedBy::kCameras;
  out.views.assign(views, one);
  return out;
}

std::string describe(const DepthPlacement& placement) {
  std::string text = fmt::format("scale \"{}\"", name_of(placement.scale));
  if (placement.scale == DepthScale::kScene) return text + ", taken as it is";
  std::vector<double> factors;
  for (const ViewPlacement& view : placement.views) {
    if (view.factor > 0) factors.push_back(view.factor);
  }
  if (factors.empty()) return text + ", nothing tells its factor to the scene's units";
  text += fmt::format(", median factor {:.4g}", median_of(factors));
  const std::pair<PlacedBy, const char*> ways[] = {{PlacedBy::kCameras, "as given"},
                                                   {PlacedBy::kPoints, "by points"},
                                                   {PlacedBy::kOtherDepth, "by the depth of other views"},
                                                   {PlacedBy::kOtherViews, "by the factor of other views"},
                                                   {PlacedBy::kNothing, "not placed"}};
  for (const auto& [by, words] : ways) {
    if (placement.count(by) > 0) text += fmt::format(", {} views {}", placement.count(by), words);
  }
  return text +
         (placement.residual ? fmt::format(", residual {:.1f} %", 100 * *placement.residual) : ", residual not known");
}

}  // namespace aligngs
