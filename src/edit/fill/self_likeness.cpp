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

/// The smallest number from `least` on that has no other prime factors than 2, 3 and 5: a transform of such a length
/// is quick.
int quick_length(int least) {
  for (int n = std::max(1, least);; ++n) {
    int rest = n;
    for (const int factor : {2, 3, 5}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) return n;
  }
}

/// A rectangle of complex numbers with its discrete Fourier transform.
class Spectrum {
 public:
  Spectrum(int columns, int rows)
      : columns_(columns), rows_(rows), values_(static_cast<size_t>(columns) * static_cast<size_t>(rows)) {}
  std::complex<float>& at(int i, int j) {
    return values_[static_cast<size_t>(j) * static_cast<size_t>(columns_) + static_cast<size_t>(i)];
  }
  /// The value at a shift, which may be negative.
  float real(int i, int j) { return at((i + columns_) % columns_, (j + rows_) % rows_).real(); }
  /// Only lines below `lines` have values that are not 0.
  void forward(int lines) {
    for (int j = 0; j < lines; ++j) row(j, false);  // the transform of zeros is zeros
    for (int i = 0; i < columns_; i += kBlock) columns(i, std::min(i + kBlock, columns_), false);
  }
  /// Values are right in the columns from -reach to reach alone.
  void inverse(int reach) {
    for (int j = 0; j < rows_; ++j) row(j, true);
    const int right = std::min(reach + 1, columns_), left = std::max(right, columns_ - reach);
    for (int i = 0; i < right; i += kBlock) columns(i, std::min(i + kBlock, right), true);
    for (int i = left; i < columns_; i += kBlock) columns(i, std::min(i + kBlock, columns_), true);
  }
  /// Correlation: conj(this) * other.
  void correlate(const Spectrum& other) {
    for (size_t k = 0; k < values_.size(); ++k) values_[k] = std::conj(values_[k]) * other.values_[k];
  }

 private:
  static constexpr int kBlock = 8;  ///< columns that are read together: a line of the cache

  void row(int j, bool back) {
    const auto first = values_.begin() + static_cast<std::ptrdiff_t>(j) * columns_;
    in_.assign(first, first + columns_);
    transform(back);
    std::copy(out_.begin(), out_.end(), first);
  }
  void columns(int begin, int end, bool back) {
    const size_t height = static_cast<size_t>(rows_), width = static_cast<size_t>(end - begin);
    block_.resize(height * width);
    for (size_t j = 0; j < height; ++j) {
      const std::complex<float>* line = &at(begin, static_cast<int>(j));
      for (size_t k = 0; k < width; ++k) block_[k * height + j] = line[k];
    }
    for (size_t k = 0; k < width; ++k) {
      const auto first = block_.begin() + static_cast<std::ptrdiff_t>(k * height);
      in_.assign(first, first + rows_);
      transform(back);
      std::copy(out_.begin(), out_.end(), first);
    }
    for (size_t j = 0; j < height; ++j) {
      std::complex<float>* line = &at(begin, static_cast<int>(j));
      for (size_t k = 0; k < width; ++k) line[k] = block_[k * height + j];
    }
  }
  /// From in_ to out_.
  void transform(bool back) {
    if (back)
      fft_.inv(out_, in_);
    else
      fft_.fwd(out_, in_);
  }

  int columns_, rows_;
  Eigen::FFT<float> fft_;
  std::vector<std::complex<float>> values_, in_, out_, block_;
};

}  // namespace

SelfLikeness::SelfLikeness(const TextureMap& map, int reach, size_t fewest) : reach_(reach) {
  const Vec3f axis = main_axis(map);
  const int columns = quick_length(map.columns + reach), rows = quick_length(map.rows + reach);
  Spectrum value(columns, rows), square(columns, rows), mask(columns, rows);
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
