#include "refine/plane_hypothesis.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "refine/stereo_sweep.h"

namespace aligngs {
namespace {

/// Sums over rectangles of a map, from a table of sums from the top left corner.
class WindowSums {
 public:
  template <class Value>
  WindowSums(int width, int height, const Value& value)
      : width_(width), height_(height), sums_(static_cast<size_t>(width + 1) * (height + 1), 0.0) {
    for (int y = 0; y < height; ++y) {
      double row = 0;
      for (int x = 0; x < width; ++x) {
        row += value(x, y);
        at(x + 1, y + 1) = at(x + 1, y) + row;
      }
    }
  }

  /// Over the pixels within `half` of (x, y) that lie in the map.
  double around(int x, int y, int half) const {
    const int left = std::max(0, x - half), right = std::min(width_, x + half + 1), top = std::max(0, y - half),
              bottom = std::min(height_, y + half + 1);
    return at(right, bottom) - at(left, bottom) - at(right, top) + at(left, top);
  }

 private:
  double& at(int x, int y) { return sums_[static_cast<size_t>(y) * (width_ + 1) + x]; }
  double at(int x, int y) const { return sums_[static_cast<size_t>(y) * (width_ + 1) + x]; }

  int width_, height_;
  std::vector<double> sums_;
};

/// Whether `plane` may be a part of `whole` that a network misjudges: smaller, behind or before it, and turned little.
/// Steps and alcoves are such planes, too.
bool is_doubtful(const ScenePlane& plane, const ScenePlane& whole, const PlaneHypothesisSettings& settings) {
  return plane.kind == whole.kind &&
         static_cast<double>(plane.points) < settings.doubtful_share * static_cast<double>(whole.points) &&
         dot(plane.normal, whole.normal) > std::cos(settings.doubtful_angle * kRadiansPerDegree);
}

bool is_solid(PlaneKind kind) { return kind == PlaneKind::kFloor || kind == PlaneKind::kCeiling; }

/// A plane for some pixels of a photo: those labelled as its kind that lie too far from every plane to be on one.
struct Candidates {
  ImageF depth;           ///< of the plane, around candidates too; 0 elsewhere
  Image<uint8_t> wanted;  ///< 1 = a candidate
  Image<uint8_t> solid;   ///< 1 = the pixel's depth is behind the plane, where nothing can be
  bool any = false;
};

Candidates candidates_of(const PlaneView& view, const std::vector<ScenePlane>& planes, const CameraPlane& plane,
                         const Image<uint8_t>& kinds, const PlaneMeasurement& measured,
                         const PlaneDepthSettings& plane_settings, const PlaneHypothesisSettings& settings) {
  const int width = view.camera.width, height = view.camera.height;
  Candidates out{ImageF(width, height, 1), Image<uint8_t>(width, height, 1), Image<uint8_t>(width, height, 1), false};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float z = view.depth.at(x, y);
      if (kinds.at(x, y) != static_cast<uint8_t>(plane.kind) || !(z > 0) || !std::isfinite(z)) continue;
      const uint8_t own = measured.plane.at(x, y);
      const bool on_plane = measured.weight.at(x, y) > 0 && own > 0;
      if (on_plane && !is_doubtful(planes[own - 1u], planes[plane.number - 1u], settings)) continue;
      const double depth = plane.depth(view.camera.ray(x + 0.5, y + 0.5));
      if (!(depth > 0)) continue;
      const double factor = std::log(depth / z);
      if ((!on_plane && std::abs(factor) < plane_settings.reach) || std::abs(factor) > settings.reach) continue;
      out.wanted.at(x, y) = 1;
      out.solid.at(x, y) = !on_plane && factor < 0 && is_solid(plane.kind);
      out.any = true;
    }
  }
  return out;
}

/// Depth of the plane at every pixel within `margin` of a candidate: correlation looks at windows.
void fill_depth(const PlaneView& view, const CameraPlane& plane, int margin, Candidates& candidates) {
  const int width = candidates.wanted.width, height = candidates.wanted.height;
  const WindowSums count(width, height, [&](int x, int y) { return candidates.wanted.at(x, y); });
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (count.around(x, y, margin) > 0)
        candidates.depth.at(x, y) = static_cast<float>(plane.depth(view.camera.ray(x + 0.5, y + 0.5)));
    }
  }
}

/// Agreement of other photos with one depth per pixel.
CostVolume cost_of(const MatchView& photo, ImageF depth, const std::vector<const MatchView*>& others,
                   const StereoSettings& stereo) {
  SweepSettings sweep = stereo.sweep;
  sweep.hypotheses = 1;
  MatchView asked{photo.camera, photo.luma, std::move(depth)};
  return sweep_prior_depth(asked, others, sweep);
}

