#include "train/pose_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/rotation_vector.h"
#include "engine/engine.h"
#include "engine/testing/scenes.h"

namespace aligngs {
namespace {

TEST(PoseRefinement, ACameraThatNeverMovedStaysToTheBit) {
  const Rigidd base{rotation_of({0.3, -0.2, 0.9}), {1, 2, 3}};
  const Rigidd same = moved(base, {});
  EXPECT_EQ(same.translation.y, 2);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(same.rotation.m[i], base.rotation.m[i]);
}

TEST(PoseRefinement, TheFirstUpdateIsOfTheRatesSizeAgainstTheGradient) {
  CameraMotion motion;
  update_motion({{5, 0, -2}, {0.01, 0, 0}}, {1e-3, 1e-2, 0}, motion);
  EXPECT_NEAR(motion.offset[0], -1e-3, 1e-9);
  EXPECT_EQ(motion.offset[1], 0);
  EXPECT_NEAR(motion.offset[2], 1e-3, 1e-9);
  EXPECT_NEAR(motion.offset[3], -1e-2, 1e-8);
}

TEST(PoseRefinement, WithoutGradientTheCameraGoesHome) {
  CameraMotion motion;
  motion.offset[4] = 0.1;
  for (int i = 0; i < 100; ++i) update_motion({}, {1e-3, 1e-3, 0.05}, motion);
  EXPECT_LT(std::abs(motion.offset[4]), 0.001);
}

TEST(PoseRefinement, AGradientThatIsNoNumberChangesNothing) {
  CameraMotion motion;
  update_motion({{std::numeric_limits<double>::quiet_NaN(), 0, 0}, {}}, {1e-3, 1e-3, 0.1}, motion);
  EXPECT_EQ(motion.updates, 0);
  EXPECT_EQ(motion.m[0], 0);
}

/// The whole way: a photo taken by the engine itself, a camera that is wrong, and a scene that does not change.
TEST(PoseRefinement, FindsTheCameraThatTookThePhoto) {
  using namespace cpu::testing_scene;
  cpu::testing_scene::RandomSceneOptions o;
  o.width = 96;
  o.height = 72;
  o.gaussians = 300;
  const std::unique_ptr<Engine> engine = make_cpu_engine(2);
  engine->load(make_model(o));
  StepRequest request = make_request();
  request.losses = {};
  request.losses.weight[Loss::kFlatten] = request.losses.weight[Loss::kSemanticSoft] =
      request.losses.weight[Loss::kSemanticHard] = 0;
  request.losses.weight[Loss::kL1] = 1;
  request.losses.weight[Loss::kSsim] = 0;
  request.rates = {};
  request.limits = {};
  request.collect_density = false;
  request.pose_gradient = true;
  TrainingView view = make_view(o);
  view.data.semantics = {};
  RenderOptions look;
  look.raster = request.raster;
  const Camera truth = view.data.camera;
  view.data.color = engine->render(truth, look).color;
  engine->set_training_views({view});
  const Rigidd wrong = Rigidd{rotation_of({0.01, -0.012, 0.008}), {0.02, -0.015, 0.02}} * truth.world_to_camera;
  CameraMotion motion;
  const auto error = [&] { return norm((moved(wrong, motion) * truth.world_to_camera.inverse()).translation); };
  const double before = error();
  for (int i = 0; i < 300; ++i) {
    engine->set_pose(0, moved(wrong, motion));
    request.step = i + 1;
    const StepReport report = engine->step(request);
    ASSERT_FALSE(report.non_finite.found);
    const double rate = 1e-3 * std::pow(0.01, i / 300.0);
    update_motion(report.pose, {rate, rate, 0}, motion);
  }
  EXPECT_LT(error(), 0.1 * before);
  EXPECT_LT(rotation_angle_between_degrees(moved(wrong, motion).rotation, truth.world_to_camera.rotation), 0.1);
}

}  // namespace
}  // namespace aligngs
