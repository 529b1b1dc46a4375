// Finite differences in double: the pose of the camera.
#include <gtest/gtest.h>

#include "core/rotation_vector.h"
#include "engine/reference/reference_pose.h"
#include "engine/reference/testing/gradient_scene.h"

namespace aligngs::reference {
namespace {

using namespace testing_scene;

/// Looks at colour, normals and distances, so that every way from the pose to the maps counts.
MapLossFunction<double> pose_probe() {
  return [](const RenderMaps<double>& m, LossTerms& terms, MapGradients<double>& d) {
    const auto add = [&](const std::vector<double>& map, std::vector<double>& gradient, double frequency) {
      for (size_t k = 0; k < map.size(); ++k) {
        const double weight = std::sin(frequency * static_cast<double>(k) + 0.3);
        terms.total += weight * map[k];
        gradient[k] += weight;
      }
    };
    add(m.color, d.color, 0.37);
    add(m.normal, d.normal, 0.71);
    add(m.distance, d.distance, 0.53);
    add(m.alpha, d.alpha, 0.29);
  };
}

TEST(PoseGradient, MatchesDifferencesAtEveryDegree) {
  const Model model = make_model<double>();
  constexpr double kStep = 1e-5;
  for (const int degree : {0, 1, 2, 3}) {
    StepRequest request = make_request();
    request.sh_degree = degree;
    const auto loss_at = [&](const Vec3d& turn, const Vec3d& shift) {
      TrainingView view = make_view();
      view.data.camera.world_to_camera = Rigidd{rotation_of(turn), shift} * view.data.camera.world_to_camera;
      return gradients(model, view, request, 0.0, pose_probe()).losses.total;
    };
    const PoseGradient<double> got =
        pose_gradient(model, gradients(model, make_view(), request, 0.0, pose_probe()).gradient, make_camera(), degree);
    double largest = 0;
    Vec3d rotation, translation;
    for (int k = 0; k < 3; ++k) {
      Vec3d step;
      step[k] = kStep;
      rotation[k] = (loss_at(step, {}) - loss_at(-step, {})) / (2 * kStep);
      translation[k] = (loss_at({}, step) - loss_at({}, -step)) / (2 * kStep);
      largest = std::max({largest, std::abs(rotation[k]), std::abs(translation[k])});
    }
    EXPECT_GT(largest, 1);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(got.rotation[k], rotation[k], 2e-6 * largest) << "degree " << degree << ", rotation " << k;
      EXPECT_NEAR(got.translation[k], translation[k], 2e-6 * largest) << "degree " << degree << ", translation " << k;
    }
  }
}

TEST(PoseGradient, AGaussianAtTheCentreOfTheCameraHasNoDirection) {
  const double sh[3 * kShCoefficients] = {1}, dsh[3 * kShCoefficients] = {1};
  const Vec3d part = direction_part<double>(3, {1, 2, 3}, {1, 2, 3}, sh, dsh);
  EXPECT_EQ(norm(part), 0);
}

}  // namespace
}  // namespace aligngs::reference