/// Own depth only where the plane is tried.
ImageF own_depth(const PlaneView& view, const ImageF& plane_depth) {
  ImageF out(plane_depth.width, plane_depth.height, 1);
  for (size_t i = 0; i < out.data.size(); ++i) out.data[i] = plane_depth.data[i] > 0 ? view.depth.data[i] : 0;
  return out;
}

void decide(const PlaneView& view, const CameraPlane& plane, const Candidates& candidates, const CostVolume& of_plane,
            const CostVolume& of_own, const std::vector<PlaneClass>& classes, const PlaneDepthSettings& plane_settings,
            const PlaneHypothesisSettings& settings, PlaneMeasurement& measured) {
  const int width = candidates.wanted.width, height = candidates.wanted.height;
  const auto known = [&](int x, int y) {
    const size_t i = static_cast<size_t>(y) * width + x;
    return candidates.wanted.at(x, y) && of_plane.known[i] && of_own.known[i];
  };
  const WindowSums wanted(width, height, [&](int x, int y) { return candidates.wanted.at(x, y); });
  const WindowSums counted(width, height, [&](int x, int y) { return known(x, y) ? 1 : 0; });
  const WindowSums gained(width, height,
                          [&](int x, int y) { return known(x, y) ? *of_own.at(x, y) - *of_plane.at(x, y) : 0; });
  const WindowSums cost(width, height, [&](int x, int y) { return known(x, y) ? *of_plane.at(x, y) : 0; });
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!candidates.wanted.at(x, y)) continue;
      const double all = wanted.around(x, y, settings.half_window), told = counted.around(x, y, settings.half_window);
      const bool solid = candidates.solid.at(x, y);
      bool wins = solid;  // where the photos say nothing
      if (told >= settings.least_known * all) {
        const double gain = gained.around(x, y, settings.half_window) / told,
                     score = 1 - cost.around(x, y, settings.half_window) / told;
        wins = gain > (solid ? settings.gain_of_solid : settings.gain) && (solid || score > settings.least_score);
      }
      if (!wins) continue;
      const double depth = plane.depth(view.camera.ray(x + 0.5, y + 0.5), classes[view.labels.at(x, y)].proud);
      if (!(depth > 0)) continue;
      measured.log_factor.at(x, y) = static_cast<float>(std::log(depth / view.depth.at(x, y)));
      measured.weight.at(x, y) =
          static_cast<float>(plane_settings.strength) * (view.label_share.empty() ? 1.0f : view.label_share.at(x, y));
      measured.plane.at(x, y) = plane.number;
    }
  }
}

/// Kind of plane at each pixel away from the edge to another; glass, whose depth says nothing, has none.
Image<uint8_t> kinds_of(const PlaneView& view, const std::vector<PlaneClass>& classes, int edge) {
  Image<uint8_t> kinds(view.camera.width, view.camera.height, 1);
  for (size_t i = 0; i < kinds.data.size(); ++i) {
    const uint16_t label = view.labels.data[i];
    if (label < classes.size() && !classes[label].glass) kinds.data[i] = static_cast<uint8_t>(classes[label].kind);
  }
  return interior(kinds, edge);
}

}  // namespace

void try_planes(const std::vector<MatchView>& photos, const std::vector<PlaneView>& views,
                const std::vector<PlaneClass>& classes, const std::vector<ScenePlane>& planes,
                const PlaneDepthSettings& plane_settings, const StereoSettings& stereo,
                const PlaneHypothesisSettings& settings, ThreadPool& pool, std::vector<PlaneMeasurement>& measured) {
  if (!settings.enabled || planes.empty()) return;
  std::vector<const MatchView*> pointers;
  for (const MatchView& photo : photos) pointers.push_back(&photo);
  const std::vector<std::vector<int>> partners = stereo_partners(pointers, stereo);
  pool.parallel_for(photos.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const PlaneView& view = views[i];
      if (view.labels.data.empty() || view.depth.empty()) continue;
      std::vector<const MatchView*> others;
      for (const int k : partners[i]) others.push_back(pointers[static_cast<size_t>(k)]);
      const Image<uint8_t> kinds = kinds_of(view, classes, plane_settings.label_edge);
      const std::vector<CameraPlane> local = in_frame_of(view.camera, planes);
      for (const CameraPlane& plane : local) {
        Candidates candidates = candidates_of(view, planes, plane, kinds, measured[i], plane_settings, settings);
        if (!candidates.any) continue;
        fill_depth(view, plane, stereo.sweep.half_window, candidates);
        const CostVolume of_own = cost_of(photos[i], own_depth(view, candidates.depth), others, stereo),
                         of_plane = cost_of(photos[i], candidates.depth, others, stereo);
        decide(view, plane, candidates, of_plane, of_own, classes, plane_settings, settings, measured[i]);
      }
    }
  });
}

}  // namespace aligngs
