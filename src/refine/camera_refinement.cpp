#include "refine/camera_refinement.h"

#include <limits>
#include <utility>

#include "core/median.h"

namespace aligngs {

CameraRefinement::CameraRefinement(const std::vector<RefineView>& given, double scene_extent,
                                   const RefineSettings& refine_settings, ThreadPool& threads)
    : settings(refine_settings), extent(scene_extent), pool(threads), views(given) {
  for (const RefineView& v : views) {
    matches.push_back(v.match);
    prior.push_back(v.match.camera);
  }
  for (size_t i = 0; i < views.size(); ++i) (views[i].test ? test : train).push_back(static_cast<int>(i));
  if (settings.share_focal) share_focal();
}

std::vector<TrackPhoto> CameraRefinement::track_photos(const std::vector<int>& of) const {
  std::vector<TrackPhoto> out;
  for (const int v : of) out.push_back({v, &match(v), &views[static_cast<size_t>(v)].mask});
  return out;
}

/// Sizes may differ (a phone turned by 90 degrees), so focal lengths are compared relative to the longer side.
void CameraRefinement::share_focal() {
  std::vector<double> relative;
  for (const int v : train)
    relative.push_back(match(v).camera.fx / std::max(match(v).camera.width, match(v).camera.height));
  if (relative.empty()) return;
  const double median = median_of(std::move(relative));
  for (MatchView& m : matches) {
    const double aspect = m.camera.fy / m.camera.fx;
    m.camera.fx = median * std::max(m.camera.width, m.camera.height);
    m.camera.fy = aspect * m.camera.fx;
  }
}

/// The cameras and points of the moment.
BundleProblem CameraRefinement::without_observations() const {
  BundleProblem out;
  out.extent = extent;
  for (const MatchView& m : matches) out.cameras.push_back(m.camera);
  for (const Track& t : tracks) out.points.push_back(t.point);
  return out;
}

BundleProblem CameraRefinement::problem() const {
  BundleProblem out = without_observations();
  out.anchors = prior;
  for (size_t t = 0; t < tracks.size(); ++t) {
    for (Observation o : tracks[t].observations) {
      o.point = static_cast<int>(t);
      out.observations.push_back(o);
    }
  }
  return out;
}

void CameraRefinement::take(const BundleProblem& solved) {
  for (const int v : train) matches[static_cast<size_t>(v)].camera = solved.cameras[static_cast<size_t>(v)];
  for (const int v : test) {  // one lens: its focal length is known from the training views
    Camera& camera = matches[static_cast<size_t>(v)].camera;
    if (settings.share_focal) {
      camera.fx *= solved.focal_factor;
      camera.fy *= solved.focal_factor;
    }
  }
  for (size_t i = 0; i < tracks.size(); ++i) tracks[i].point = solved.points[i];
  focal_factor *= solved.focal_factor;
}

void CameraRefinement::drop_outliers() {
  drop_observations([&](const Track& t, const Observation& o) {
    return reprojection_error(match(o.view).camera, t.point, o.pixel) > settings.outlier;
  });
}

void CameraRefinement::adjust() {
  matched = count_training_observations();
  if (!adjusted_) {
    BundleSettings coarse = settings.bundle;
    for (const double share : settings.graduated) {
      coarse.pixel = share * matches.front().camera.width;
      solve(coarse);
    }
    coarse.pixel = settings.coarse_pixel;
    solve(coarse);
  }
  drop_outliers();
  solve(settings.bundle);
  drop_outliers();
  follow_neighbours();
}

void CameraRefinement::solve(const BundleSettings& bundle_settings) {
  BundleProblem moved = problem();
  BundleReport report = adjust_bundle(moved, bundle_settings, pool);
  if (adjusted_) {  // the report starts with the cameras of the input
    report.start_rms = bundle.start_rms;
    report.start_median = bundle.start_median;
  }
  bundle = report;
  adjusted_ = true;
  take(moved);
}

std::vector<int> CameraRefinement::count_training_observations() const {
  std::vector<int> counts(views.size(), 0);
  for (const Track& t : tracks) {
    for (const Observation& o : t.observations) ++counts[static_cast<size_t>(o.view)];
  }
  return counts;
}

/// The well-determined training view whose prior camera is nearest; -1 without any.
int CameraRefinement::nearest_anchor(int view, const std::vector<int>& counts) const {
  int best = -1;
  double best_distance = std::numeric_limits<double>::infinity();
  for (const int v : train) {
    if (v == view || counts[static_cast<size_t>(v)] < settings.least_observations) continue;
    const Vec3d d = prior[static_cast<size_t>(v)].centre() - prior[static_cast<size_t>(view)].centre();
    if (dot(d, d) >= best_distance) continue;
    best_distance = dot(d, d);
    best = v;
  }
  return best;
}

/// Pose of `view` that keeps its prior pose relative to `anchor`, which has moved.
Rigidd CameraRefinement::carried_pose(int view, int anchor) const {
  const Rigidd& own = prior[static_cast<size_t>(view)].world_to_camera;
  return own * prior[static_cast<size_t>(anchor)].world_to_camera.inverse() * match(anchor).camera.world_to_camera;
}

void CameraRefinement::follow_neighbours() {
  const std::vector<int> counts = count_training_observations();
  by_neighbour.assign(views.size(), false);
  for (const int v : train) {
    if (counts[static_cast<size_t>(v)] >= settings.least_observations) continue;
    const int anchor = nearest_anchor(v, counts);
    if (anchor < 0) continue;
    matches[static_cast<size_t>(v)].camera.world_to_camera = carried_pose(v, anchor);
    by_neighbour[static_cast<size_t>(v)] = true;
  }
  for (const int v : test) {
    const int anchor = nearest_anchor(v, counts);
    if (anchor >= 0) matches[static_cast<size_t>(v)].camera.world_to_camera = carried_pose(v, anchor);
  }
}

}  // namespace aligngs
