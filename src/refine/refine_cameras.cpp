#include "refine/refine_cameras.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/median.h"

namespace aligngs {
namespace {

class Refinement {
 public:
  Refinement(const std::vector<RefineView>& views, double extent, const RefineSettings& settings, ThreadPool& pool)
      : settings_(settings), extent_(extent), pool_(pool), views_(views) {
    for (const RefineView& v : views) {
      matches_.push_back(v.match);
      prior_.push_back(v.match.camera);
    }
    for (size_t i = 0; i < views.size(); ++i) (views[i].test ? test_ : train_).push_back(static_cast<int>(i));
    if (settings.share_focal) share_focal();
  }

  RefineResult run(const RefineProgress& progress) {
    const double steps = settings_.rounds + 1;
    for (int round = 0; round < settings_.rounds; ++round) {
      if (progress) progress(round / steps);
      tracks_ = find_tracks(track_photos(train_), round == 0 ? settings_.tracks.match.search : settings_.tracks.near_search, settings_.tracks, pool_);
      adjust();
    }
    if (progress) progress(settings_.rounds / steps);
    register_test_views();
    RefineResult result = collect();
    if (progress) progress(1);
    return result;
  }

 private:
  const MatchView& match(int view) const { return matches_[static_cast<size_t>(view)]; }

  std::vector<TrackPhoto> track_photos(const std::vector<int>& views) const {
    std::vector<TrackPhoto> out;
    for (const int v : views) out.push_back({v, &match(v), &views_[static_cast<size_t>(v)].mask});
    return out;
  }

  /// Sizes may differ (a phone turned by 90 degrees), so focal lengths are compared relative to the longer side.
  void share_focal() {
    std::vector<double> relative;
    for (const int v : train_) relative.push_back(match(v).camera.fx / std::max(match(v).camera.width, match(v).camera.height));
    if (relative.empty()) return;
    const double median = median_of(std::move(relative));
    for (MatchView& m : matches_) {
      const double aspect = m.camera.fy / m.camera.fx;
      m.camera.fx = median * std::max(m.camera.width, m.camera.height);
      m.camera.fy = aspect * m.camera.fx;
    }
  }

  /// The cameras and points of the moment.
  BundleProblem without_observations() const {
    BundleProblem out;
    out.extent = extent_;
    for (const MatchView& m : matches_) out.cameras.push_back(m.camera);
    for (const Track& t : tracks_) out.points.push_back(t.point);
    return out;
  }

  BundleProblem problem() const {
    BundleProblem out = without_observations();
    out.anchors = prior_;
    for (size_t t = 0; t < tracks_.size(); ++t) {
      for (Observation o : tracks_[t].observations) {
        o.point = static_cast<int>(t);
        out.observations.push_back(o);
      }
    }
    return out;
  }

  void take(const BundleProblem& solved) {
    for (const int v : train_) matches_[static_cast<size_t>(v)].camera = solved.cameras[static_cast<size_t>(v)];
    for (const int v : test_) {  // one lens: its focal length is known from the training views
      Camera& camera = matches_[static_cast<size_t>(v)].camera;
      if (settings_.share_focal) {
        camera.fx *= solved.focal_factor;
        camera.fy *= solved.focal_factor;
      }
    }
    for (size_t i = 0; i < tracks_.size(); ++i) tracks_[i].point = solved.points[i];
    focal_factor_ *= solved.focal_factor;
  }

  void drop_outliers() {
    for (Track& t : tracks_) {
      const auto wrong = [&](const Observation& o) {
        return reprojection_error(match(o.view).camera, t.point, o.pixel) > settings_.outlier;
      };
      t.observations.erase(std::remove_if(t.observations.begin(), t.observations.end(), wrong), t.observations.end());
    }
    tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(), [](const Track& t) { return t.observations.size() < 2; }),
                  tracks_.end());
  }

  void adjust() {
    if (!adjusted_) {
      BundleSettings coarse = settings_.bundle;
      coarse.pixel = settings_.coarse_pixel;
      solve(coarse);
    }
    drop_outliers();
    solve(settings_.bundle);
    drop_outliers();
    follow_neighbours();
  }

