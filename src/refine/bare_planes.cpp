#include "refine/bare_planes.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/is_depth.h"
#include "core/quantile.h"
#include "io/resample.h"
#include "refine/plane_depth.h"
#include "refine/view_overlap.h"
#include "scene/depth_normals.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr double kFarShare = 0.98;  // of what a photo measured: the rest may be wrong
constexpr float kNowhere = 3;       // cost of a plane that a ray does not meet
constexpr int kMostHiding = 2;      // photos that count
// A plane found in what is left is a known one where it is this near (relative) and this parallel (degrees).
constexpr double kSameDistance = 0.008, kSameAngle = 5;

/// The photos as they are divided: small, with all of their depth and with what is measured alone.
struct SmallPhotos {
  std::vector<MatchView> all;
  std::vector<MeasuredView> measured;
};

SmallPhotos small_photos(const std::vector<MatchView>& views, const std::vector<Image<uint16_t>>& labels,
                         const std::vector<PhotoDepth>& depths, int most_width, ThreadPool& pool) {
  SmallPhotos small{std::vector<MatchView>(views.size()), std::vector<MeasuredView>(views.size())};
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const Camera& camera = views[i].camera;
      const int width = std::min(most_width, camera.width),
                height = std::max(1, (camera.height * width + camera.width / 2) / camera.width);
      small.all[i] = {camera.resized(width, height), resize_area(views[i].luma, width, height), {}};
      MeasuredView& measured = small.measured[i];
      measured.camera = small.all[i].camera;
      measured.depth = ImageF(width, height, 1);
      if (!labels.empty() && !labels[i].empty()) measured.labels = resize_nearest(labels[i], width, height);
      if (depths[i].depth.empty()) continue;
      small.all[i].depth = resize_nearest(depths[i].depth, width, height);
      measured.certainty = resize_nearest(depths[i].certainty, width, height);
      for (size_t p = 0; p < measured.depth.data.size(); ++p) {
        if (measured.certainty.data[p] > 0) measured.depth.data[p] = small.all[i].depth.data[p];
      }
    }
  });
  return small;
}

/// The photos without the pixels that lie on known surfaces.
std::vector<MeasuredView> unknown_part(std::vector<MeasuredView> measured, const KnownSurfaces& known) {
  for (size_t i = 0; i < measured.size() && i < known.views.size(); ++i) {
    ImageF& depth = measured[i].depth;
    const ImageF& weight = known.views[i].weight;
    if (weight.empty() || depth.empty()) continue;
    const ImageF held = resize_nearest(weight, depth.width, depth.height);
    for (size_t p = 0; p < depth.data.size(); ++p) {
      if (held.data[p] > 0) depth.data[p] = 0;
    }
  }
  return measured;
}

double mean_distance(const Vec3d& place, const std::vector<MeasuredView>& views) {
  double sum = 0;
  for (const MeasuredView& view : views) sum += norm(place - view.camera.centre());
  return sum / static_cast<double>(std::max<size_t>(1, views.size()));
}

/// Known planes, then those of what is left, `most` of the latter.
std::vector<ScenePlane> planes_of(const SmallPhotos& photos, const BarePlaneSettings& settings, bool labelled,
                                  const KnownSurfaces& known, ThreadPool& pool) {
  MeasuredPlaneSettings of_rest = settings.planes;
  if (!labelled) of_rest.along_axes = settings.without_labels;
  of_rest.known_axes = known.axes;
  std::vector<ScenePlane> planes = known.planes;
  for (const ScenePlane& found : measured_planes(unknown_part(photos.measured, known), of_rest, pool)) {
    const double near = kSameDistance * mean_distance(found.centre, photos.measured);
    const bool same = std::any_of(known.planes.begin(), known.planes.end(), [&](const ScenePlane& plane) {
      return dot(plane.normal, found.normal) > std::cos(kSameAngle * kRadiansPerDegree) &&
             std::abs(plane.distance(found.centre)) < near;
    });
    if (!same) planes.push_back(found);
  }
  return planes;
}

float far_end(const ImageF& depth) {
  std::vector<float> values;
  for (const float z : depth.data) {
    if (z > 0) values.push_back(z);
  }
  return lower_rank_of(std::move(values), kFarShare);
}

/// Half of 1 at `off` = 1.
float saturated(double off) { return static_cast<float>(off * off / (1 + off * off)); }

/// A surface that pixels may lie on: a plane, or, without one, the depth that the photo has.
struct Surface {
  ImageF depth;  ///< H x W
  const CameraPlane* plane = nullptr;
  const std::vector<float>* class_fit = nullptr;  ///< of the plane; not null with one
};

