#include "refine/screen_photos.h"

#include <cmath>
#include <optional>
#include <utility>

#include "core/angles.h"

namespace aligngs {
namespace {

constexpr double kSameDirection = 5;  // degrees: normals nearer to each other are tried once
constexpr size_t kPeaks = 3;          // of a photo's agreement that the other photos are asked about, for each normal

}  // namespace

Vec3d ray_in_world(const Camera& camera, double u, double v) {
  return transpose_times(camera.world_to_camera.rotation, camera.ray(u, v));
}

Vec3d ScreenPhotos::middle_ray(const ScreenRegion& region) const {
  return ray_in_world(camera(region), region.centre.x, region.centre.y);
}

Vec3d ScreenPhotos::middle_at(const ScreenRegion& region, double depth) const {
  return camera(region).centre() + middle_ray(region) * depth;
}

WorldPlane ScreenPhotos::plane_at(const ScreenRegion& region, const Vec3d& normal, double depth) const {
  return {normal, -dot(normal, middle_at(region, depth))};
}

double ScreenPhotos::depth_on(const ScreenRegion& region, const WorldPlane& plane) const {
  const double distance = dot(plane.normal, camera(region).centre()) + plane.offset,
               slope = -dot(plane.normal, middle_ray(region));
  return distance > 0 && slope > 0 ? distance / slope : 0;
}

std::vector<Vec3d> ScreenPhotos::normals_for(const ScreenRegion& region) const {
  const Vec3d to_camera = -normalized(middle_ray(region));
  const double same = std::cos(kSameDirection * kRadiansPerDegree);
  std::vector<Vec3d> out;
  const auto add = [&](const Vec3d& normal) {
    if (dot(normal, to_camera) < settings.least_cosine) return;
    if (std::none_of(out.begin(), out.end(), [&](const Vec3d& known) { return dot(known, normal) > same; }))
      out.push_back(normal);
  };
  for (const ScenePlane& plane : planes) {
    if (plane.kind == PlaneKind::kWall) add(plane.normal);
  }
  const std::optional<Vec3d> vertical = vertical_of(planes);
  add(vertical ? normalized(region.normal - *vertical * dot(region.normal, *vertical)) : region.normal);
  return out;
}

bool ScreenPhotos::is_in_room(const ScreenRegion& region, double depth) const {
  const Vec3d centre = camera(region).centre(), place = middle_at(region, depth);
  return std::none_of(planes.begin(), planes.end(), [&](const ScenePlane& plane) {
    return plane.kind == PlaneKind::kWall && plane.distance(centre) > 0 &&
           plane.distance(place) < -settings.behind * depth;
  });
}

double ScreenPhotos::agreement_of(const ScreenRegion& region, const WorldPlane& plane) const {
  const double depth = depth_on(region, plane);
  if (!(depth > 0)) return 0;
  const ScreenSettings& s = settings;
  const Camera& own = camera(region);
  const Vec3d place = middle_at(region, depth), from = normalized(place - own.centre());
  double sum = 0, whole = 0;
  int count = 0;
  for (size_t v = 0; v < views.size(); ++v) {
    const Camera& other = views[v].camera;
    const double cosine = dot(from, normalized(place - other.centre()));
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegreesPerRadian;
    if (v == region.view || angle < s.least_angle) continue;
    const OutlineAgreement a = agreement(region.outline, own, plane, other, gradients[v], s.regions.outline);
    if (a.inside < s.least_inside) continue;
    const double weight = std::min(1.0, angle / s.good_angle);
    sum += weight * a.share;
    whole += weight;
    ++count;
  }
  return count >= s.least_photos ? sum / whole : 0;
}

double ScreenPhotos::mean_agreement(const std::vector<ScreenRegion>& regions, const std::vector<size_t>& of,
                                    const WorldPlane& plane) const {
  double sum = 0;
  for (const size_t i : of) sum += agreement_of(regions[i], plane);
  return of.empty() ? 0 : sum / static_cast<double>(of.size());
}

std::vector<WorldPlane> ScreenPhotos::candidates(const ScreenRegion& region) const {
  const ScreenSettings& s = settings;
  std::vector<WorldPlane> out;
  for (const Vec3d& normal : normals_for(region)) {
    std::vector<WorldPlane> tried;
    std::vector<double> curve;
    for (int k = 0; k < s.hypotheses; ++k) {
      const double depth = region.depth * std::exp(k * log_step() - s.range);
      tried.push_back(plane_at(region, normal, depth));
      curve.push_back(is_in_room(region, depth) ? agreement_of(region, tried.back()) : 0);
    }
    std::vector<std::pair<double, size_t>> peaks;
    for (size_t k = 0; k < curve.size(); ++k) {
      const double before = k > 0 ? curve[k - 1] : 0, after = k + 1 < curve.size() ? curve[k + 1] : 0;
      if (curve[k] > 0 && curve[k] >= before && curve[k] > after) peaks.emplace_back(-curve[k], k);
    }
    std::sort(peaks.begin(), peaks.end());
    for (size_t p = 0; p < std::min(peaks.size(), kPeaks); ++p) out.push_back(tried[peaks[p].second]);
  }
  return out;
}

}  // namespace aligngs
