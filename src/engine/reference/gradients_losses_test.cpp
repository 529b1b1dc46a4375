// Finite differences in double: every loss of the maps, from the parameters through rendering and back.
#include <gtest/gtest.h>

#include "engine/reference/testing/gradient_scene.h"

namespace aligngs::reference {
namespace {

using namespace testing_scene;

constexpr auto kOneView = losses_of(LossStage::kColor, LossStage::kGeometry);

/// Flat Gaussians that face the camera and fill the image: two overlapping sheets that meet in a fold. Plane depth is
/// valid everywhere and no guard is active.
Model sheets(const Camera& camera) {
  const Rigidd to_world = camera.world_to_camera.inverse();
  Model m;
  m.sh_degree = 3;
  m.resize(8);
  for (size_t i = 0; i < 8; ++i) {
    const bool right = i % 2 == 1;
    const double down = (static_cast<double>(i / 2) - 1.5) * 0.55;
    const Vec3d p = to_world * Vec3d{right ? 0.7 : -0.7, down, 2.4 + 0.04 * static_cast<double>(i)};
    const Vec3d n = normalized(Vec3d{right ? -0.35 : 0.3, 0.05 * std::sin(2.0 * i), -1.0});
    const Quaterniond q = quaternion_from_z_to(to_world.rotation * n);
    for (int k = 0; k < 3; ++k) m.positions[3 * i + k] = p[k];
    m.log_scales[3 * i] = -0.6 + 0.03 * i;
    m.log_scales[3 * i + 1] = -0.5 - 0.02 * i;
    m.log_scales[3 * i + 2] = -4;
    m.rotations[4 * i] = 1.2 * q.w, m.rotations[4 * i + 1] = 1.2 * q.x;
    m.rotations[4 * i + 2] = 1.2 * q.y, m.rotations[4 * i + 3] = 1.2 * q.z;
    m.opacity_logits[i] = 1.5 + 0.1 * i;
    for (int k = 0; k < 3 * kShCoefficients; ++k) {
      m.sh[3 * kShCoefficients * i + k] = (k < 3 ? 0.6 : 0.1) * std::sin(1.7 * k + 2.9 * i + 0.4);
    }
  }
  return m;
}

TrainingView make_loss_view() {
  TrainingView v = make_view();
  v.data.labels = Image<uint16_t>(kWidth, kHeight, 1);
  v.depth_weight = ImageF(kWidth, kHeight, 1);
  v.prior_normal = ImageF(kWidth, kHeight, 3);
  v.label_edge = Image<uint8_t>(kWidth, kHeight, 1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool right = x >= 9;
      const Vec3d n = normalized(Vec3d{right ? -0.5 : 0.45, 0.1, -1.0});
      for (int k = 0; k < 3; ++k) v.prior_normal.at(x, y, k) = static_cast<float>(n[k]);
      v.data.prior_depth.at(x, y) = 2.7f - 0.08f * std::abs(x - 8.5f) - 0.015f * y;  // the fold, seen from inside
      v.depth_weight.at(x, y) = 0.6f + 0.02f * y;
      v.data.labels.at(x, y) = right ? 3 : 1;
      v.label_edge.at(x, y) = x == 9 ? 1 : 0;
    }
  }
  return v;
}

class ThroughLoss : public testing::TestWithParam<std::tuple<Loss, bool>> {};

TEST_P(ThroughLoss, EveryParameterMatchesDifferences) {
  const Loss loss = std::get<0>(GetParam());
  const TrainingView view = make_loss_view();
  const Model model = sheets(view.data.camera);
  StepRequest request = make_request();
  request.losses.weight[Loss::kL1] = request.losses.weight[Loss::kSsim] = 0;
  request.losses.weight[loss] = 0.7f;
  request.losses.paper_normals = std::get<1>(GetParam());
  const Gradients<double> g = gradients(model, view, request, 0.0);
  EXPECT_GT(g.losses[loss], 0.0);
  for (const ParameterClass& c : parameter_classes()) {
    if (c.values == &Model::semantics) continue;
    const Comparison found = compare(
        c, model, g.gradient, [&](const Model& m) { return gradients(m, view, request, 0.0).losses.total; }, 1e-6);
    if (c.values != &Model::sh) {
      EXPECT_GT(found.largest, 1e-6) << c.name;
    } else if (row_of(loss).stage == LossStage::kGeometry) {
      EXPECT_EQ(found.largest, 0.0) << c.name;
    }
    EXPECT_LT(found.worst, 1e-5) << found.where;
  }
}

/// Some rows are left out and the others more opaque: the gradient is that of what is drawn.
TEST(ThroughDropout, EveryParameterMatchesDifferences) {
  const TrainingView view = make_loss_view();
  const Model model = sheets(view.data.camera);
  StepRequest request = make_request();
  request.raster.dropout = {0.3f, 5};
  ASSERT_TRUE(request.raster.dropout.drops(0) || request.raster.dropout.drops(1) || request.raster.dropout.drops(2));
  const Gradients<double> g = gradients(model, view, request, 0.0);
  for (const ParameterClass& c : parameter_classes()) {
    if (c.values == &Model::semantics) continue;
    const Comparison found = compare(
        c, model, g.gradient, [&](const Model& m) { return gradients(m, view, request, 0.0).losses.total; }, 1e-6);
    EXPECT_GT(found.largest, 0.0) << c.name;
    EXPECT_LT(found.worst, 1e-5) << found.where;
  }
}

INSTANTIATE_TEST_SUITE_P(Gradients, ThroughLoss,
                         testing::Combine(testing::ValuesIn(kOneView.begin(), kOneView.end()), testing::Bool()),
                         [](const auto& each) {
                           return std::string(row_of(std::get<0>(each.param)).name) +
                                  (std::get<1>(each.param) ? "_paper" : "_default");
                         });

}  // namespace
}  // namespace aligngs::reference
