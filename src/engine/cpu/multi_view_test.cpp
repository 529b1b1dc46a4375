// Steps with a neighbour: the engine against the scalar reference.
#include <gtest/gtest.h>

#include "core/error.h"
#include "engine/testing/two_view_scene.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

template <class A, class B>
void expect_close(const A& a, const B& b, const char* what) {
  const Difference d = difference(a, b);
  EXPECT_LE(d.worst, 2e-4) << what << ": entry " << d.at;
}

TEST(CpuMultiView, GradientsAreThoseOfTheReference) {
  const GaussianModel model = make_wall();
  const std::vector<TrainingView> pair = make_view_pair();
  CpuEngine engine(2);
  engine.keep_features(true);
  engine.load(model);
  engine.set_training_views(pair);
  const StepRequest r = make_pair_request();
  RenderOptions options;
  options.raster = r.raster;
  const ImageF depth = engine.render(pair[1].data.camera, options).depth_plane;
  const StepReport report = engine.step(r);
  ASSERT_FALSE(report.non_finite.found);
  EXPECT_GT(report.losses[Loss::kMultiViewGeometric], 0);
  EXPECT_GT(report.losses[Loss::kMultiViewPhotometric], 0);
  EXPECT_GT(report.seconds.count("neighbour"), 0u);

  const auto want = pair_gradients(engine.last_maps(), depth, r, true);
  const auto without = pair_gradients(engine.last_maps(), depth, r, false);
  const GaussianModel got = engine.last_gradients();
  EXPECT_NEAR(report.losses.total, want.losses.total, 2e-5 * want.losses.total);
  // A picture and a step form the plane's depth in two ways, in float. Whether they round alike depends on the build.
  constexpr double kRounding = 1e-4;
  for (const Loss loss : {Loss::kMultiViewGeometric, Loss::kMultiViewPhotometric})
    EXPECT_NEAR(report.losses[loss], want.losses[loss], kRounding * want.losses[loss]);
  expect_close(got.positions, want.gradient.positions, "d positions");
  expect_close(got.log_scales, want.gradient.log_scales, "d log_scales");
  expect_close(got.rotations, want.gradient.rotations, "d rotations");
  expect_close(got.opacity_logits, want.gradient.opacity_logits, "d opacity_logits");
  EXPECT_GT(difference(without.gradient.rotations, want.gradient.rotations).worst, 1e-2)
      << "the terms must matter here";
  EXPECT_GT(difference(without.gradient.opacity_logits, want.gradient.opacity_logits).worst, 1e-3);
}

TEST(CpuMultiView, TheReferenceTakesItsNeighbourToo) {
  const GaussianModelT<double> model = to_double(make_wall());
  const std::vector<TrainingView> pair = make_view_pair();
  const StepRequest r = make_pair_request();
  const std::vector<double> depth = reference::neighbour_depth(model, pair[1], r);
  const NeighbourView<double> neighbour{pair[1], depth.data(), r.neighbour.seed};
  const auto with = reference::gradients<double>(model, pair[0], r, 0.0, &neighbour);
  CpuEngine engine(1);
  engine.load(make_wall());
  engine.set_training_views(pair);
  const StepReport report = engine.step(r);
  EXPECT_NEAR(report.losses[Loss::kMultiViewGeometric], with.losses[Loss::kMultiViewGeometric],
              0.02 * with.losses[Loss::kMultiViewGeometric]);
  EXPECT_NEAR(report.losses[Loss::kMultiViewPhotometric], with.losses[Loss::kMultiViewPhotometric],
              0.02 * with.losses[Loss::kMultiViewPhotometric]);
}

TEST(CpuMultiView, WithoutWeightTheNeighbourChangesNothing) {
  StepRequest r = make_pair_request();
  r.losses.weight[Loss::kMultiViewGeometric] = r.losses.weight[Loss::kMultiViewPhotometric] = 0;
  const auto after = [&](int neighbour) {
    CpuEngine engine(1);
    engine.load(make_wall());
    engine.set_training_views(make_view_pair());
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
    engine.load(make_wall());
    engine.set_training_views(make_view_pair());
    StepRequest r = make_pair_request();
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
  engine.load(make_wall());
  engine.set_training_views(make_view_pair());
  for (const int wrong : {0, 2}) {
    StepRequest r = make_pair_request();
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
