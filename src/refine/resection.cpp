#include "refine/resection.h"

#include <algorithm>
#include <iterator>

namespace aligngs {
namespace {

/// The views of observations count through `wanted`.
std::vector<Observation> look_for_points(const PlacedScene& scene, const std::vector<WantedPhoto*>& wanted,
                                         double search, const ResectionSettings& settings, ThreadPool& pool) {
  std::vector<TrackPhoto> photos;
  for (size_t i = 0; i < wanted.size(); ++i) photos.push_back({static_cast<int>(i), wanted[i]->match, wanted[i]->mask});
  return find_points(scene.tracks, scene.photos, photos, search, settings.tracks, pool);
}

/// Moves those that enough matches give a pose; sets `observations` of all.
void place_by_most(const PlacedScene& scene, const std::vector<WantedPhoto*>& wanted, double search,
                   const ResectionSettings& settings, ThreadPool& pool) {
  std::vector<std::vector<PointMatch>> matches(wanted.size());
  for (const Observation& o : look_for_points(scene, wanted, search, settings, pool)) {
    matches[static_cast<size_t>(o.view)].push_back({scene.tracks[static_cast<size_t>(o.point)].point, o.pixel});
  }
  for (size_t i = 0; i < wanted.size(); ++i) {
    const auto pose = ransac_pose(wanted[i]->match->camera, matches[i], settings.poses);
    const bool enough = pose && pose->agreeing >= settings.least_observations;
    wanted[i]->observations = enough ? pose->agreeing : 0;
    if (enough) wanted[i]->match->camera = pose->camera;
  }
}

/// Moves those that enough matches place; sets `observations` of all.
void place_once(const PlacedScene& scene, const std::vector<WantedPhoto*>& wanted, double search,
                const ResectionSettings& settings, ThreadPool& pool) {
  BundleProblem resection;
  resection.extent = scene.extent;
  resection.fixed_points = true;
  for (const WantedPhoto* photo : wanted) resection.cameras.push_back(photo->match->camera);
  for (const Track& t : scene.tracks) resection.points.push_back(t.point);
  resection.observations = look_for_points(scene, wanted, search, settings, pool);
  const std::vector<Camera> start = resection.cameras;
  resection.anchors = start;  // carried along with their neighbours, they are better than the prior
  BundleSettings bundle = settings.bundle;
  bundle.focal = 0;
  bundle.pixel = settings.coarse_pixel;
  adjust_bundle(resection, bundle, pool);
  const auto wrong = [&](const Observation& o) {
    return reprojection_error(resection.cameras[static_cast<size_t>(o.view)],
                              resection.points[static_cast<size_t>(o.point)], o.pixel) > settings.outlier;
  };
  auto& all = resection.observations;
  const auto count = [&](size_t i) {
    return static_cast<int>(
        std::count_if(all.begin(), all.end(), [i](const Observation& o) { return o.view == static_cast<int>(i); }));
  };
  const auto in_view = [&](const Camera& camera) {
    return std::count_if(resection.points.begin(), resection.points.end(), [&](const Vec3d& point) {
      const Vec3d p = camera.world_to_camera * point;
      return p.z > 0 && camera.contains(camera.project(p));
    });
  };
  std::vector<int> found;
  for (size_t i = 0; i < wanted.size(); ++i) found.push_back(count(i));
  all.erase(std::remove_if(all.begin(), all.end(), wrong), all.end());
  bundle.pixel = settings.bundle.pixel;
  adjust_bundle(resection, bundle, pool);
  for (size_t i = 0; i < wanted.size(); ++i) {
    const int fitting = count(i);
    const bool enough = fitting >= settings.least_observations && fitting >= settings.least_fitting * found[i] &&
                        fitting >= settings.least_shown * static_cast<double>(in_view(resection.cameras[i]));
    wanted[i]->observations = enough ? fitting : 0;
    if (enough) wanted[i]->match->camera = resection.cameras[i];
  }
}

}  // namespace

void place_photos(const PlacedScene& scene, std::vector<WantedPhoto>& wanted, const PhotoSearch& search,
                  const ResectionSettings& settings, ThreadPool& pool) {
  if (wanted.empty() || scene.tracks.empty()) return;
  std::vector<Camera> before;
  std::vector<WantedPhoto*> all, found;
  for (WantedPhoto& photo : wanted) {
    before.push_back(photo.match->camera);
    all.push_back(&photo);
  }
  (search.by_most ? place_by_most : place_once)(scene, all, search.reach, settings, pool);
  std::copy_if(all.begin(), all.end(), std::back_inserter(found),
               [](const WantedPhoto* photo) { return photo->observations > 0; });
  if (!found.empty()) place_once(scene, found, settings.tracks.near_search, settings, pool);
  for (size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].observations == 0) wanted[i].match->camera = before[i];
  }
}

}  // namespace aligngs
