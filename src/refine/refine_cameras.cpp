#include "refine/refine_cameras.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/median.h"
#include "refine/view_overlap.h"

namespace aligngs {
namespace {

/// A corner of one training photo and the places where others show it.
struct Track {
  int view = 0;
  Corner corner;
  Vec3d point;
  std::vector<Observation> observations;  ///< the first is the corner itself
};

constexpr double kFewestInWideSearch = 600;  // corners of a photo; they find cameras to some pixels

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
      find_tracks(round == 0 ? settings_.match.search : settings_.later_search);
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

  /// A small photo gets fewer corners than one of 320 x 240; a larger one no more, but as far apart in proportion: each is placed more
  /// exactly there, and takes longer to look for. A wide search, whose window has as many more pixels, makes do with fewer.
  CornerSettings corners_of(const ImageF& luma, double search) const {
    CornerSettings corners = settings_.corners;
    const double size = relative_size(luma);
    const bool wide = search > settings_.later_search;
    double most = (wide ? std::min(corners.per_view, settings_.wide_corners) : corners.per_view) * std::min(size, 1.0);
    if (size > 1) {
      corners.spacing = static_cast<int>(std::lround(corners.spacing * std::sqrt(size)));
      if (wide) most = std::max(std::min(most, kFewestInWideSearch), most / size);
    }
    corners.per_view = static_cast<int>(std::lround(most));
    return corners;
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

  void find_tracks(double search) {
    MatchSettings match_settings = settings_.match;
    match_settings.search = search;
    std::vector<const MatchView*> training;
    for (const int v : train_) training.push_back(&matches_[static_cast<size_t>(v)]);
    const auto near = overlapping_views(training, training, settings_.neighbours, settings_.least_overlap, settings_.largest_turn);
    std::vector<std::vector<Track>> of_view(train_.size());
    pool_.parallel_for(train_.size(), 1, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        const int view = train_[i];
        const RefineView& from = views_[static_cast<size_t>(view)];
        for (const Corner& corner : find_corners(from.match.luma, from.mask, corners_of(from.match.luma, search))) {
          Track track = start_track(view, corner);
          if (track.observations.empty()) continue;
          for (const int k : near[i]) {
            const int other = train_[static_cast<size_t>(k)];
            if (const auto found = guided_match(match(view), corner.x, corner.y, match(other), match_settings)) {
              track.observations.push_back(observation(other, found->pixel));
              track.observations.back().covariance = found->covariance;
            }
          }
          if (track.observations.size() >= 2) of_view[i].push_back(std::move(track));
        }
      }
    });
    tracks_.clear();
    for (auto& own : of_view) {
      for (Track& t : own) tracks_.push_back(std::move(t));
    }
  }

  Observation observation(int view, const Vec2d& pixel) const {
    Observation o;
    o.view = view;
    o.pixel = pixel;
    const ImageF& depth = match(view).depth;
    if (!depth.empty() && match(view).camera.contains(pixel)) {
      const float z = depth.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
      o.prior_depth = z > 0 && std::isfinite(z) ? static_cast<double>(z) : 0;
    }
    return o;
  }

  Track start_track(int view, const Corner& corner) const {
    Track track;
    track.view = view;
    track.corner = corner;
    const Observation own = observation(view, {corner.x + 0.5, corner.y + 0.5});
    if (own.prior_depth <= 0) return track;
    track.point = match(view).camera.unproject(own.pixel.x, own.pixel.y, own.prior_depth);
    track.observations.push_back(own);
    return track;
  }

  BundleProblem problem() const {
    BundleProblem out;
    out.extent = extent_;
    out.anchors = prior_;
    for (const MatchView& m : matches_) out.cameras.push_back(m.camera);
    for (const Track& t : tracks_) {
      for (Observation o : t.observations) {
        o.point = static_cast<int>(out.points.size());
        out.observations.push_back(o);
      }
      out.points.push_back(t.point);
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
    place_views(test_, settings_.match.search);
    std::vector<int> again;
    std::copy_if(test_.begin(), test_.end(), std::back_inserter(again), [&](int v) { return !placed(v); });
    if (!again.empty()) place_views(again, settings_.lost_search);
    for (const int v : test_) by_neighbour_[static_cast<size_t>(v)] = !placed(v);
  }

  /// Whether the last search for a test view found it.
  bool placed(int view) const { return test_observations_[static_cast<size_t>(view)] > 0; }

  /// Observations of the tracks' points in the views, searched within `search` of the image width.
  std::vector<Observation> find_points_in(const std::vector<int>& views, double search) const {
    MatchSettings match_settings = settings_.match;
    match_settings.search = search;
    std::vector<const MatchView*> training, wanted;
    for (const int v : train_) training.push_back(&match(v));
    for (const int v : views) wanted.push_back(&match(v));
    const auto near = overlapping_views(training, wanted, static_cast<int>(wanted.size()), settings_.least_overlap, settings_.largest_turn);
    std::vector<std::vector<Observation>> found(tracks_.size());
    pool_.parallel_for(tracks_.size(), 64, [&](size_t begin, size_t end, int) {
      for (size_t t = begin; t < end; ++t) {
        const Track& track = tracks_[t];
        const auto own = std::find(train_.begin(), train_.end(), track.view);
        for (const int k : near[static_cast<size_t>(own - train_.begin())]) {
          const int view = views[static_cast<size_t>(k)];
          const auto place = guided_match(match(track.view), track.corner.x, track.corner.y, match(view), match_settings);
          if (!place) continue;
          Observation o;
          o.view = view;
          o.point = static_cast<int>(t);
          o.pixel = place->pixel;
          o.covariance = place->covariance;
          found[t].push_back(o);
        }
      }
    });
    std::vector<Observation> all;
    for (const auto& own : found) all.insert(all.end(), own.begin(), own.end());
    return all;
  }

  /// Searched, and searched again near the place found, which finds more. Views that are not placed both times stay where they were.
  void place_views(const std::vector<int>& views, double search) {
    std::vector<Camera> before;
    for (const int v : views) before.push_back(match(v).camera);
    register_views(views, search);
    std::vector<int> found;
    std::copy_if(views.begin(), views.end(), std::back_inserter(found), [&](int v) { return placed(v); });
    if (!found.empty()) register_views(found, settings_.later_search);
    for (size_t i = 0; i < views.size(); ++i) {
      if (!placed(views[i])) matches_[static_cast<size_t>(views[i])].camera = before[i];
    }
  }

  /// Moves those of the views that enough observations place; of the others none counts. Wrong matches agree with some pose, too, but
  /// never most of them.
  void register_views(const std::vector<int>& views, double search) {
    BundleProblem resection = problem();
    resection.fixed_points = true;
    resection.anchors = resection.cameras;  // carried along with their neighbours, they are better than the prior
    resection.observations = find_points_in(views, search);
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
