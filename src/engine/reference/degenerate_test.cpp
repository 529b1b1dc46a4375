// Inputs at the edge of what a Gaussian can be: the results are defined and finite, and a bad row harms no other.
#include <gtest/gtest.h>

#include <limits>

#include "engine/reference/testing/gradient_scene.h"

namespace aligngs::reference {
namespace {

using namespace testing_scene;

template <class T>
StepRequest full_request() {
  StepRequest r = make_request();
  r.raster.smooth_cutoff = false;
  r.losses.weight[Loss::kFlatten] = 100;
  r.losses.weight[Loss::kOpacityL1] = 0.01f;
  r.losses.weight[Loss::kScaleL1] = 0.01f;
  r.losses.weight[Loss::kSemanticSoft] = 1;
  r.losses.weight[Loss::kSemanticHard] = 0.1f;
  return r;
}

template <class T>
MapLossFunction<T> all_maps() {
  return [](const RenderMaps<T>& m, LossTerms& terms, MapGradients<T>& g) {
    for (size_t k = 0; k < m.color.size(); ++k) {
      terms.total += double(m.color[k]);
      g.color[k] = T(1);
      g.normal[k] = T(0.5);
    }
    for (size_t u = 0; u < m.pixels(); ++u) g.distance[u] = g.alpha[u] = T(0.1);
  };
}

template <class T>
bool all_finite(const std::vector<T>& values) {
  for (T v : values) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

template <class T>
void expect_finite(const Gradients<T>& g) {
  EXPECT_TRUE(std::isfinite(g.losses.total));
  EXPECT_TRUE(all_finite(g.gradient.positions));
  EXPECT_TRUE(all_finite(g.gradient.log_scales));
  EXPECT_TRUE(all_finite(g.gradient.rotations));
  EXPECT_TRUE(all_finite(g.gradient.opacity_logits));
  EXPECT_TRUE(all_finite(g.gradient.sh));
  EXPECT_TRUE(all_finite(g.gradient.semantics));
  EXPECT_TRUE(all_finite(g.statistics.gradient_abs));
}

template <class T>
Gradients<T> run(const GaussianModelT<T>& model) {
  return gradients<T>(model, make_view(), full_request<T>(), 1.0, all_maps<T>());
}

template <class T>
class Degenerate : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Degenerate, Scalars);

TYPED_TEST(Degenerate, EmptyModelRendersTheBackground) {
  GaussianModelT<TypeParam> model;
  model.semantic_channels = kChannels;
  const Gradients<TypeParam> g = run(model);
  EXPECT_EQ(g.visible, 0u);
  expect_finite(g);
  const Rendering r = render(model, make_camera(), RenderOptions());
  EXPECT_EQ(r.alpha.data, std::vector<float>(size_t(kWidth) * kHeight, 0.0f));
}

TYPED_TEST(Degenerate, NothingVisibleHasNoGradient) {
  GaussianModelT<TypeParam> model = make_model<TypeParam>();
  for (size_t i = 0; i < model.size(); ++i) model.positions[3 * i + 2] -= 100;
  StepRequest request = full_request<TypeParam>();
  request.losses.weight[Loss::kOpacityL1] = request.losses.weight[Loss::kScaleL1] = 0;
  const Gradients<TypeParam> g = gradients<TypeParam>(model, make_view(), request, 1.0, all_maps<TypeParam>());
  EXPECT_EQ(g.visible, 0u);
  expect_finite(g);
  EXPECT_EQ(g.gradient.positions, std::vector<TypeParam>(model.positions.size(), TypeParam(0)));
  EXPECT_EQ(g.gradient.semantics, std::vector<TypeParam>(model.semantics.size(), TypeParam(0)));
}

TYPED_TEST(Degenerate, ZeroQuaternionIsTheIdentityWithoutGradient) {
  GaussianModelT<TypeParam> model = make_model<TypeParam>();
  for (int k = 0; k < 4; ++k) model.rotations[4 * 2 + k] = 0;
  const Gradients<TypeParam> g = run(model);
  expect_finite(g);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(g.gradient.rotations[4 * 2 + k], TypeParam(0));
  GaussianModelT<TypeParam> identity = model;
  identity.rotations[4 * 2] = 1;
  EXPECT_EQ(run(identity).gradient.positions, g.gradient.positions);
}

/// Beyond some size nothing changes: a dot is as wide as the low-pass, and a huge one covers the image evenly.
TYPED_TEST(Degenerate, HugeAndTinyScales) {
  const auto mean_color = [](double log_scale) {
    GaussianModelT<TypeParam> model = make_model<TypeParam>();
    for (int k = 0; k < 3; ++k) model.log_scales[3 * 1 + k] = TypeParam(log_scale);
    const Rendering r = render(model, make_camera(), RenderOptions());
    double sum = 0;
    for (const float v : r.color.data) sum += double(v);
    return sum / double(r.color.data.size());
  };
  const double dot = mean_color(-20), huge = mean_color(20);
  EXPECT_NEAR(mean_color(-80), dot, 1e-6);
  EXPECT_NEAR(mean_color(12), huge, 1e-5);
  EXPECT_GT(std::abs(huge - dot), 1e-3);
  for (double log_scale : {-80.0, -20.0, 5.0, 20.0, 60.0, 500.0}) {
    GaussianModelT<TypeParam> model = make_model<TypeParam>();
    for (int k = 0; k < 3; ++k) model.log_scales[3 * 1 + k] = TypeParam(log_scale);
    // Regularisers of an infinite scale would be infinite, and rightly so: they are looked at elsewhere.
    StepRequest request = full_request<TypeParam>();
    request.losses.weight[Loss::kScaleL1] = 0;
    const Gradients<TypeParam> g = gradients<TypeParam>(model, make_view(), request, 1.0, all_maps<TypeParam>());
    SCOPED_TRACE(log_scale);
    expect_finite(g);
    const bool unusable = log_scale == 500.0 || (log_scale == 60.0 && sizeof(TypeParam) == 4);
    EXPECT_EQ(g.non_finite, unusable ? std::vector<uint32_t>{1} : std::vector<uint32_t>{});
  }
}

TYPED_TEST(Degenerate, NeedleKeepsAFiniteConic) {
  GaussianModelT<TypeParam> model = make_model<TypeParam>();
  model.log_scales[3] = 6;  // 400 units long, a tenth of a millimetre thin
  model.log_scales[4] = model.log_scales[5] = TypeParam(-9);
  const Gradients<TypeParam> g = run(model);
  EXPECT_TRUE(g.non_finite.empty());
  expect_finite(g);
  // Across the needle there is nothing but the low-pass, and along it hardly any curvature.
  const RasterSettings raster;
  const Symmetric2<TypeParam> conic = make_splats(model, make_camera(), raster, 3).projections[1].conic;
  const double trace = double(conic.xx + conic.yy);
  EXPECT_NEAR(trace, 1 / double(raster.low_pass), 1e-3);
  EXPECT_NEAR(double(conic.xx) * double(conic.yy), double(conic.xy) * double(conic.xy), 1e-5 * trace * trace);
}

TYPED_TEST(Degenerate, OpacityZeroIsCulledAndOneIsOpaque) {
  GaussianModelT<TypeParam> model = make_model<TypeParam>();
  model.opacity_logits[4] = TypeParam(-500);
  Gradients<TypeParam> g = run(model);
  expect_finite(g);
  EXPECT_EQ(g.statistics.visible[4], 0.0f);
  model.opacity_logits[4] = TypeParam(500);
  g = run(model);
  expect_finite(g);
  EXPECT_EQ(g.statistics.visible[4], 1.0f);
  // sigmoid is flat there.
  EXPECT_NEAR(g.gradient.opacity_logits[4], 0.0, 1e-12);
}

TYPED_TEST(Degenerate, ManyOpaqueLayersStopBeforeTransmittanceVanishes) {
  GaussianModelT<TypeParam> model = make_model<TypeParam>();
  for (size_t i = 0; i < model.size(); ++i) {
    model.opacity_logits[i] = TypeParam(40);
    for (int k = 0; k < 3; ++k) model.log_scales[3 * i + k] = TypeParam(1);
  }
  const Gradients<TypeParam> g = run(model);
  expect_finite(g);
  EXPECT_LT(g.visible, model.size()) << "0.01^2 is the last transmittance above 1e-4: two layers fill a pixel";
}

TYPED_TEST(Degenerate, BehindAndOnTheNearPlane) {
  const GaussianModelT<TypeParam> base = make_model<TypeParam>();
  const Rigidd to_world = make_camera().world_to_camera.inverse();
  const RasterSettings raster;
  for (double z : {-2.0, 0.0, double(raster.near_plane) * 0.999, double(raster.near_plane) * 1.001}) {
    GaussianModelT<TypeParam> model = base;
    const Vec3d p = to_world * Vec3d{0, 0, z};
    for (int k = 0; k < 3; ++k) model.positions[k] = TypeParam(p[k]);
    const Gradients<TypeParam> g = run(model);
    SCOPED_TRACE(z);
    expect_finite(g);
    EXPECT_EQ(g.statistics.visible[0], z > double(raster.near_plane) ? 1.0f : 0.0f);
  }
}

TYPED_TEST(Degenerate, CameraInsideThePlane) {
  // The plane of an identity-rotated Gaussian passes through the camera: d = 0 and no ray meets it in front.
  GaussianModelT<TypeParam> model = make_model<TypeParam>();
  const Camera camera = make_camera();
  const Vec3d p = camera.world_to_camera.inverse() * Vec3d{0, 0, 2};
  const Quaterniond q = quaternion_of(transpose(camera.world_to_camera.rotation));
  for (int k = 0; k < 3; ++k) model.positions[k] = TypeParam(p[k]);
  model.rotations[0] = TypeParam(q.w), model.rotations[1] = TypeParam(q.x);
  model.rotations[2] = TypeParam(q.y), model.rotations[3] = TypeParam(q.z);
  model.log_scales[0] = TypeParam(-4), model.log_scales[1] = model.log_scales[2] = TypeParam(-1);
  const Splats<TypeParam> s = make_splats(model, camera, RasterSettings(), 3);
  ASSERT_TRUE(s.projections[0].visible());
  EXPECT_NEAR(s.projections[0].distance, 0.0, 1e-6);
  EXPECT_EQ(intersection_depth(s.projections[0], s.camera.ray(8, 5)), s.projections[0].z);
  expect_finite(run(model));
}

TYPED_TEST(Degenerate, TiesHaveADefinedOrderAndNormal) {
  GaussianModelT<TypeParam> model = make_model<TypeParam>();
  for (int k = 0; k < 3; ++k) {
    model.positions[3 + k] = model.positions[k];
    model.log_scales[k] = TypeParam(-1.5);
  }
  const Splats<TypeParam> s = make_splats(model, make_camera(), RasterSettings(), 3);
  EXPECT_EQ(s.projections[0].normal_axis, 0);  // equal scales: the lowest axis
  EXPECT_EQ(s.order[0], 0u);                   // equal depths: the lower row
  EXPECT_EQ(s.order[1], 1u);
  expect_finite(run(model));
}

/// A NaN or infinity anywhere in a row culls that row, names it, and leaves the others exactly as without it.
TYPED_TEST(Degenerate, NonFiniteRowIsReportedAndSpreadsNowhere) {
  using T = TypeParam;
  const GaussianModelT<T> base = make_model<T>();
  GaussianModelT<T> without = base;
  without.opacity_logits[3] = T(-500);
  StepRequest request = full_request<T>();
  request.losses.weight[Loss::kOpacityL1] = request.losses.weight[Loss::kScaleL1] = 0;
  const auto run_it = [&](const GaussianModelT<T>& m) {
    return gradients<T>(m, make_view(), request, 1.0, all_maps<T>());
  };
  const Gradients<T> expected = run_it(without);
  for (T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity()}) {
    for (int parameter = 0; parameter < 6; ++parameter) {
      SCOPED_TRACE(parameter);
      GaussianModelT<T> model = base;
      if (parameter == 0) model.positions[3 * 3 + 1] = bad;
      if (parameter == 1) model.log_scales[3 * 3 + 2] = bad;
      if (parameter == 2) model.rotations[4 * 3] = bad;
      if (parameter == 3) model.opacity_logits[3] = bad;
      if (parameter == 4) model.sh[3 * kShCoefficients * 3 + 7] = bad;
      if (parameter == 5) model.semantics[kChannels * 3 + 4] = bad;
      const Gradients<T> g = run_it(model);
      EXPECT_EQ(g.non_finite, std::vector<uint32_t>{3});
      EXPECT_EQ(g.gradient.positions, expected.gradient.positions);
      EXPECT_EQ(g.gradient.sh, expected.gradient.sh);
      EXPECT_EQ(g.gradient.semantics, expected.gradient.semantics);
      EXPECT_EQ(g.losses.total, expected.losses.total);
    }
  }
}

}  // namespace
}  // namespace aligngs::reference
