// Random rendered maps and a matching view for the tests of the map losses.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "engine/losses/map_losses.h"
#include "engine/testing/request.h"

namespace aligngs::testing_maps {

/// A camera in front of a wall with a fold: everything valid, no two values tied, every loss active.
struct LossFixture {
  RenderMaps<double> maps;
  TrainingView view;
  LossSettings settings;

  explicit LossFixture(int width = 14, int height = 11, uint64_t seed = 1) {
    Random random(seed);
    Camera& camera = view.data.camera;
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = 1.1 * width;
    camera.cx = 0.5 * width + 0.3;
    camera.cy = 0.5 * height - 0.2;
    const size_t pixels = size_t(width) * height;
    maps.width = width;
    maps.height = height;
    maps.color.resize(3 * pixels);
    maps.normal.resize(3 * pixels);
    maps.alpha.resize(pixels);
    maps.distance.resize(pixels);
    maps.expected.resize(pixels);
    maps.median.resize(pixels);
    view.data.name = "random";
    view.data.color = ImageF(width, height, 3);
    view.data.prior_depth = ImageF(width, height, 1);
    view.data.labels = Image<uint16_t>(width, height, 1);
    view.depth_weight = ImageF(width, height, 1);
    view.prior_normal = ImageF(width, height, 3);
    view.label_edge = Image<uint8_t>(width, height, 1);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const size_t i = size_t(y) * width + x;
        for (int c = 0; c < 3; ++c) {
          maps.color[c * pixels + i] = random.uniform(0.05, 0.95);
          view.data.color.at(x, y, c) = static_cast<float>(random.uniform(0.05, 0.95));
        }
        // Two walls that meet at 60 degrees in the middle column, seen from inside.
        const bool right = x >= width / 2;
        const Vec3d wall = normalized(Vec3d{right ? -0.55 : 0.55, 0.1, -1});
        const Vec3d ray = camera.ray(x + 0.5, y + 0.5);
        const double z = -3.0 / dot(wall, ray) * (1 + random.uniform(-0.004, 0.004));
        const double a = random.uniform(0.7, 0.99);
        Vec3d n = wall;
        for (int c = 0; c < 3; ++c) n[c] += random.uniform(-0.15, 0.15);
        for (int c = 0; c < 3; ++c) maps.normal[c * pixels + i] = a * n[c];
        maps.alpha[i] = a;
        maps.distance[i] = a * z * -dot(n, ray);
        maps.expected[i] = a * z * (1 + random.uniform(-0.02, 0.02));
        maps.median[i] = z;
        view.data.prior_depth.at(x, y) = static_cast<float>(-3.0 / dot(wall, ray) * (1 + random.uniform(-0.05, 0.05)));
        view.data.labels.at(x, y) = right ? 3 : 0;
        view.depth_weight.at(x, y) = static_cast<float>(random.uniform(0.2, 1));
        for (int c = 0; c < 3; ++c) view.prior_normal.at(x, y, c) = static_cast<float>(wall[c]);
        view.label_edge.at(x, y) = x == width / 2 ? 1 : 0;
      }
    }
    settings = color_and_class_losses();
    settings.weight[Loss::kL1] = settings.weight[Loss::kSsim] = 0;
  }

  size_t pixels() const { return maps.pixels(); }

  LossTerms run(MapGradients<double>& gradients, ThreadPool* pool = nullptr) const {
    LossTerms terms;
    gradients.reset(pixels());
    map_losses<double>({maps, view, settings, pool, nullptr}, terms, gradients);
    return terms;
  }
};

/// The same maps in single precision.
inline RenderMaps<float> narrow(const RenderMaps<double>& maps) {
  const auto copy = [](const std::vector<double>& a) { return std::vector<float>(a.begin(), a.end()); };
  RenderMaps<float> out;
  out.width = maps.width;
  out.height = maps.height;
  out.color = copy(maps.color);
  out.alpha = copy(maps.alpha);
  out.normal = copy(maps.normal);
  out.distance = copy(maps.distance);
  out.expected = copy(maps.expected);
  out.median = copy(maps.median);
  return out;
}

/// Makes a pixel show the plane n . X = -d (n unit, camera frame) opaquely, with the prior depth and normal to match.
inline void show_plane(LossFixture& f, int x, int y, const Vec3d& n, double d) {
  const size_t i = size_t(y) * f.maps.width + x;
  const double z = -d / dot(n, f.view.data.camera.ray(x + 0.5, y + 0.5));
  f.maps.alpha[i] = 1;
  f.maps.distance[i] = d;
  f.maps.expected[i] = f.maps.median[i] = z;
  f.view.data.prior_depth.at(x, y) = static_cast<float>(z);
  f.view.depth_weight.at(x, y) = 1;
  for (int c = 0; c < 3; ++c) {
    f.maps.normal[c * f.pixels() + i] = n[c];
    f.view.prior_normal.at(x, y, c) = static_cast<float>(n[c]);
  }
}

/// Every pixel shows the same plane and is far from any label edge.
inline LossFixture plane_fixture(const Vec3d& n, double d, int width = 14, int height = 11) {
  LossFixture f(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) show_plane(f, x, y, n, d);
  }
  std::fill(f.view.data.labels.data.begin(), f.view.data.labels.data.end(), uint16_t(0));
  std::fill(f.view.label_edge.data.begin(), f.view.label_edge.data.end(), uint8_t(0));
  return f;
}

/// Largest absolute value over all gradients.
template <class T>
double largest(const MapGradients<T>& g) {
  double m = 0;
  for (const auto* map : {&g.color, &g.normal, &g.distance, &g.alpha}) {
    for (const T v : *map) m = std::max(m, std::isnan(v) ? 1e300 : std::abs(double(v)));
  }
  return m;
}

/// Largest difference of analytic and central-difference gradients of terms.total, as a share of the largest gradient.
/// Covers every value of the colour, normal, distance and alpha maps.
inline double gradient_error(LossFixture& f, double h = 1e-6) {
  MapGradients<double> analytic, unused;
  f.run(analytic);
  double worst = 0;
  const auto check = [&](std::vector<double>& map, const std::vector<double>& gradient) {
    for (size_t i = 0; i < map.size(); ++i) {
      const double value = map[i];
      map[i] = value + h;
      const double up = f.run(unused).total;
      map[i] = value - h;
      const double down = f.run(unused).total;
      map[i] = value;
      worst = std::max(worst, std::abs((up - down) / (2 * h) - gradient[i]));
    }
  };
  check(f.maps.color, analytic.color);
  check(f.maps.normal, analytic.normal);
  check(f.maps.distance, analytic.distance);
  check(f.maps.alpha, analytic.alpha);
  return worst / largest(analytic);
}

}  // namespace aligngs::testing_maps
