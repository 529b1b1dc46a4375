// Finite differences in double: every parameter class through every rendered map.
#include <gtest/gtest.h>

#include "engine/reference/testing/gradient_scene.h"

namespace aligngs::reference {
namespace {

using namespace testing_scene;

/// L = sum over values of a M + b M^2 / 2 with irregular a, b: linear alone would miss a wrong dependence on M.
double weight_of(size_t i) { return std::sin(0.37 * static_cast<double>(i) + 0.2); }
void probe(const std::vector<double>& map, LossTerms& terms, std::vector<double>& gradient) {
  for (size_t i = 0; i < map.size(); ++i) {
    terms.total += weight_of(i) * map[i] + 0.5 * weight_of(3 * i + 1) * map[i] * map[i];
    gradient[i] += weight_of(i) + weight_of(3 * i + 1) * map[i];
  }
}

/// The pixels whose plane depth the probe uses, fixed before the differences. They are covered and not near the slope
/// guard, whose clamp has a gradient that differences do not see.
std::vector<uint8_t> steady_plane_pixels(const RenderMaps<double>& m, const ProjectionCamera<double>& camera) {
  std::vector<uint8_t> use(m.pixels(), 0);
  const size_t n = m.pixels();
  for (size_t u = 0; u < n; ++u) {
    const Vec3d ray = camera.ray(static_cast<int>(u) % m.width, static_cast<int>(u) / m.width);
    const double s = -dot(Vec3d{m.normal[u], m.normal[n + u], m.normal[2 * n + u]}, ray);
    use[u] = m.alpha[u] > 0.5 && s > 0.2 * m.alpha[u] * norm(ray);
  }
  return use;
}

MapLossFunction<double> plane_depth_probe(const Model& model, const TrainingView& view, const StepRequest& request) {
  const Splats<double> s = make_splats(model, view.data.camera, request.raster, request.sh_degree);
  const std::vector<uint8_t> use = steady_plane_pixels(render_maps(s, request.raster), s.camera);
  const ProjectionCamera<double> camera = s.camera;
  return [use, camera](const RenderMaps<double>& m, LossTerms& terms, MapGradients<double>& g) {
    const size_t n = m.pixels();
    for (size_t u = 0; u < n; ++u) {
      if (!use[u]) continue;
      const Vec3d ray = camera.ray(static_cast<int>(u) % m.width, static_cast<int>(u) / m.width);
      const Vec3d normal{m.normal[u], m.normal[n + u], m.normal[2 * n + u]};
      const PlaneDepth<double> d = plane_depth(normal, m.distance[u], m.alpha[u], ray);
      terms.total += weight_of(u) * d.z;
      g.distance[u] += weight_of(u) * d.dz_ddistance;
      for (int k = 0; k < 3; ++k) g.normal[k * n + u] += weight_of(u) * d.dz_dnormal[k];
    }
  };
}

MapLossFunction<double> map_probe(const std::string& output) {
  return [output](const RenderMaps<double>& m, LossTerms& terms, MapGradients<double>& g) {
    if (output == "color") probe(m.color, terms, g.color);
    if (output == "alpha") probe(m.alpha, terms, g.alpha);
    if (output == "normal") probe(m.normal, terms, g.normal);
    if (output == "distance") probe(m.distance, terms, g.distance);
  };
}

class ThroughOutput : public testing::TestWithParam<const char*> {};

TEST_P(ThroughOutput, EveryParameterMatchesDifferences) {
  const std::string output = GetParam();
  const Model model = make_model<double>();
  const TrainingView view = make_view();
  const StepRequest request = make_request();
  const MapLossFunction<double> loss =
      output == "plane_depth" ? plane_depth_probe(model, view, request) : map_probe(output);
  const Gradients<double> g = gradients(model, view, request, 0.0, loss);
  ASSERT_EQ(g.visible, model.size()) << "a Gaussian of the scene touches no pixel";
  for (const ParameterClass& c : parameter_classes()) {
    const Comparison found = compare(c, model, g.gradient, [&](const Model& moved) {
      LossTerms terms;
      MapGradients<double> unused;
      const Splats<double> s = make_splats(moved, view.data.camera, request.raster, request.sh_degree);
      const RenderMaps<double> maps = render_maps(s, request.raster);
      unused.reset(maps.pixels());
      loss(maps, terms, unused);
      return terms.total;
    });
    const std::string name = c.name;
    const bool reaches = name != "semantics" && (output == "color" || (name != "sh_dc" && name != "sh_rest"));
    EXPECT_EQ(found.largest > 1e-3, reaches) << name;
    EXPECT_LT(found.worst, 2e-6) << found.where;
  }
}

INSTANTIATE_TEST_SUITE_P(Gradients, ThroughOutput,
                         testing::Values("color", "alpha", "normal", "distance", "plane_depth"),
                         [](const auto& output) { return std::string(output.param); });

/// In use the threshold is hard; away from it the same differences hold.
TEST(Gradients, HardThresholdDiffersOnlyAtTheCut) {
  Model model = make_model<double>();
  const TrainingView view = make_view();
  StepRequest request = make_request();
  request.raster.smooth_cutoff = false;
  const Gradients<double> g = gradients(model, view, request, 0.0, map_probe("color"));
  request.raster.smooth_cutoff = true;
  const Gradients<double> smooth = gradients(model, view, request, 0.0, map_probe("color"));
  double largest = 0, difference = 0;
  for (size_t k = 0; k < model.sh.size(); ++k) {
    largest = std::max(largest, std::abs(smooth.gradient.sh[k]));
    difference = std::max(difference, std::abs(smooth.gradient.sh[k] - g.gradient.sh[k]));
  }
  EXPECT_GT(difference, 0);
  EXPECT_LT(difference, 0.02 * largest);  // of the order of 1/255 times the pixels at the rim
}

/// Density statistics see the colour losses alone.
TEST(Gradients, StatisticsTakePhotometricGradientsOnly) {
  const Model model = make_model<double>();
  const TrainingView view = make_view();
  StepRequest request = make_request();
  const Gradients<double> geometry = gradients(model, view, request, 0.0, map_probe("normal"));
  for (float value : geometry.statistics.gradient) EXPECT_EQ(value, 0.0f);
  request.losses.weight[Loss::kSemanticSoft] = 1;
  request.losses.coupling = SemanticCoupling::kPlain;
  request.losses.coupling_strength = 1;
  const Gradients<double> color = gradients(model, view, request, 0.0, map_probe("color"));
  const Gradients<double> alone = gradients(model, view, make_request(), 0.0, map_probe("color"));
  EXPECT_EQ(color.statistics.gradient, alone.statistics.gradient);
  EXPECT_NE(color.gradient.positions, alone.gradient.positions);
}

TEST(Gradients, StatisticsAreInNormalisedDeviceCoordinates) {
  const Model model = make_model<double>();
  const TrainingView view = make_view();
  const Gradients<double> g = gradients(model, view, make_request(), 0.0, map_probe("color"));
  double weight = 0, alpha = 0;
  const Splats<double> s = make_splats(model, view.data.camera, make_request().raster, 3);
  for (double a : render_maps(s, make_request().raster).alpha) alpha += a;
  for (size_t i = 0; i < model.size(); ++i) {
    const Vec2d m = g.photometric_mean[i];
    EXPECT_FLOAT_EQ(g.statistics.gradient[i], float(std::hypot(m.x * kWidth / 2, m.y * kHeight / 2)));
    EXPECT_GE(g.statistics.gradient_abs[i], g.statistics.gradient[i]);
    EXPECT_EQ(g.statistics.visible[i], 1.0f);
    EXPECT_LE(g.statistics.unsupported[i], g.statistics.weight[i] * 1.00001f);
    weight += g.statistics.weight[i];
  }
  EXPECT_NEAR(weight, alpha, 1e-5);
}

/// dL/d mean2D of the statistics is itself right. Moving the principal point moves every mean. Without guard band and
/// rays it moves only the means.
TEST(Gradients, MeanGradientSumsToTheShiftOfTheImage) {
  const Model model = make_model<double>();
  TrainingView view = make_view();
  const StepRequest request = make_request();
  const MapLossFunction<double> loss = map_probe("color");
  const Gradients<double> g = gradients(model, view, request, 0.0, loss);
  double sum = 0;
  for (const Vec2d& m : g.photometric_mean) sum += m.x;
  const auto value = [&](double shift) {
    Splats<double> s = make_splats(model, view.data.camera, request.raster, 3);
    for (Projection<double>& p : s.projections) {
      p.mean.x += shift;
      p.pixels = {0, 0, kWidth, kHeight};
    }
    LossTerms terms;
    MapGradients<double> unused;
    unused.reset(size_t(kWidth) * kHeight);
    loss(render_maps(s, request.raster), terms, unused);
    return terms.total;
  };
  EXPECT_NEAR((value(1e-5) - value(-1e-5)) / 2e-5, sum, 1e-6 * std::abs(sum));
}

}  // namespace
}  // namespace aligngs::reference
