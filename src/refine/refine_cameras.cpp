#include "refine/refine_cameras.h"

#include <algorithm>
#include <cmath>

#include "refine/camera_refinement.h"
#include "refine/photo_finder.h"

namespace aligngs {
namespace {

DepthGrid depth_correction(const CameraRefinement& state, int view) {
  std::vector<DepthGridSample> samples;
  const Camera& camera = state.match(view).camera;
  for (const Track& t : state.tracks) {
    if (t.observations.size() < 3) continue;  // two rays say little about depth
    for (const Observation& o : t.observations) {
      if (o.view != view || o.prior_depth <= 0) continue;
      const double z = (camera.world_to_camera * t.point).z;
      if (z > 0) samples.push_back({o.pixel.x / camera.width, o.pixel.y / camera.height, std::log(z / o.prior_depth)});
    }
  }
  return fit_depth_grid(samples, state.settings.grid);
}

RefineResult collect(const CameraRefinement& state, const PhotoFinder& finder) {
  RefineResult result;
  result.bundle = state.bundle;
  result.focal_factor = state.focal_factor;
  result.tracks = state.tracks.size();
  const std::vector<int> counts = state.count_training_observations();
  for (size_t i = 0; i < state.views.size(); ++i) {
    const int v = static_cast<int>(i);
    RefinedView out;
    out.camera = state.matches[i].camera;
    out.by_neighbour = !state.by_neighbour.empty() && state.by_neighbour[i];
    out.misplaced = finder.misplaced(i);
    out.observations = state.views[i].test ? finder.observations(i) : counts[i];
    if (!state.views[i].test) out.depth = depth_correction(state, v);
    measure_change(state.prior[i], out);
    result.views.push_back(out);
  }
  for (const Track& t : state.tracks) {
    if (t.observations.size() < 3) continue;
    result.points.positions.push_back(t.point.cast<float>());
    const ImageF& color = state.views[static_cast<size_t>(t.view)].color;
    const float* c = color.pixel(t.corner.x, t.corner.y);
    result.points.colors.push_back({c[0], c[1], c[2]});
  }
  return result;
}

}  // namespace

void measure_change(const Camera& prior, RefinedView& view) {
  view.shifted = norm(view.camera.centre() - prior.centre());
  view.turned = rotation_angle_between_degrees(view.camera.world_to_camera.rotation, prior.world_to_camera.rotation);
}

RefineResult refine_cameras(const std::vector<RefineView>& views, double extent, const RefineSettings& settings,
                            ThreadPool& pool, const RefineProgress& progress) {
  if (views.empty()) return {};
  CameraRefinement state(views, extent, settings, pool);
  PhotoFinder finder(state);
  const double steps = settings.rounds + 1;
  int rounds = settings.rounds;
  for (int round = 0; round < rounds; ++round) {
    if (progress) progress(std::min(round, settings.rounds) / steps);
    state.tracks =
        find_tracks(state.track_photos(state.train),
                    round == 0 ? settings.tracks.match.search : settings.tracks.near_search, settings.tracks, pool);
    if (round == 0) keep_agreeing_matches(state.tracks, state.track_photos(state.train), settings.consensus, pool);
    state.adjust();
    const bool found = finder.find_lost_photos(round == 0 ? settings.first_lost_share : settings.lost_share);
    if (found && round + 1 == settings.rounds) ++rounds;  // what they show has to be matched where they are now
  }
  if (progress) progress(settings.rounds / steps);
  finder.register_test_views();
  RefineResult result = collect(state, finder);
  if (progress) progress(1);
  return result;
}

}  // namespace aligngs
