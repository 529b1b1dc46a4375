#include "edit/fill/repeated_texture.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

namespace aligngs {
namespace {

constexpr size_t kFewestCells = 400;  ///< known cells that can show a pattern, and that two copies have to share
constexpr float kLobeEnd = 0.15f;     ///< correlation below which a place no longer resembles itself blurred

struct Shift {
  int i = 0, j = 0;    ///< cells
  float likeness = 0;  ///< correlation in [-1, 1]
};

/// Values of the cells of a grid, with a mask.
struct Map {
  int columns = 0, rows = 0;
  std::vector<Vec3f> value;
  std::vector<float> mask;  ///< 1 known, 0 unknown
  size_t index(int i, int j) const {
    return static_cast<size_t>(j) * static_cast<size_t>(columns) + static_cast<size_t>(i);
  }
  bool knows(int i, int j) const { return i >= 0 && j >= 0 && i < columns && j < rows && mask[index(i, j)] > 0; }
};

Map mean_colors(const PlaneGrid& grid, const std::vector<KnownColor>& known) {
  Map map{grid.columns, grid.rows, std::vector<Vec3f>(grid.size()), std::vector<float>(grid.size(), 0.f)};
  for (const KnownColor& k : known) {
    const int i = static_cast<int>(std::floor(k.place.x)), j = static_cast<int>(std::floor(k.place.y));
    if (i < 0 || j < 0 || i >= grid.columns || j >= grid.rows || !(k.weight > 0)) continue;
    map.value[map.index(i, j)] += k.color * k.weight;
    map.mask[map.index(i, j)] += k.weight;
  }
  for (size_t at = 0; at < map.mask.size(); ++at) {
    if (map.mask[at] <= 0) continue;
    map.value[at] = map.value[at] * (1 / map.mask[at]);
    map.mask[at] = 1;
  }
  return map;
}

/// Running mean over 2 r + 1 cells along rows or columns; zeros outside.
void box_blur(std::vector<float>& values, const Map& map, int radius, bool along_rows) {
  const int lines = along_rows ? map.rows : map.columns, length = along_rows ? map.columns : map.rows;
  std::vector<double> sums(static_cast<size_t>(length) + 1);
  for (int l = 0; l < lines; ++l) {
    const auto at = [&](int k) { return along_rows ? map.index(k, l) : map.index(l, k); };
    sums[0] = 0;
    for (int k = 0; k < length; ++k)
      sums[static_cast<size_t>(k) + 1] = sums[static_cast<size_t>(k)] + static_cast<double>(values[at(k)]);
    for (int k = 0; k < length; ++k) {
      const size_t begin = static_cast<size_t>(std::max(0, k - radius));
      const size_t end = static_cast<size_t>(std::min(length, k + radius + 1));
      values[at(k)] = static_cast<float>((sums[end] - sums[begin]) / (2 * radius + 1));
    }
  }
}

/// About a Gaussian of standard deviation `sigma` cells: three running means (Wells 1986).
void blur(std::vector<float>& values, const Map& map, double sigma) {
  const int radius = std::max(1, static_cast<int>(std::lround(sigma)));  // three boxes of 2 r + 1 have sigma r + 1/2
  for (int pass = 0; pass < 3; ++pass) {
    box_blur(values, map, radius, true);
    box_blur(values, map, radius, false);
  }
}

/// Takes the light away: the blurred colours of the known cells.
void subtract_light(Map& map, double sigma) {
  std::vector<float> weight = map.mask;
  blur(weight, map, sigma);
  for (int c = 0; c < 3; ++c) {
    std::vector<float> channel(map.value.size());
    for (size_t at = 0; at < channel.size(); ++at) channel[at] = map.mask[at] > 0 ? map.value[at][c] : 0.f;
    blur(channel, map, sigma);
    for (size_t at = 0; at < channel.size(); ++at) {
      if (map.mask[at] > 0) map.value[at][c] -= channel[at] / weight[at];
    }
  }
}

/// Shortens the values of stains, which are no part of a pattern: to `spreads` times the typical length. Returns that
/// length, the median with the factor of a normal distribution.
float clip_stains(Map& map, float spreads) {
  constexpr float kNormal = 1.4826f;
  std::vector<float> lengths;
  for (size_t at = 0; at < map.mask.size(); ++at) {
    if (map.mask[at] > 0) lengths.push_back(norm(map.value[at]));
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const float typical = kNormal * *middle;
  for (Vec3f& value : map.value) {
    const float length = norm(value);
    if (length > spreads * typical && length > 0) value = value * (spreads * typical / length);
  }
  return typical;
}

/// The colour in which the texture varies most: the first principal axis, by power iteration.
Vec3f main_axis(const Map& map) {
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
  void forward() { transform(false); }
  void inverse() { transform(true); }
  /// Correlation: conj(this) * other.
  void correlate(const Spectrum& other) {
    for (size_t k = 0; k < values_.size(); ++k) values_[k] = std::conj(values_[k]) * other.values_[k];
  }

 private:
  void transform(bool back) {
    const size_t n = static_cast<size_t>(side_);
    std::vector<std::complex<float>> in(n), out(n);
    for (int pass = 0; pass < 2; ++pass) {
      const size_t step = pass == 0 ? 1 : n, line = pass == 0 ? n : 1;
      for (size_t l = 0; l < n; ++l) {
        for (size_t k = 0; k < n; ++k) in[k] = values_[l * line + k * step];
        if (back)
          fft_.inv(out, in);
        else
          fft_.fwd(out, in);
        for (size_t k = 0; k < n; ++k) values_[l * line + k * step] = out[k];
      }
    }
  }
  int side_;
  Eigen::FFT<float> fft_;
  std::vector<std::complex<float>> values_;
};

/// Correlation of the surface with itself for every shift of at most `reach` cells; the upper half plane is enough.
class SelfLikeness {
 public:
  SelfLikeness(const Map& map, const Vec3f& axis, int reach) : reach_(reach) {
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
    value.forward();
    square.forward();
    mask.forward();
    Spectrum product = value, energy = square, count = mask;
    product.correlate(value);
    energy.correlate(mask);
    count.correlate(mask);
    product.inverse();
    energy.inverse();
    count.inverse();
    values_.resize(static_cast<size_t>(2 * reach + 1) * static_cast<size_t>(reach + 1), 0.f);
    for (int j = 0; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        if (count.real(i, j) < static_cast<float>(kFewestCells)) continue;
        // Energies of both copies where they lie on each other: of this one, and of the one shifted the other way.
        const float both = energy.real(i, j) * energy.real(-i, -j);
        if (both > 0) slot(i, j) = product.real(i, j) / std::sqrt(both);
      }
    }
  }
  int reach() const { return reach_; }
  float at(int i, int j) const {
    if (j < 0) i = -i, j = -j;
    return std::abs(i) <= reach_ && j <= reach_
               ? values_[static_cast<size_t>(j) * static_cast<size_t>(2 * reach_ + 1) + static_cast<size_t>(i + reach_)]
               : 0.f;
  }

 private:
  float& slot(int i, int j) {
    return values_[static_cast<size_t>(j) * static_cast<size_t>(2 * reach_ + 1) + static_cast<size_t>(i + reach_)];
  }
  int reach_;
  std::vector<float> values_;
};

/// Radius in cells within which a surface resembles itself only because it is blurred. The correlation ends there in
/// the direction in which it ends first. Along a stripe it never ends, and those shifts are good.
double lobe_radius(const SelfLikeness& likeness) {
  constexpr int kDirections = 24;
  double least = likeness.reach();
  for (int d = 0; d < kDirections; ++d) {
    const double angle = 3.14159265358979 * d / kDirections;
    for (int r = 1; r < likeness.reach(); ++r) {
      const int i = static_cast<int>(std::lround(r * std::cos(angle)));
      const int j = static_cast<int>(std::lround(r * std::sin(angle)));
      if (likeness.at(i, j) > kLobeEnd) continue;
      least = std::min(least, static_cast<double>(r));
      break;
    }
  }
  return least;
}

/// Shifts at which the surface resembles itself, the best first, in both directions; none of two neighbours.
std::vector<Shift> shifts_of(const SelfLikeness& likeness, const TextureSettings& settings) {
  constexpr double kBeyondLobe = 1.5;
  const double lobe = kBeyondLobe * lobe_radius(likeness);
  std::vector<Shift> all;
  for (int j = 0; j <= likeness.reach(); ++j) {
    for (int i = -likeness.reach(); i <= likeness.reach(); ++i) {
      if (j == 0 && i <= 0) continue;
      const float value = likeness.at(i, j);
      if (value >= settings.least_likeness && std::hypot(i, j) > lobe) all.push_back({i, j, value});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Shift& a, const Shift& b) { return a.likeness > b.likeness; });
  std::vector<Shift> out;
  for (const Shift& s : all) {
    if (out.size() >= settings.most_shifts) break;
    const bool near = std::any_of(out.begin(), out.end(),
                                  [&](const Shift& o) { return std::abs(o.i - s.i) <= 1 && std::abs(o.j - s.j) <= 1; });
    if (near) continue;
    out.push_back(s);
    out.push_back({-s.i, -s.j, s.likeness});
  }
  return out;
}

/// The mean of the known copies of a cell, by their likeness; false where none is known.
bool predict(const Map& map, const std::vector<Shift>& shifts, size_t most, int i, int j, Vec3f& out) {
  Vec3f sum;
  float total = 0;
  size_t copies = 0;
  for (const Shift& s : shifts) {
    if (!map.knows(i + s.i, j + s.j)) continue;
    // The inverse variance of a copy's error, in units of the texture's.
    const float weight = s.likeness * s.likeness / (1.02f - s.likeness * s.likeness);
    sum += map.value[map.index(i + s.i, j + s.j)] * weight;
    total += weight;
    if (++copies == most) break;
  }
  if (copies == 0) return false;
  out = sum * (1 / total);
  return true;
}

/// How well copies predict known cells: sums over the known cells.
struct Prediction {
  double agreement = 0, energy = 0, truth = 0;
  /// Least squares: the gain agreement / energy leaves truth - agreement^2 / energy.
  double gain() const { return energy > 0 ? std::clamp(agreement / energy, 0.0, 1.0) : 0; }
  double explained() const {
    return energy > 0 && agreement > 0 && truth > 0 ? agreement * agreement / energy / truth : 0;
  }
  void add(const Vec3f& known, const Vec3f& copy) {
    agreement += static_cast<double>(dot(known, copy));
    energy += static_cast<double>(dot(copy, copy));
  }
};

Prediction prediction_of(const Map& map, const std::vector<Shift>& shifts, size_t most_copies) {
  Prediction out;
  for (int j = 0; j < map.rows; ++j) {
    for (int i = 0; i < map.columns; ++i) {
      if (!map.knows(i, j)) continue;
      const Vec3f& known = map.value[map.index(i, j)];
      out.truth += static_cast<double>(dot(known, known));
      Vec3f copy;
      if (predict(map, shifts, most_copies, i, j, copy)) out.add(known, copy);
    }
  }
  return out;
}

/// The part of a map on one side of its middle, along its longer edge.
Map half_of(const Map& map, bool second) {
  Map out = map;
  const bool by_column = map.columns >= map.rows;
  const int middle = (by_column ? map.columns : map.rows) / 2;
  for (int j = 0; j < map.rows; ++j) {
    for (int i = 0; i < map.columns; ++i) {
      if (((by_column ? i : j) >= middle) != second) out.mask[out.index(i, j)] = 0;
    }
  }
  return out;
}

/// Share of the texture that the shifts of one half of the surface explain on the other half. Among thousands of shifts
/// some fit by chance, and those do not fit there.
double explained_elsewhere(const Map& map, const Vec3f& axis, int reach, const TextureSettings& settings) {
  Prediction both;
  for (const bool second : {false, true}) {
    const std::vector<Shift> shifts = shifts_of(SelfLikeness(half_of(map, second), axis, reach), settings);
    const Prediction p = prediction_of(half_of(map, !second), shifts, settings.most_copies);
    both.agreement += p.agreement;
    both.energy += p.energy;
    both.truth += p.truth;
  }
  return both.explained();
}

}  // namespace

std::vector<Vec3f> repeated_texture(const PlaneGrid& grid, const std::vector<KnownColor>& known,
                                    const TextureSettings& settings) {
  Map map = mean_colors(grid, known);
  const auto cells = std::count_if(map.mask.begin(), map.mask.end(), [](float m) { return m > 0; });
  if (static_cast<size_t>(cells) < kFewestCells) return {};
  subtract_light(map, settings.light / grid.cell);
  constexpr float kSpreads = 3;
  if (clip_stains(map, kSpreads) < settings.least_contrast) return {};
  const Vec3f axis = main_axis(map);
  const int reach = std::clamp(static_cast<int>(settings.reach / grid.cell), 1, std::max(grid.columns, grid.rows));
  const std::vector<Shift> shifts = shifts_of(SelfLikeness(map, axis, reach), settings);
  const Prediction prediction = prediction_of(map, shifts, settings.most_copies);
  const double least = static_cast<double>(settings.least_explained);
  if (prediction.explained() < least || explained_elsewhere(map, axis, reach, settings) < least) return {};

  const float gain = static_cast<float>(prediction.gain());
  std::vector<Vec3f> texture(grid.size());
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      Vec3f copy;
      if (predict(map, shifts, settings.most_copies, i, j, copy)) texture[grid.index(i, j)] = copy * gain;
    }
  }
  return texture;
}

}  // namespace aligngs
