// The meaning of the maps, on scenes with known values.
#include <gtest/gtest.h>

#include "engine/reference/testing/gradient_scene.h"

namespace aligngs::reference {
namespace {

using namespace testing_scene;

/// One large flat Gaussian in the plane through camera-frame point p with camera-frame normal n.
Model wall(const Camera& camera, const Vec3d& p, const Vec3d& n, double logit) {
  const Rigidd to_world = camera.world_to_camera.inverse();
  const Vec3d position = to_world * p;
  const Quaterniond q = quaternion_from_z_to(to_world.rotation * n);
  Model m;
  m.semantic_channels = kChannels;
  m.resize(1);
  m.positions = {position.x, position.y, position.z};
  m.log_scales = {std::log(20.0), std::log(20.0), std::log(1e-3)};
  m.rotations = {q.w, q.x, q.y, q.z};
  m.opacity_logits = {logit};
  m.sh[0] = 0.4 / kSh0, m.sh[1] = 0, m.sh[2] = -0.3 / kSh0;
  m.semantics = {0, 0, 3, 0, 0};
  return m;
}

const Vec3d kNormal = normalized(Vec3d{0.3, -0.2, -1.0});

TEST(ReferenceForward, PlaneDepthIsTheDepthOfThePlane) {
  const Camera camera = make_camera();
  const Vec3d p{0.2, 0.1, 2.5};
  RenderOptions options;
  const Rendering r = render(wall(camera, p, kNormal, 4.0), camera, options);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double z = dot(kNormal, p) / dot(kNormal, camera.ray(x + 0.5, y + 0.5));
      EXPECT_NEAR(r.depth_plane.at(x, y), z, 1e-5);
      EXPECT_NEAR(r.depth_median.at(x, y), z, 1e-5);
      EXPECT_NEAR(r.depth_expected.at(x, y), z, 1e-5);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(r.normal.at(x, y, k), kNormal[k], 1e-6);
    }
  }
}

TEST(ReferenceForward, ColorIsBlendedOverTheBackground) {
  const Camera camera = make_camera();
  RenderOptions options;
  options.raster.background[2] = 1;
  const Rendering r = render(wall(camera, {0, 0, 2}, {0, 0, -1}, 0.0), camera, options);  // opacity 1/2
  EXPECT_NEAR(r.alpha.at(8, 5), 0.5, 1e-3);
  EXPECT_NEAR(r.color.at(8, 5, 0), 0.5 * 0.9, 1e-3);
  EXPECT_NEAR(r.color.at(8, 5, 1), 0.5 * 0.5, 1e-3);
  EXPECT_NEAR(r.color.at(8, 5, 2), 0.5 * 0.2 + 0.5, 1e-3);
}

TEST(ReferenceForward, LabelsAreClassesOnlyWhereSomethingIsRendered) {
  const Camera camera = make_camera();
  RenderOptions options;
  options.labels = true;
  for (SemanticBlend blend : {SemanticBlend::kLogits, SemanticBlend::kProbabilities}) {
    options.semantic_blend = blend;
    const Rendering solid = render(wall(camera, {0, 0, 2}, {0, 0, -1}, 4.0), camera, options);
    EXPECT_EQ(solid.label.at(8, 5), 2);
    EXPECT_GT(solid.label_probability.at(8, 5), 0.7f);
    const Rendering thin = render(wall(camera, {0, 0, 2}, {0, 0, -1}, -1.0), camera, options);
    EXPECT_EQ(thin.label.at(8, 5), kNoLabel);
  }
}

TEST(ReferenceForward, MedianIsTheLayerThatHalvesTheLight) {
  const Camera camera = make_camera();
  const double logit = std::log(0.4 / 0.6);
  Model m = wall(camera, {0, 0, 2}, {0, 0, -1}, logit);
  const Model behind = wall(camera, {0, 0, 3}, {0, 0, -1}, logit);
  m.resize(2);
  for (int k = 0; k < 3; ++k) m.positions[3 + k] = behind.positions[k], m.log_scales[3 + k] = behind.log_scales[k];
  for (int k = 0; k < 4; ++k) m.rotations[4 + k] = behind.rotations[k];
  m.opacity_logits[1] = logit;
  const Rendering r = render(m, camera, RenderOptions());
  EXPECT_NEAR(r.depth_median.at(8, 5), 3.0, 1e-3);  // 0.6 after the first, 0.36 after the second
  EXPECT_NEAR(r.depth_expected.at(8, 5), (0.4 * 2 + 0.24 * 3) / 0.64, 1e-3);
}

/// The depths of the same scene in another unit are the same depths in that unit.
TEST(ReferenceForward, ScalesWithTheScene) {
  Model m = make_model<double>();
  Camera camera = make_camera();
  RenderOptions options;
  const Rendering r = render(m, camera, options);
  for (double& v : m.positions) v *= 0.37;
  for (double& v : m.log_scales) v += std::log(0.37);
  camera.world_to_camera.translation *= 0.37;
  options.raster.near_plane *= 0.37f;
  const Rendering small = render(m, camera, options);
  for (size_t u = 0; u < r.alpha.pixels(); ++u) {
    EXPECT_NEAR(small.alpha.data[u], r.alpha.data[u], 1e-6);
    EXPECT_NEAR(small.color.data[3 * u], r.color.data[3 * u], 1e-6);
    EXPECT_NEAR(small.depth_plane.data[u], 0.37f * r.depth_plane.data[u], 1e-5);
    EXPECT_NEAR(small.depth_median.data[u], 0.37f * r.depth_median.data[u], 1e-5);
  }
}

TEST(ReferenceForward, FloatFollowsDouble) {
  const Rendering a = render(make_model<double>(), make_camera(), RenderOptions());
  const Rendering b = render(make_model<float>(), make_camera(), RenderOptions());
  for (size_t k = 0; k < a.color.data.size(); ++k) {
    EXPECT_NEAR(a.color.data[k], b.color.data[k], 2e-6);
    EXPECT_NEAR(a.normal.data[k], b.normal.data[k], 5e-6);
  }
}

}  // namespace
}  // namespace aligngs::reference
