#include "nn/vggt_pose.h"

#include <algorithm>
#include <cmath>

namespace aligngs::nn {

std::array<double, 9> rotation_from_xyzw(const std::array<double, 4>& q) {
  const auto [i, j, k, r] = q;
  const double length2 = i * i + j * j + k * k + r * r;
  if (!(length2 > 0)) return {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double s = 2 / length2;
  return {1 - s * (j * j + k * k), s * (i * j - k * r),     s * (i * k + j * r),
          s * (i * j + k * r),     1 - s * (i * i + k * k), s * (j * k - i * r),
          s * (i * k - j * r),     s * (j * k + i * r),     1 - s * (i * i + j * j)};
}

std::array<double, 4> xyzw_from_rotation(const std::array<double, 9>& m) {
  // The largest of the four components is well conditioned; the others follow from it.
  const std::array<double, 4> squares = {1 + m[0] - m[4] - m[8], 1 - m[0] + m[4] - m[8], 1 - m[0] - m[4] + m[8],
                                         1 + m[0] + m[4] + m[8]};
  const auto largest = size_t(std::max_element(squares.begin(), squares.end()) - squares.begin());
  const double four = 2 * std::sqrt(std::max(squares[largest], 1e-30));  // 4 |component|
  std::array<double, 4> q{};
  switch (largest) {
    case 0:
      q = {four / 4, (m[1] + m[3]) / four, (m[2] + m[6]) / four, (m[7] - m[5]) / four};
      break;
    case 1:
      q = {(m[1] + m[3]) / four, four / 4, (m[5] + m[7]) / four, (m[2] - m[6]) / four};
      break;
    case 2:
      q = {(m[2] + m[6]) / four, (m[5] + m[7]) / four, four / 4, (m[3] - m[1]) / four};
      break;
    default:
      q = {(m[7] - m[5]) / four, (m[2] - m[6]) / four, (m[3] - m[1]) / four, four / 4};
  }
  if (q[3] < 0) {
    for (double& v : q) v = -v;
  }
  return q;
}

VggtCamera decode_pose(const PoseEncoding& e, int64_t width, int64_t height) {
  constexpr double kSmallestAngle = 1e-3;  // rad; keeps the focal length finite
  VggtCamera camera;
  camera.translation = {double(e[0]), double(e[1]), double(e[2])};
  camera.rotation = rotation_from_xyzw({double(e[3]), double(e[4]), double(e[5]), double(e[6])});
  const auto focal = [&](double side, double angle) {
    return side / 2 / std::tan(std::max(angle, kSmallestAngle) / 2);
  };
  camera.fy = focal(double(height), double(e[7]));
  camera.fx = focal(double(width), double(e[8]));
  camera.cx = double(width) / 2;
  camera.cy = double(height) / 2;
  return camera;
}

}  // namespace aligngs::nn
