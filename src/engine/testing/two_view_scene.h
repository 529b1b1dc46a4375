// Two views of one surface, for tests of steps with a neighbour.
#pragma once

#include <cmath>
#include <vector>

#include "engine/testing/scenes.h"

namespace aligngs::cpu::testing_scene {

/// A wall of overlapping flat splats two units in front of the first of two views: what both see is one surface.
inline GaussianModel make_wall() {
  RandomSceneOptions o;
  o.gaussians = 600;
  o.channels = 0;
  o.depth_min = 1.95;
  o.depth_max = 2.05;
  o.logit_min = 1;
  GaussianModel m = make_model(o);
  const Quaterniond turned{0.97, -0.1, 0.15, -0.08};  // the camera's axes in the world
  for (size_t i = 0; i < m.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) m.log_scales[3 * i + k] = k == 2 ? -5.0f : -2.0f + 0.01f * static_cast<float>(i % 7);
    const double q[4] = {turned.w, turned.x, turned.y, turned.z};
    for (size_t k = 0; k < 4; ++k) {
      m.rotations[4 * i + k] = static_cast<float>(q[k] + 0.02 * std::sin(3.0 * static_cast<double>(4 * i + k)));
    }
  }
  return m;
}

inline std::vector<TrainingView> make_view_pair() {
  RandomSceneOptions o;
  o.channels = 0;
  TrainingView first = make_view(o), second = make_view(o);
  second.data.camera.world_to_camera.translation.x += 0.1;
  return {first, second};
}

/// A step of the first view with the second as its neighbour and both multi-view terms.
inline StepRequest make_pair_request() {
  StepRequest r = make_request();
  r.losses.weight[Loss::kSemanticSoft] = r.losses.weight[Loss::kSemanticHard] = 0;
  r.losses.weight[Loss::kMultiViewGeometric] = 3;
  r.losses.weight[Loss::kMultiViewPhotometric] = 15;
  r.neighbour = {1, r.raster.near_plane, 9};
  return r;
}

/// The reference's gradients of such a step. The map losses are taken from maps of an engine, so that a pixel on a
/// threshold is no difference. `depth` is the plane depth of the neighbour.
inline auto pair_gradients(const RenderMaps<float>& maps, const ImageF& depth, const StepRequest& r, bool multi_view) {
  const std::vector<TrainingView> pair = make_view_pair();
  const NeighbourView<float> neighbour{pair[1], depth.data.data(), r.neighbour.seed};
  const auto losses = [&](const RenderMaps<double>&, LossTerms& terms, MapGradients<double>& out) {
    MapGradients<float> g;
    g.reset(maps.pixels());
    map_losses(MapLossInputs<float>{maps, pair[0], r.losses, nullptr, nullptr, multi_view ? &neighbour : nullptr},
               terms, g);
    out.color.assign(g.color.begin(), g.color.end());
    out.normal.assign(g.normal.begin(), g.normal.end());
    out.distance.assign(g.distance.begin(), g.distance.end());
  };
  return reference::gradients<double>(to_double(make_wall()), pair[0], r, 0.0,
                                      reference::MapLossFunction<double>(losses));
}

}  // namespace aligngs::cpu::testing_scene
