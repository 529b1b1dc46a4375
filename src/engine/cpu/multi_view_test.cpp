// Steps with a neighbour: the engine against the scalar reference.
#include <gtest/gtest.h>

#include "core/error.h"
#include "engine/cpu/test_scenes.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

/// A wall of overlapping flat splats two units in front of the first of two views: what both see is one surface.
GaussianModel wall() {
  SceneOptions o;
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

std::vector<TrainingView> views() {
  SceneOptions o;
  o.channels = 0;
  TrainingView first = make_view(o), second = make_view(o);
  second.data.camera.world_to_camera.translation.x += 0.1;
  return {first, second};
}

StepRequest request() {
  StepRequest r = make_request();
  r.losses.semantic_soft_weight = r.losses.semantic_hard_weight = 0;
  r.losses.multi_view_geometric_weight = 3;
  r.losses.multi_view_photometric_weight = 15;
  r.neighbour = {1, r.raster.near_plane, 9};
  return r;
}

template <class A, class B>
void expect_close(const A& a, const B& b, const char* what) {
  const Difference d = difference(a, b);
  EXPECT_LE(d.worst, 2e-4) << what << ": entry " << d.at;
}

TEST(CpuMultiView, GradientsAreThoseOfTheReference) {
  const GaussianModel model = wall();
  const std::vector<TrainingView> pair = views();
  CpuEngine engine(2);
  engine.keep_features(true);
  engine.load(model);
  engine.set_training_views(pair);
  const StepRequest r = request();
  RenderOptions options;
  options.raster = r.raster;
  const ImageF depth = engine.render(pair[1].data.camera, options).depth_plane;
  const StepReport report = engine.step(r);
  ASSERT_FALSE(report.non_finite.found);
  EXPECT_GT(report.losses.multi_view_geometric, 0);
  EXPECT_GT(report.losses.multi_view_photometric, 0);
  EXPECT_GT(report.seconds.count("neighbour"), 0u);

  // The map losses are taken from the engine's maps, so that a pixel on a threshold is no difference.
  const NeighbourView<float> neighbour{pair[1], depth.data.data(), r.neighbour.seed};
  const auto losses = [&](bool multi_view) {
    return reference::MapLossFunction<double>(
        [&, multi_view](const RenderMaps<double>&, LossTerms& terms, MapGradients<double>& out) {
          MapGradients<float> g;
          g.reset(engine.last_maps().pixels());
          map_losses(MapLossInputs<float>{engine.last_maps(), pair[0], r.losses, nullptr, nullptr,
                                          multi_view ? &neighbour : nullptr},
                     terms, g);
          out.color.assign(g.color.begin(), g.color.end());
          out.normal.assign(g.normal.begin(), g.normal.end());
          out.distance.assign(g.distance.begin(), g.distance.end());
        });
  };
  const GaussianModelT<double> exact = to_double(model);
  const auto want = reference::gradients<double>(exact, pair[0], r, 0.0, losses(true));
  const auto without = reference::gradients<double>(exact, pair[0], r, 0.0, losses(false));
  const GaussianModel got = engine.last_gradients();
  EXPECT_NEAR(report.losses.total, want.losses.total, 2e-5 * want.losses.total);
  EXPECT_EQ(report.losses.multi_view_geometric, want.losses.multi_view_geometric);
  EXPECT_EQ(report.losses.multi_view_photometric, want.losses.multi_view_photometric);
  expect_close(got.positions, want.gradient.positions, "d positions");
  expect_close(got.log_scales, want.gradient.log_scales, "d log_scales");
  expect_close(got.rotations, want.gradient.rotations, "d rotations");
  expect_close(got.opacity_logits, want.gradient.opacity_logits, "d opacity_logits");
  EXPECT_GT(difference(without.gradient.rotations, want.gradient.rotations).worst, 1e-2) << "the terms must matter here";
  EXPECT_GT(difference(without.gradient.opacity_logits, want.gradient.opacity_logits).worst, 1e-3);
}

TEST(CpuMultiView, TheReferenceTakesItsNeighbourToo) {
  const GaussianModelT<double> model = to_double(wall());
  const std::vector<TrainingView> pair = views();
  const StepRequest r = request();
  const std::vector<double> depth = reference::neighbour_depth(model, pair[1], r);
  const NeighbourView<double> neighbour{pair[1], depth.data(), r.neighbour.seed};
  const auto with = reference::gradients<double>(model, pair[0], r, 0.0, &neighbour);
  CpuEngine engine(1);
  engine.load(wall());
  engine.set_training_views(pair);
  const StepReport report = engine.step(r);
  EXPECT_NEAR(report.losses.multi_view_geometric, with.losses.multi_view_geometric, 0.02 * with.losses.multi_view_geometric);
  EXPECT_NEAR(report.losses.multi_view_photometric, with.losses.multi_view_photometric,
              0.02 * with.losses.multi_view_photometric);
}

TEST(CpuMultiView, WithoutWeightTheNeighbourChangesNothing) {
  StepRequest r = request();
  r.losses.multi_view_geometric_weight = r.losses.multi_view_photometric_weight = 0;
  const auto after = [&](int neighbour) {
    CpuEngine engine(1);
    engine.load(wall());
    engine.set_training_views(views());
    r.neighbour.view = neighbour;
    engine.step(r);
    GaussianModel m;
    engine.store(m);
    return m.positions;
  };
  EXPECT_EQ(after(1), after(-1));
}

TEST(CpuMultiView, TheSameBitsForAnyNumberOfThreads) {
  const auto after = [&](int threads) {
    CpuEngine engine(threads);
    engine.load(wall());
    engine.set_training_views(views());
    StepRequest r = request();
    for (r.step = 1; r.step <= 3; ++r.step) engine.step(r);
    GaussianModel m;
    engine.store(m);
    return m;
  };
  const GaussianModel one = after(1), three = after(3);
  EXPECT_EQ(one.positions, three.positions);
  EXPECT_EQ(one.rotations, three.rotations);
}

TEST(CpuMultiView, ANeighbourThatIsTheViewItselfOrDoesNotExistIsAnError) {
  CpuEngine engine(1);
  engine.load(wall());
  engine.set_training_views(views());
  for (const int wrong : {0, 2}) {
    StepRequest r = request();
    r.neighbour.view = wrong;
    try {
      engine.step(r);
      FAIL() << "expected an error";
    } catch (const Error& e) {
      EXPECT_EQ(e.details().field, "neighbour");
    }
  }
}

}  // namespace
}  // namespace aligngs::cpu