  void solve(const BundleSettings& settings) {
    BundleProblem bundle = problem();
    BundleReport report = adjust_bundle(bundle, settings);
    if (adjusted_) {  // the report starts with the cameras as they came
      report.start_rms = bundle_.start_rms;
      report.start_median = bundle_.start_median;
    }
    bundle_ = report;
    adjusted_ = true;
    take(bundle);
  }

  int count_observations(int view) const {
    int count = 0;
    for (const Track& t : tracks_) {
      count += static_cast<int>(std::count_if(t.observations.begin(), t.observations.end(), [&](const Observation& o) { return o.view == view; }));
    }
    return count;
  }

  /// The well-determined training view whose prior camera is nearest; -1 without any.
  int nearest_anchor(int view, const std::vector<int>& counts) const {
    int best = -1;
    double best_distance = std::numeric_limits<double>::infinity();
    for (const int v : train_) {
      if (v == view || counts[static_cast<size_t>(v)] < settings_.least_observations) continue;
      const Vec3d d = prior_[static_cast<size_t>(v)].centre() - prior_[static_cast<size_t>(view)].centre();
      if (dot(d, d) >= best_distance) continue;
      best_distance = dot(d, d);
      best = v;
    }
    return best;
  }

  /// Pose of `view` that keeps its prior pose relative to `anchor`, which has moved.
  Rigidd carried_pose(int view, int anchor) const {
    const Rigidd& own = prior_[static_cast<size_t>(view)].world_to_camera;
    return own * prior_[static_cast<size_t>(anchor)].world_to_camera.inverse() * match(anchor).camera.world_to_camera;
  }

  void follow_neighbours() {
    std::vector<int> counts(views_.size(), 0);
    for (const int v : train_) counts[static_cast<size_t>(v)] = count_observations(v);
    by_neighbour_.assign(views_.size(), false);
    for (const int v : train_) {
      if (counts[static_cast<size_t>(v)] >= settings_.least_observations) continue;
      const int anchor = nearest_anchor(v, counts);
      if (anchor < 0) continue;
      matches_[static_cast<size_t>(v)].camera.world_to_camera = carried_pose(v, anchor);
      by_neighbour_[static_cast<size_t>(v)] = true;
    }
    for (const int v : test_) {
      const int anchor = nearest_anchor(v, counts);
      if (anchor >= 0) matches_[static_cast<size_t>(v)].camera.world_to_camera = carried_pose(v, anchor);
    }
  }

  /// Test photos against the points of the training photos, which they do not move.
  void register_test_views() {
    if (test_.empty() || tracks_.empty()) return;
    test_observations_.assign(views_.size(), 0);
    place_views(test_, settings_.tracks.match.search);
    std::vector<int> again;
    std::copy_if(test_.begin(), test_.end(), std::back_inserter(again), [&](int v) { return !placed(v); });
    if (!again.empty()) place_views(again, settings_.lost_search);
    for (const int v : test_) by_neighbour_[static_cast<size_t>(v)] = !placed(v);
  }

  /// Whether the last search for a test view found it.
  bool placed(int view) const { return test_observations_[static_cast<size_t>(view)] > 0; }

  /// Searched, and searched again near the place found, which finds more. Views that are not placed both times stay where they were.
  void place_views(const std::vector<int>& views, double search) {
    std::vector<Camera> before;
    for (const int v : views) before.push_back(match(v).camera);
    register_views(views, search);
    std::vector<int> found;
    std::copy_if(views.begin(), views.end(), std::back_inserter(found), [&](int v) { return placed(v); });
    if (!found.empty()) register_views(found, settings_.tracks.near_search);
    for (size_t i = 0; i < views.size(); ++i) {
      if (!placed(views[i])) matches_[static_cast<size_t>(views[i])].camera = before[i];
    }
  }

