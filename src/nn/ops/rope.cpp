#include "nn/ops/rope.h"

#include <cmath>
#include <utility>

namespace aligngs::nn {

namespace {

std::vector<double> integer_angles(int64_t quarter, int64_t largest, double frequency) {
  std::vector<double> angles;
  for (int64_t p = 0; p <= largest; ++p) {
    for (int64_t j = 0; j < quarter; ++j)
      angles.push_back(double(p) * std::pow(frequency, -double(j) / double(quarter)));
  }
  return angles;
}

}  // namespace

Rope2d::Rope2d(int64_t head_dim, int64_t largest, double frequency)
    : Rope2d(head_dim, integer_angles(head_dim / 4, largest, frequency)) {}

Rope2d::Rope2d(int64_t head_dim, const std::vector<double>& angles) : quarter_(head_dim / 4) {
  std::vector<float> cosines, sines;
  for (const double angle : angles) {
    cosines.push_back(float(std::cos(angle)));
    sines.push_back(float(std::sin(angle)));
  }
  cos_ = std::move(cosines);
  sin_ = std::move(sines);
}

void Rope2d::rotate_half(float* half, int64_t position) const {
  const float* c = cos_.data() + position * quarter_;
  const float* s = sin_.data() + position * quarter_;
  for (int64_t j = 0; j < quarter_; ++j) {
    const float a = half[j], b = half[j + quarter_];
    half[j] = a * c[j] - b * s[j];
    half[j + quarter_] = b * c[j] + a * s[j];
  }
}

void Rope2d::rotate(float* head, int64_t y, int64_t x) const {
  rotate_half(head, y);
  rotate_half(head + 2 * quarter_, x);
}

}  // namespace aligngs::nn
