#include "refine/sensor_cameras.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/median.h"

namespace aligngs {
namespace {

std::vector<Camera> given_cameras(const std::vector<RefineView>& views) {
  std::vector<Camera> cameras;
  for (const RefineView& view : views) cameras.push_back(view.match.camera);
  return cameras;
}

/// Distances in pixels between matched and predicted places, where the depth of the corner's photo is what it is.
std::vector<double> distances(const std::vector<Track>& tracks, const std::vector<Camera>& cameras) {
  std::vector<double> out;
  for (const Track& track : tracks) {
    const Observation& corner = track.observations.front();
    if (!(corner.prior_depth > 0)) continue;
    const Vec3d point =
        cameras[static_cast<size_t>(track.view)].unproject(corner.pixel.x, corner.pixel.y, corner.prior_depth);
    for (const Observation& o : track.observations) {
      if (o.view == track.view) continue;
      const double distance = reprojection_error(cameras[static_cast<size_t>(o.view)], point, o.pixel);
      if (std::isfinite(distance)) out.push_back(distance);
    }
  }
  return out;
}

std::vector<Track> match_photos(const std::vector<RefineView>& views, const SensorCameraSettings& s, ThreadPool& pool) {
  std::vector<TrackPhoto> photos;
  for (size_t i = 0; i < views.size(); ++i) {
    if (!views[i].test) photos.push_back({static_cast<int>(i), &views[i].match, &views[i].mask});
  }
  return find_tracks(photos, s.refine.tracks.match.search, s.refine.tracks, pool);
}

/// The placed training photo nearest to `view` by the given cameras; -1 without any.
int nearest_placed(size_t view, const std::vector<Camera>& given, const std::vector<RefineView>& views,
                   const std::vector<bool>& placed) {
  int best = -1;
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < given.size(); ++i) {
    if (i == view || views[i].test || !placed[i]) continue;
    const double distance = norm(given[i].centre() - given[view].centre());
    if (distance >= nearest) continue;
    nearest = distance;
    best = static_cast<int>(i);
  }
  return best;
}

bool are_neighbours(const Camera& a, const Camera& b, double extent, const SensorCameraSettings& s) {
  return norm(a.centre() - b.centre()) <= s.near_distance * extent &&
         rotation_angle_between_degrees(a.world_to_camera.rotation, b.world_to_camera.rotation) <= s.near_angle;
}

/// Takes back steps that a tracker does not need, or that few matches asked for. How many.
int restrain(const std::vector<Camera>& given, const std::vector<RefineView>& views, const RefineResult& refined,
             double extent, const SensorCameraSettings& s, std::vector<Camera>& cameras) {
  std::vector<double> turns, shifts;
  for (size_t i = 0; i < views.size(); ++i) {
    if (views[i].test || refined.views[i].by_neighbour) continue;
    turns.push_back(refined.views[i].turned);
    shifts.push_back(refined.views[i].shifted);
  }
  if (turns.empty()) return 0;
  const double turn = s.largest_step * median_of(turns), shift = s.largest_step * median_of(shifts);
  std::vector<bool> placed;
  for (const RefinedView& v : refined.views) {
    placed.push_back(!v.by_neighbour && v.observations >= s.least_of_photo && v.turned <= turn && v.shifted <= shift);
  }
  int untrusted = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    if (placed[i]) continue;
    ++untrusted;
    cameras[i] = given[i];
    const int nearest = nearest_placed(i, given, views, placed);
    if (nearest < 0) continue;
    const auto anchor = static_cast<size_t>(nearest);
    if (!are_neighbours(given[i], given[anchor], extent, s)) continue;
    cameras[i].world_to_camera = given[i].world_to_camera * given[anchor].world_to_camera.inverse() *
                                 refined.views[anchor].camera.world_to_camera;
  }
  return untrusted;
}

}  // namespace

SensorCameraSettings::SensorCameraSettings() {
  refine.bundle.rotation = 0.5;       // degrees
  refine.bundle.centre = 0.01;        // of the extent: some centimetres
  refine.bundle.focal = 0.01;         // made known by the maker
  refine.bundle.depth = 0.015;        // of the distance
  refine.bundle.depth_scale = 0.005;  // a sensor measures metres
}

SensorCameras check_sensor_cameras(const std::vector<RefineView>& views, double extent, bool correct,
                                   const SensorCameraSettings& settings, ThreadPool& pool,
                                   const RefineProgress& progress) {
  SensorCameras out;
  out.cameras = given_cameras(views);
  const std::vector<Camera> given = out.cameras;
  const std::vector<Track> tracks = match_photos(views, settings, pool);
  std::vector<double> before = distances(tracks, given);
  out.matches = before.size();
  if (before.empty()) return out;
  out.before = out.after = median_of(std::move(before));
  const double width = static_cast<double>(given.front().width);
  if (!correct || out.matches < static_cast<size_t>(settings.least_matches) ||
      out.before < settings.least_residual * width)
    return out;
  const RefineResult refined = refine_cameras(views, extent, settings.refine, pool, progress);
  std::vector<Camera> cameras;
  for (const RefinedView& view : refined.views) cameras.push_back(view.camera);
  out.untrusted = restrain(given, views, refined, extent, settings, cameras);
  std::vector<double> after = distances(tracks, cameras);
  if (after.empty()) return out;
  out.after = median_of(std::move(after));
  if (out.after > settings.largest_left * out.before) return out;
  out.corrected = true;
  out.cameras = std::move(cameras);
  return out;
}

}  // namespace aligngs
