#include "scene/look_at.h"

#include <cmath>

#include "core/angles.h"

namespace aligngs {
namespace {

constexpr double kParallel = 1e-9;  // sine of the angle between the view and up: below that up tells no direction

}  // namespace

Rigidd look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double roll_degrees) {
  const Vec3d z = normalized(target - eye);
  Vec3d side = cross(z, up);
  if (norm(side) < kParallel) side = cross(z, std::fabs(z.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0});
  Vec3d x = normalized(side);
  Vec3d y = cross(z, x);
  const double a = roll_degrees * kPi / 180;
  const Vec3d xr = x * std::cos(a) + y * std::sin(a);
  y = cross(z, xr);
  const Mat3d r{{xr.x, xr.y, xr.z, y.x, y.y, y.z, z.x, z.y, z.z}};
  return {r, -(r * eye)};
}

}  // namespace aligngs
