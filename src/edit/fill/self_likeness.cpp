#include "edit/fill/self_likeness.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

namespace aligngs {
namespace {

/// The colour in which the texture varies most: the first principal axis, by power iteration.
Vec3f main_axis(const TextureMap& map) {
  double covariance[3][3] = {};
  for (size_t at = 0; at < map.mask.size(); ++at) {
    if (map.mask[at] <= 0) continue;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        covariance[a][b] += static_cast<double>(map.value[at][a]) * static_cast<double>(map.value[at][b]);
  }
  Vec3d axis{1, 1, 1};
  constexpr int kIterations = 30;
  for (int k = 0; k < kIterations; ++k) {
    Vec3d next;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) next[a] += covariance[a][b] * axis[b];
    const double length = norm(next);
    if (!(length > 0)) return {0, 0, 0};
    axis = next * (1 / length);
  }
  return axis.cast<float>();
}

/// A square of complex numbers with its discrete Fourier transform.
class Spectrum {
 public:
  explicit Spectrum(int side) : side_(side), values_(static_cast<size_t>(side) * static_cast<size_t>(side)) {}
  std::complex<float>& at(int i, int j) {
    return values_[static_cast<size_t>(j) * static_cast<size_t>(side_) + static_cast<size_t>(i)];
  }
  /// The value at a shift, which may be negative.
  float real(int i, int j) { return at((i + side_) % side_, (j + side_) % side_).real(); }
  /// Only lines below `lines` have values that are not 0.
  void forward(int lines) {
    for (int j = 0; j < lines; ++j) line(j, 1, false);  // the transform of zeros is zeros
    for (int i = 0; i < side_; ++i) line(i, side_, false);
  }
  /// Values are right in the columns from -reach to reach alone.
  void inverse(int reach) {
    for (int j = 0; j < side_; ++j) line(j, 1, true);
    for (int i = -std::min(reach, side_ / 2); i <= reach && 2 * i < side_; ++i) line((i + side_) % side_, side_, true);
  }
  /// Correlation: conj(this) * other.
  void correlate(const Spectrum& other) {
    for (size_t k = 0; k < values_.size(); ++k) values_[k] = std::conj(values_[k]) * other.values_[k];
  }

 private:
  /// Transforms one row (step 1) or one column (step side).
  void line(int number, int step, bool back) {
    const size_t n = static_cast<size_t>(side_), stride = static_cast<size_t>(step);
    const size_t first = static_cast<size_t>(number) * (step == 1 ? n : 1);
    in_.resize(n);
    for (size_t k = 0; k < n; ++k) in_[k] = values_[first + k * stride];
    if (back)
      fft_.inv(out_, in_);
    else
      fft_.fwd(out_, in_);
    for (size_t k = 0; k < n; ++k) values_[first + k * stride] = out_[k];
  }
  int side_;
  Eigen::FFT<float> fft_;
  std::vector<std::complex<float>> values_, in_, out_;
};

}  // namespace

SelfLikeness::SelfLikeness(const TextureMap& map, int reach, size_t fewest) : reach_(reach) {
  const Vec3f axis = main_axis(map);
  int side = 16;
  while (side < std::max(map.columns, map.rows) + reach) side *= 2;
  Spectrum value(side), square(side), mask(side);
  for (int j = 0; j < map.rows; ++j) {
    for (int i = 0; i < map.columns; ++i) {
      if (!map.knows(i, j)) continue;
      const float v = dot(map.value[map.index(i, j)], axis);
      value.at(i, j) = v;
      square.at(i, j) = v * v;
      mask.at(i, j) = 1;
    }
  }
  value.forward(map.rows);
  square.forward(map.rows);
  mask.forward(map.rows);
  Spectrum product = value, energy = square, count = mask;
  product.correlate(value);
  energy.correlate(mask);
  count.correlate(mask);
  product.inverse(reach);
  energy.inverse(reach);
  count.inverse(reach);
  values_.resize(static_cast<size_t>(2 * reach + 1) * static_cast<size_t>(reach + 1), 0.f);
  for (int j = 0; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      if (count.real(i, j) < static_cast<float>(fewest)) continue;
      // Energies of both copies where they lie on each other: of this one, and of the one shifted the other way.
      const float both = energy.real(i, j) * energy.real(-i, -j);
      if (both > 0) values_[index(i, j)] = product.real(i, j) / std::sqrt(both);
    }
  }
}

float SelfLikeness::at(int i, int j) const {
  if (j < 0) i = -i, j = -j;
  return std::abs(i) <= reach_ && j <= reach_ ? values_[index(i, j)] : 0.f;
}

}  // namespace aligngs