  /// Moves those of the views that enough observations place; of the others none counts. Wrong matches agree with some pose, too, but
  /// never most of them.
  void register_views(const std::vector<int>& views, double search) {
    BundleProblem resection = without_observations();
    resection.fixed_points = true;
    resection.anchors = resection.cameras;  // carried along with their neighbours, they are better than the prior
    resection.observations = find_points(tracks_, track_photos(train_), track_photos(views), search, settings_.tracks, pool_);
    BundleSettings settings = settings_.bundle;
    settings.focal = 0;
    settings.pixel = settings_.coarse_pixel;
    adjust_bundle(resection, settings);
    const auto wrong = [&](const Observation& o) {
      return reprojection_error(resection.cameras[static_cast<size_t>(o.view)], resection.points[static_cast<size_t>(o.point)], o.pixel) > settings_.outlier;
    };
    auto& all = resection.observations;
    const auto count = [&](int v) {
      return static_cast<int>(std::count_if(all.begin(), all.end(), [v](const Observation& o) { return o.view == v; }));
    };
    std::vector<int> found;
    for (const int v : views) found.push_back(count(v));
    all.erase(std::remove_if(all.begin(), all.end(), wrong), all.end());
    settings.pixel = settings_.bundle.pixel;
    adjust_bundle(resection, settings);
    for (size_t i = 0; i < views.size(); ++i) {
      const int v = views[i], fitting = count(v);
      const bool enough = fitting >= settings_.least_observations && fitting >= settings_.least_fitting * found[i];
      test_observations_[static_cast<size_t>(v)] = enough ? fitting : 0;
      if (enough) matches_[static_cast<size_t>(v)].camera = resection.cameras[static_cast<size_t>(v)];
    }
  }

  DepthGrid depth_correction(int view) const {
    std::vector<DepthSample> samples;
    const Camera& camera = match(view).camera;
    for (const Track& t : tracks_) {
      if (t.observations.size() < 3) continue;  // two rays say little about depth
      for (const Observation& o : t.observations) {
        if (o.view != view || o.prior_depth <= 0) continue;
        const double z = (camera.world_to_camera * t.point).z;
        if (z > 0) samples.push_back({o.pixel.x / camera.width, o.pixel.y / camera.height, std::log(z / o.prior_depth)});
      }
    }
    return fit_depth_grid(samples, settings_.grid);
  }

  RefineResult collect() const {
    RefineResult result;
    result.bundle = bundle_;
    result.focal_factor = focal_factor_;
    result.tracks = tracks_.size();
    for (size_t i = 0; i < views_.size(); ++i) {
      const int v = static_cast<int>(i);
      RefinedView out;
      out.camera = matches_[i].camera;
      out.by_neighbour = !by_neighbour_.empty() && by_neighbour_[i];
      out.observations = views_[i].test ? (test_observations_.empty() ? 0 : test_observations_[i]) : count_observations(v);
      if (!views_[i].test) out.depth = depth_correction(v);
      measure_change(prior_[i], out);
      result.views.push_back(out);
    }
    for (const Track& t : tracks_) {
      if (t.observations.size() < 3) continue;
      result.points.positions.push_back(t.point.cast<float>());
      const ImageF& color = views_[static_cast<size_t>(t.view)].color;
      const float* c = color.pixel(t.corner.x, t.corner.y);
      result.points.colors.push_back({c[0], c[1], c[2]});
    }
    return result;
  }

  const RefineSettings& settings_;
  double extent_;
  ThreadPool& pool_;
  const std::vector<RefineView>& views_;
  std::vector<MatchView> matches_;  ///< as the views', with the cameras of the moment
  std::vector<Camera> prior_;
  std::vector<int> train_, test_;
  std::vector<Track> tracks_;
  std::vector<bool> by_neighbour_;
  std::vector<int> test_observations_;
  BundleReport bundle_;
  double focal_factor_ = 1;
  bool adjusted_ = false;
};

}  // namespace

void measure_change(const Camera& prior, RefinedView& view) {
  view.shifted = norm(view.camera.centre() - prior.centre());
  view.turned = rotation_angle_between_degrees(view.camera.world_to_camera.rotation, prior.world_to_camera.rotation);
}

RefineResult refine_cameras(const std::vector<RefineView>& views, double extent, const RefineSettings& settings,
                            ThreadPool& pool, const RefineProgress& progress) {
  return Refinement(views, extent, settings, pool).run(progress);
}

}  // namespace aligngs
