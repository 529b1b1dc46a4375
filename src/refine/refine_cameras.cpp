#include "refine/refine_cameras.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

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
    placed_by_.assign(views.size(), 0);
    misplaced_.assign(views.size(), false);
    checked_.assign(views.size(), false);
    if (settings.share_focal) share_focal();
  }

  RefineResult run(const RefineProgress& progress) {
    if (views_.empty()) return {};
    const double steps = settings_.rounds + 1;
    int rounds = settings_.rounds;
    for (int round = 0; round < rounds; ++round) {
      if (progress) progress(std::min(round, settings_.rounds) / steps);
      tracks_ =
          find_tracks(track_photos(train_), round == 0 ? settings_.tracks.match.search : settings_.tracks.near_search,
                      settings_.tracks, pool_);
      if (round == 0) keep_agreeing_matches(tracks_, track_photos(train_), settings_.consensus, pool_);
      adjust();
      const bool found = find_lost_photos(round == 0 ? settings_.first_lost_share : settings_.lost_share);
      if (found && round + 1 == settings_.rounds) ++rounds;  // what they show has to be matched where they are now
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
    for (const int v : train_)
      relative.push_back(match(v).camera.fx / std::max(match(v).camera.width, match(v).camera.height));
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

  /// And tracks that fewer than two photos are left of.
  template <class Unwanted>
  void drop_observations(const Unwanted& unwanted) {
    for (Track& t : tracks_) {
      t.observations.erase(std::remove_if(t.observations.begin(), t.observations.end(),
                                          [&](const Observation& o) { return unwanted(t, o); }),
                           t.observations.end());
    }
    tracks_.erase(
        std::remove_if(tracks_.begin(), tracks_.end(), [](const Track& t) { return t.observations.size() < 2; }),
        tracks_.end());
  }

  void drop_outliers() {
    drop_observations([&](const Track& t, const Observation& o) {
      return reprojection_error(match(o.view).camera, t.point, o.pixel) > settings_.outlier;
    });
  }

  void adjust() {
    matched_ = count_training_observations();
    if (!adjusted_) {
      BundleSettings coarse = settings_.bundle;
      for (const double share : settings_.graduated) {
        coarse.pixel = share * matches_.front().camera.width;
        solve(coarse);
      }
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
    BundleReport report = adjust_bundle(bundle, settings, pool_);
    if (adjusted_) {  // the report starts with the cameras of the input
      report.start_rms = bundle_.start_rms;
      report.start_median = bundle_.start_median;
    }
    bundle_ = report;
    adjusted_ = true;
    take(bundle);
  }

  /// By view.
  std::vector<int> count_training_observations() const {
    std::vector<int> counts(views_.size(), 0);
    for (const Track& t : tracks_) {
      for (const Observation& o : t.observations) ++counts[static_cast<size_t>(o.view)];
    }
    return counts;
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
    const std::vector<int> counts = count_training_observations();
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

  /// Training photos whose matches agree with the cameras far less often than the others', or too rarely at all. Wrong
  /// matches agree with some pose: a wallpaper's pattern fits one flower further, too.
  std::vector<int> lost_photos(double lost_share) const {
    const std::vector<int> fitting = count_training_observations();
    const auto share = [&](int v) {
      return static_cast<double>(fitting[static_cast<size_t>(v)]) / std::max(1, matched_[static_cast<size_t>(v)]);
    };
    std::vector<double> shares;
    for (const int v : train_) shares.push_back(share(v));
    if (shares.empty()) return {};
    const double least = lost_share * median_of(std::move(shares));
    std::vector<int> lost;
    std::copy_if(train_.begin(), train_.end(), std::back_inserter(lost), [&](int v) {
      return fitting[static_cast<size_t>(v)] < settings_.least_observations || share(v) < least;
    });
    return lost;
  }

  /// Training photos that have moved much farther than the others, each once. Their matches may agree and still be
  /// wrong: a pattern that repeats holds a photo one flower further.
  std::vector<int> strayed_photos() {
    const auto shift = [&](int v) { return norm(match(v).camera.centre() - prior_[static_cast<size_t>(v)].centre()); };
    std::vector<double> shifts;
    for (const int v : train_) shifts.push_back(shift(v));
    if (shifts.empty()) return {};
    const double most = std::max(settings_.bundle.centre * extent_, settings_.stray_factor * median_of(shifts));
    std::vector<int> strayed;
    for (size_t i = 0; i < train_.size(); ++i) {
      const int v = train_[i];
      if (!(shifts[i] > most) || checked_[static_cast<size_t>(v)]) continue;
      checked_[static_cast<size_t>(v)] = true;
      strayed.push_back(v);
    }
    return strayed;
  }

  /// Forgets what lost and strayed photos seemed to show and looks for them farther off, by the points of the others.
  /// Whether any was found; the others follow their neighbours.
  bool find_lost_photos(double lost_share) {
    std::vector<int> lost = lost_photos(lost_share);
    const auto is_lost = [&](int v) { return std::find(lost.begin(), lost.end(), v) != lost.end(); };
    std::vector<std::pair<int, Camera>> strayed;
    for (const int v : strayed_photos()) {
      if (is_lost(v)) continue;
      strayed.emplace_back(v, match(v).camera);
    }
    for (const auto& [v, camera] : strayed) lost.push_back(v);
    if (lost.empty() || lost.size() == train_.size()) return false;
    tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(), [&](const Track& t) { return is_lost(t.view); }),
                  tracks_.end());
    drop_observations([&](const Track&, const Observation& o) { return is_lost(o.view); });
    solve(settings_.bundle);
    drop_outliers();
    follow_neighbours();
    std::vector<int> others;
    std::copy_if(train_.begin(), train_.end(), std::back_inserter(others), [&](int v) { return !is_lost(v); });
    std::vector<int> found = place(lost, others, {{settings_.lost_search, true}});
    for (const int v : found) misplaced_[static_cast<size_t>(v)] = true;
    for (const auto& [v, camera] : strayed) {
      if (!keep_camera(v, camera, others)) continue;
      misplaced_[static_cast<size_t>(v)] = false;
      found.push_back(v);
    }
    for (const int v : found) by_neighbour_[static_cast<size_t>(v)] = false;
    return !found.empty();
  }

  /// Puts a photo back to where it was if more points of the others agree with that place than with the one found.
  bool keep_camera(int view, const Camera& camera, const std::vector<int>& others) {
    const size_t v = static_cast<size_t>(view);
    const Camera found = match(view).camera;
    const int agreeing = placed_by_[v];
    matches_[v].camera.world_to_camera = camera.world_to_camera;
    place({view}, others, {{settings_.tracks.near_search, false}});
    if (placed_by_[v] > agreeing) return true;
    matches_[v].camera = found;
    placed_by_[v] = agreeing;
    return false;
  }

  /// Looks for the wanted by the tracks of others, in one way after the other until they are placed. Those that were.
  std::vector<int> place(std::vector<int> wanted, const std::vector<int>& by,
                         const std::vector<PhotoSearch>& searches) {
    const std::vector<TrackPhoto> photos = track_photos(by);
    std::vector<int> found;
    for (const PhotoSearch& search : searches) {
      std::vector<WantedPhoto> tried;
      for (const int v : wanted)
        tried.push_back({v, &matches_[static_cast<size_t>(v)], &views_[static_cast<size_t>(v)].mask, 0});
      place_photos({tracks_, photos, extent_}, tried, search, settings_, pool_);
      wanted.clear();
      for (const WantedPhoto& photo : tried) {
        placed_by_[static_cast<size_t>(photo.view)] = photo.observations;
        (photo.observations > 0 ? found : wanted).push_back(photo.view);
      }
    }
    return found;
  }

  /// Test photos against the points of the training photos, which they do not move.
  void register_test_views() {
    if (tracks_.empty()) return;
    for (const int v : test_) by_neighbour_[static_cast<size_t>(v)] = true;
    const std::vector<int> found =
        place(test_, train_,
              {{settings_.tracks.match.search, false}, {settings_.lost_search, false}, {settings_.lost_search, true}});
    for (const int v : found) by_neighbour_[static_cast<size_t>(v)] = false;
  }

  DepthGrid depth_correction(int view) const {
    std::vector<DepthGridSample> samples;
    const Camera& camera = match(view).camera;
    for (const Track& t : tracks_) {
      if (t.observations.size() < 3) continue;  // two rays say little about depth
      for (const Observation& o : t.observations) {
        if (o.view != view || o.prior_depth <= 0) continue;
        const double z = (camera.world_to_camera * t.point).z;
        if (z > 0)
          samples.push_back({o.pixel.x / camera.width, o.pixel.y / camera.height, std::log(z / o.prior_depth)});
      }
    }
    return fit_depth_grid(samples, settings_.grid);
  }

  RefineResult collect() const {
    RefineResult result;
    result.bundle = bundle_;
    result.focal_factor = focal_factor_;
    result.tracks = tracks_.size();
    const std::vector<int> counts = count_training_observations();
    for (size_t i = 0; i < views_.size(); ++i) {
      const int v = static_cast<int>(i);
      RefinedView out;
      out.camera = matches_[i].camera;
      out.by_neighbour = !by_neighbour_.empty() && by_neighbour_[i];
      out.misplaced = misplaced_[i];
      out.observations = views_[i].test ? placed_by_[i] : counts[i];
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
  std::vector<bool> misplaced_;
  std::vector<bool> checked_;   ///< strayed photos that were looked for
  std::vector<int> placed_by_;  ///< observations by view, of photos looked for by others' tracks
  std::vector<int> matched_;    ///< observations by view before the last round's outliers were dropped
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
