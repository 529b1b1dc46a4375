#include "engine/cpu/pose_gradient.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/cpu/cpu_engine.h"
#include "engine/reference/reference_pose.h"
#include "engine/testing/scenes.h"

namespace aligngs::cpu {
namespace {

using namespace testing_scene;

StepReport step(const RandomSceneOptions& o, const StepRequest& request, int threads,
                GaussianModel* gradients = nullptr) {
  CpuEngine engine(threads);
  engine.keep_features(true);
  engine.load(make_model(o));
  engine.set_training_views({make_view(o)});
  const StepReport report = engine.step(request);
  if (gradients != nullptr) *gradients = engine.last_gradients();
  return report;
}

TEST(CpuPoseGradient, IsTheFormulaSummedOverTheRows) {
  const RandomSceneOptions o;
  StepRequest request = make_geometry_request();
  request.pose_gradient = true;
  GaussianModel gradients;
  const PoseGradient<double> got = step(o, request, 2, &gradients).pose;
  const PoseGradient<double> want = reference::pose_gradient(to_double(make_model(o)), to_double(gradients),
                                                             make_view(o).data.camera, request.sh_degree);
  EXPECT_GT(norm(want.rotation), 0);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(got.rotation[k], want.rotation[k], 1e-4 * norm(want.rotation));
    EXPECT_NEAR(got.translation[k], want.translation[k], 1e-4 * norm(want.translation));
  }
}

TEST(CpuPoseGradient, DoesNotDependOnThreadsAndIsZeroUnlessAskedFor) {
  RandomSceneOptions o;
  o.gaussians = 2000;
  StepRequest request = make_geometry_request();
  EXPECT_EQ(norm(step(o, request, 1).pose.translation), 0);
  request.pose_gradient = true;
  const PoseGradient<double> one = step(o, request, 1).pose, three = step(o, request, 3).pose;
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(one.rotation[k], three.rotation[k]);
    EXPECT_EQ(one.translation[k], three.translation[k]);
  }
}

TEST(CpuPoseGradient, NothingInViewMovesNoCamera) {
  const RandomSceneOptions o;
  CpuEngine engine(1);
  engine.load(make_model(o));
  engine.set_training_views({make_view(o)});
  engine.set_pose(0, Rigidd{{{-1, 0, 0, 0, 1, 0, 0, 0, -1}}, {}});  // looks the other way
  StepRequest request = make_geometry_request();
  request.pose_gradient = true;
  const StepReport report = engine.step(request);
  EXPECT_EQ(report.visible, 0u);
  EXPECT_EQ(norm(report.pose.rotation), 0);
}

}  // namespace
}  // namespace aligngs::cpu
