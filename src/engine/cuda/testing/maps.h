// For tests: the losses of one fixture by both engines.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "device/testing/device.h"
#include "device/tolerances.h"
#include "engine/cuda/map_losses.h"
#include "engine/losses/testing/maps.h"

namespace aligngs::cuda {

struct MapLossResult {
  LossTerms terms;
  MapGradients<float> gradients;
  std::vector<float> residual;
};

/// The neighbour of a fixture, or none.
struct TestNeighbour {
  const TrainingView* view = nullptr;
  std::vector<float> depth;
  uint64_t seed = 0;
};

inline MapLossResult losses_on_cpu(const testing_maps::LossFixture& f, const TestNeighbour& other = {}) {
  MapLossResult r;
  const RenderMaps<float> maps = testing_maps::narrow(f.maps);
  r.gradients.reset(maps.pixels());
  const TrainingView none;
  const NeighbourView<float> neighbour{other.view != nullptr ? *other.view : none, other.depth.data(), other.seed};
  const aligngs::MapLossInputs<float> in{maps,    f.view,  f.settings,
                                         nullptr, nullptr, other.view != nullptr ? &neighbour : nullptr};
  aligngs::map_losses<float>(in, r.terms, r.gradients);
  color_residual(in, r.residual);
  return r;
}

inline MapLossResult losses_on_device(DeviceContext& context, const testing_maps::LossFixture& f,
                                      const TestNeighbour& other = {}) {
  const RenderMaps<float> maps = testing_maps::narrow(f.maps);
  const size_t n = maps.pixels();
  DeviceArray<float> color, alpha, normal, distance, expected, d_color, d_normal, d_distance, residual, other_depth;
  color.assign(context, maps.color, "test");
  alpha.assign(context, maps.alpha, "test");
  normal.assign(context, maps.normal, "test");
  distance.assign(context, maps.distance, "test");
  expected.assign(context, maps.expected, "test");
  d_color.resize(context, 3 * n, "test");
  d_normal.resize(context, 3 * n, "test");
  d_distance.resize(context, n, "test");
  residual.resize(context, n, "test");
  DeviceArray<LossTerms> terms(context, 1, "test");
  const TrainingMaps view(context, f.view);
  TrainingMaps other_maps;
  DeviceArena arena(context);
  MapLossSpans in;
  in.maps = {maps.width, maps.height, color.span(), normal.span(), alpha.span(), distance.span(), expected.span(), {}};
  in.view = view.spans();
  in.settings = f.settings;
  if (other.view != nullptr) {
    other_maps = TrainingMaps(context, *other.view);
    other_depth.assign(context, other.depth, "test");
    in.neighbour = {TwoViews<float>(f.view.data.camera, other.view->data.camera), other_maps.spans(),
                    other_depth.span(), other.seed};
  }
  map_losses(arena, in, {{d_color.span(), d_normal.span(), d_distance.span(), {}}, residual.span(), terms.span()});
  MapLossResult r;
  r.terms = terms.to_host()[0];
  r.gradients.reset(n);
  r.gradients.color = d_color.to_host();
  if (f.settings.has_geometry_terms(other.view != nullptr)) {
    r.gradients.normal = d_normal.to_host();
    r.gradients.distance = d_distance.to_host();
  }
  r.residual = residual.to_host();
  return r;
}

inline double largest(const std::vector<float>& values) {
  double m = 0;
  for (const float v : values) m = std::max(m, std::abs(double(v)));
  return m;
}

/// `flips`: the share of entries that may lie beyond the tolerance.
inline void expect_close_maps(const std::vector<float>& a, const std::vector<float>& b, double tolerance,
                              const char* what, double flips = 0) {
  ASSERT_EQ(a.size(), b.size()) << what;
  const double limit = tolerance * largest(b) + 1e-12;
  size_t wrong = 0, first = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    if (std::abs(double(a[i]) - b[i]) <= limit) continue;
    if (wrong++ == 0) first = i;
  }
  EXPECT_LE(double(wrong), flips * double(a.size()))
      << what << "[" << first << "] is " << a[first] << " instead of " << b[first] << ", largest " << largest(b);
}

inline void expect_same_losses(const MapLossResult& device, const MapLossResult& cpu, double flips = 0) {
  const CudaTolerance tolerance;
  // Terms are 1 - cosine, of one pixel in the smallest maps. The cosine's sum of three products, contracted or not, is
  // off by two ulps of 1.
  constexpr double kOneMinusCosine = 2.4e-7;
  const auto near = [&](double value, double wanted, std::string_view name) {
    EXPECT_NEAR(value, wanted, tolerance.relative_loss * std::abs(wanted) + kOneMinusCosine) << name;
  };
  for (const LossRow& row : kLossCatalogue) near(device.terms[row.loss], cpu.terms[row.loss], row.name);
  near(device.terms.total, cpu.terms.total, "total");
  EXPECT_NEAR(device.terms.psnr, cpu.terms.psnr, tolerance.psnr);
  expect_close_maps(device.gradients.color, cpu.gradients.color, tolerance.gradient, "color");
  expect_close_maps(device.gradients.normal, cpu.gradients.normal, tolerance.gradient, "normal", flips);
  expect_close_maps(device.gradients.distance, cpu.gradients.distance, tolerance.gradient, "distance", flips);
  expect_close_maps(device.residual, cpu.residual, tolerance.map, "residual");
}

}  // namespace aligngs::cuda