/// Doubts about a surface in each pixel of a photo.
class Evidence {
 public:
  /// `partners` are compared with the photo, and `others` are asked what they measured.
  Evidence(const SmallPhotos& photos, size_t photo, const std::vector<int>& others, const std::vector<int>& partners,
           const BarePlaneSettings& settings, const StereoSettings& stereo)
      : view_(photos.all[photo]),
        measured_(photos.measured[photo].depth),
        labels_(photos.measured[photo].labels),
        settings_(settings),
        sweep_(stereo.sweep),
        farthest_(static_cast<float>(settings.farthest) * far_end(measured_)) {
    if (settings.doubts.turned > 0) normals_ = camera_normals(view_.depth, view_.camera);
    sweep_.hypotheses = 1;
    for (const int k : partners) partners_.push_back(&photos.all[static_cast<size_t>(k)]);
    for (const int k : others) {
      const MeasuredView& other = photos.measured[static_cast<size_t>(k)];
      others_.push_back({&other, other.camera.world_to_camera * view_.camera.world_to_camera.inverse()});
    }
  }

  void add(const Surface& surface, int label, ImageF& costs) const {
    const ImageF& depth = surface.depth;
    const CameraPlane* const plane = surface.plane;
    const CostVolume photo = sweep_prior_depth({view_.camera, view_.luma, depth}, partners_, sweep_);
    for (int y = 0; y < depth.height; ++y) {
      for (int x = 0; x < depth.width; ++x) {
        const float z = depth.at(x, y), measured = measured_.at(x, y);
        float& cost = costs.at(x, y, label);
        if (!is_depth(z) || (plane && z > farthest_)) {
          cost = kNowhere;
        } else if (measured > 0) {
          cost =
              plane ? saturated(std::log(static_cast<double>(z / measured)) / settings_.reach) : settings_.of_own_depth;
        } else {
          cost = settings_.photo * std::min(1.0f, *photo.at(x, y)) + of_others(x, y, static_cast<double>(z)) +
                 (plane ? of_distance(x, y, static_cast<double>(z)) : settings_.of_between);
        }
        if (plane) cost += of_direction(x, y, *plane) + of_class(x, y, *surface.class_fit);
      }
    }
  }

 private:
  float of_distance(int x, int y, double z) const {
    const double own = static_cast<double>(view_.depth.at(x, y));
    return settings_.doubts.far > 0 && own > 0
               ? settings_.doubts.far * saturated(std::log(z / own) / settings_.doubts.reach)
               : 0;
  }

  float of_direction(int x, int y, const CameraPlane& plane) const {
    if (normals_.empty()) return 0;
    const float* n = normals_.pixel(x, y);  // 0 where the depth tells none, which is as doubtful as a right angle
    const double cosine = static_cast<double>(n[0]) * plane.normal.x + static_cast<double>(n[1]) * plane.normal.y +
                          static_cast<double>(n[2]) * plane.normal.z;
    return settings_.doubts.turned *
           saturated(std::acos(std::clamp(cosine, 0.0, 1.0)) * kDegreesPerRadian / settings_.doubts.turn);
  }

  float of_class(int x, int y, const std::vector<float>& fit) const {
    if (labels_.empty() || fit.empty()) return 0;
    const uint16_t label = labels_.at(x, y);
    if (label == kNoLabel) return 0.5f * settings_.doubts.foreign;  // it may be any class
    return settings_.doubts.foreign * (1 - (label < fit.size() ? fit[label] : 0));
  }

  struct Other {
    const MeasuredView* view;
    Rigidd to_it;
  };

  /// The other photos about a place: measured things behind it, and the place itself.
  float of_others(int x, int y, double z) const {
    const Vec3d place = view_.camera.ray(x + 0.5, y + 0.5) * z;
    int hidden = 0;
    bool confirmed = false;
    for (const Other& other : others_) {
      const Vec3d p = other.to_it * place;
      if (!(p.z > 0)) continue;
      const Vec2d at = other.view->camera.project(p);
      if (!other.view->camera.contains(at)) continue;
      const double seen = static_cast<double>(other.view->depth.at(static_cast<int>(at.x), static_cast<int>(at.y)));
      if (!(seen > 0)) continue;
      hidden += seen > p.z * (1 + settings_.least_hidden);
      confirmed |= std::abs(seen - p.z) <= settings_.agreement * p.z;
    }
    return settings_.hides * static_cast<float>(std::min(hidden, kMostHiding)) -
           (confirmed ? settings_.confirmed : 0.0f);
  }

