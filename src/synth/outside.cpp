#include "synth/outside.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angles.h"
#include "synth/noise.h"

namespace aligngs {
namespace {

Vec3f outside_mix(const Vec3f& a, const Vec3f& b, float t) { return a + (b - a) * std::clamp(t, 0.0f, 1.0f); }

/// Length along `d` from `o` to the cylinder of radius r around the z axis, from inside it; infinite for upright rays.
double reach_of_cylinder(const Vec3d& o, const Vec3d& d, double r) {
  const double a = d.x * d.x + d.y * d.y, b = o.x * d.x + o.y * d.y, c = o.x * o.x + o.y * o.y - r * r;
  if (a < 1e-12 || c > 0) return std::numeric_limits<double>::infinity();
  return (-b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
}

/// A point of a cylinder: arc length and height above the lawn, metres.
struct CylinderPoint {
  float along, height;
};

CylinderPoint point_on(const Vec3d& p, double radius, double ground) {
  return {static_cast<float>(std::atan2(p.y, p.x) * radius), static_cast<float>(p.z - ground)};
}

/// Trunks every four metres or so, with crowns, and bushes between them. False: one looks past.
bool tree_color(const CylinderPoint& p, double radius, uint32_t seed, Vec3f& color) {
  const float spacing = static_cast<float>(2 * kPi * radius / std::round(2 * kPi * radius / 4.0));
  const int cell = static_cast<int>(std::floor(p.along / spacing));
  const float foliage = 0.5f + 0.5f * fractal_noise(p.along * 2.0f, p.height * 2.0f, 2, seed + 3);
  const Vec3f leaves = outside_mix({0.06f, 0.14f, 0.04f}, {0.32f, 0.46f, 0.16f}, foliage);
  for (int neighbour = cell - 1; neighbour <= cell + 1; ++neighbour) {
    const float middle =
        (static_cast<float>(neighbour) + 0.3f + 0.4f * lattice_random(neighbour, 1, 0, seed)) * spacing;
    const float top = 3.6f + 1.6f * lattice_random(neighbour, 2, 0, seed), crown = 1.0f + 0.5f * foliage;
    const float across = p.along - middle;
    if (std::hypot(across, (p.height - top) * 0.8f) < crown) {
      color = leaves;
      return true;
    }
    if (std::fabs(across) < 0.16f && p.height < top) {
      color = outside_mix({0.10f, 0.07f, 0.05f}, {0.24f, 0.18f, 0.13f}, foliage);
      return true;
    }
  }
  const float bush = 0.9f + 0.5f * fractal_noise(p.along * 0.9f, 0.5f, 2, seed + 4);
  if (p.height < bush) {
    color = leaves * 0.8f;
    return true;
  }
  return false;
}

/// Houses with rows of windows. False: sky between and above them.
bool house_color(const CylinderPoint& p, uint32_t seed, Vec3f& color) {
  constexpr float kWidth = 13;  // metres from house to house
  const int cell = static_cast<int>(std::floor(p.along / kWidth));
  const float x = p.along - static_cast<float>(cell) * kWidth;
  const float height = 7 + 6 * lattice_random(cell, 5, 0, seed), wide = 8 + 3 * lattice_random(cell, 6, 0, seed);
  if (x > wide) return false;
  const float ridge = height + 2.5f * (1 - std::fabs(x / wide - 0.5f) * 2);
  if (p.height > ridge) return false;
  if (p.height > height) {
    color = outside_mix({0.30f, 0.12f, 0.08f}, {0.22f, 0.20f, 0.20f}, lattice_random(cell, 7, 0, seed));
    return true;
  }
  const float u = std::fmod(x, 2.2f), v = std::fmod(p.height, 2.8f);
  const bool pane = u > 0.6f && u < 1.6f && v > 0.9f && v < 2.2f;
  const Vec3f wall = outside_mix({0.70f, 0.62f, 0.48f}, {0.52f, 0.30f, 0.22f}, lattice_random(cell, 8, 0, seed));
  color = pane ? Vec3f{0.10f, 0.13f, 0.18f} : wall;
  return true;
}

}  // namespace

Vec3f outside_color(const Vec3d& origin, const Vec3d& direction, const OutsideSettings& s, uint32_t seed,
                    double* distance) {
  const double length = norm(direction);
  const Vec3d d = direction * (1 / length);
  double there = std::numeric_limits<double>::infinity();
  const double lawn = d.z < 0 ? (s.ground - origin.z) / d.z : std::numeric_limits<double>::infinity();
  const auto finish = [&](const Vec3f& color) {
    if (distance != nullptr) *distance = there;
    return color;
  };
  Vec3f color;
  for (const double radius : {s.near_radius, s.middle_radius, s.far_radius}) {
    const double reach = reach_of_cylinder(origin, d, radius);
    if (reach >= lawn) break;
    const CylinderPoint p = point_on(origin + d * reach, radius, s.ground);
    // Bushes and trees at both nearer distances, with gaps of two in three trees at the nearest.
    const bool solid = radius == s.far_radius ? house_color(p, seed, color)
                                              : tree_color(p, radius, seed + static_cast<uint32_t>(radius), color);
    if (!solid) continue;
    there = reach;
    return finish(color);
  }
  if (std::isfinite(lawn)) {
    there = lawn;
    const Vec3d p = origin + d * lawn;
    const float grass =
        0.5f + 0.5f * fractal_noise(static_cast<float>(p.x) * 0.8f, static_cast<float>(p.y) * 0.8f, 3, seed + 1);
    return finish(outside_mix({0.16f, 0.28f, 0.07f}, {0.40f, 0.52f, 0.20f}, grass));
  }
  const float up = static_cast<float>(std::max(0.0, d.z));
  const float cloud =
      0.5f + 0.5f * fractal_noise(static_cast<float>(d.x) * 4, static_cast<float>(d.y) * 4, 3, seed + 2);
  return finish(outside_mix(outside_mix({0.80f, 0.88f, 0.97f}, {0.42f, 0.62f, 0.95f}, up * 1.6f), {0.95f, 0.95f, 0.96f},
                            cloud - 0.35f));
}

}  // namespace aligngs