  const MatchView& view_;
  const ImageF& measured_;
  const Image<uint16_t>& labels_;
  ImageF normals_;
  const BarePlaneSettings& settings_;
  SweepSettings sweep_;
  float farthest_;
  std::vector<const MatchView*> partners_;
  std::vector<Other> others_;
};

ImageF depth_on(const CameraPlane& plane, const Camera& camera) {
  ImageF depth(camera.width, camera.height, 1);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x)
      depth.at(x, y) = static_cast<float>(plane.depth(camera.ray(x + 0.5, y + 0.5)));
  }
  return depth;
}

/// Moves pixels onto known surfaces (`held`, which may be null), others onto the planes that `labels` says (0 = none),
/// and those between with them. Returns how many lie on one.
size_t move_onto(const std::vector<CameraPlane>& planes, const Image<uint8_t>& labels, const PlaneMeasurement* held,
                 const MatchView& view, const BarePlaneSettings& settings, const LogCorrectionSettings& spread,
                 PhotoDepth& depth) {
  ImageF given(depth.depth.width, depth.depth.height, 1), weight = depth.certainty;
  size_t on = 0;
  for (int y = 0; y < weight.height; ++y) {
    for (int x = 0; x < weight.width; ++x) {
      const float z = depth.depth.at(x, y);
      if (!is_depth(z)) continue;
      double factor = 0;
      if (held && held->weight.at(x, y) > 0) {
        factor = static_cast<double>(held->log_factor.at(x, y));
      } else {
        const uint8_t label = labels.at(x * labels.width / weight.width, y * labels.height / weight.height);
        const double there = label > 0 ? planes[label - 1u].depth(view.camera.ray(x + 0.5, y + 0.5)) : 0;
        if (!(there > 0)) continue;
        factor = std::log(there / static_cast<double>(z));
      }
      const float sure = weight.at(x, y), all = sure + static_cast<float>(settings.strength);
      weight.at(x, y) = all;
      given.at(x, y) = static_cast<float>(settings.strength * factor) / all;
      depth.certainty.at(x, y) = std::max(sure, static_cast<float>(settings.certainty));
      ++on;
    }
  }
  move_depth(given, weight, spread, view.luma, depth);
  return on;
}

}  // namespace

BarePlaneReport lay_on_bare_planes(const std::vector<MatchView>& views, const std::vector<Image<uint16_t>>& labels,
                                   const BarePlaneSettings& settings, const StereoSettings& stereo, ThreadPool& pool,
                                   std::vector<PhotoDepth>& depths, const KnownSurfaces& known) {
  BarePlaneReport report;
  const SmallPhotos photos = small_photos(views, labels, depths, settings.width, pool);
  const bool labelled = std::any_of(labels.begin(), labels.end(), [](const auto& image) { return !image.empty(); });
  report.planes = planes_of(photos, settings, labelled, known, pool);
  if (report.planes.empty()) return report;
  std::vector<const MatchView*> pointers;
  for (const MatchView& photo : photos.all) pointers.push_back(&photo);
  const std::vector<std::vector<int>> partners = stereo_partners(pointers, stereo);
  const std::vector<std::vector<int>> others =
      overlapping_views(pointers, pointers, settings.neighbours, stereo.least_overlap / 2, 2 * stereo.largest_turn);
  const std::vector<std::vector<float>> fit = class_fit(photos.measured, report.planes, settings.doubts.classes);
  std::vector<size_t> on(views.size(), 0);
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      if (depths[i].depth.empty()) continue;
      const MatchView& view = photos.all[i];
      const std::vector<CameraPlane> candidates = in_frame_of(view.camera, report.planes);
      const Evidence evidence(photos, i, others[i], partners[i], settings, stereo);
      ImageF costs(view.camera.width, view.camera.height, static_cast<int>(candidates.size()) + 1);
      evidence.add({view.depth}, 0, costs);
      for (size_t k = 0; k < candidates.size(); ++k) {
        evidence.add({depth_on(candidates[k], view.camera), &candidates[k], &fit[candidates[k].number - 1u]},
                     static_cast<int>(k) + 1, costs);
      }
      const Image<uint8_t> chosen = label_by_paths(costs, view.luma, photos.measured[i].labels, settings.paths);
      const bool holds = i < known.views.size() && !known.views[i].weight.empty();
      on[i] = move_onto(candidates, chosen, holds ? &known.views[i] : nullptr, views[i], settings, stereo.spread,
                        depths[i]);
    }
  });
  report.on_planes = share_of_pixels(on, depths);
  return report;
}

}  // namespace aligngs
