#include "edit/fill/repeated_texture.h"

#include <algorithm>
#include <cmath>

#include "edit/fill/self_likeness.h"

namespace aligngs {
namespace {

constexpr size_t kFewestCells = 400;  ///< known cells that can show a pattern, and that two copies have to share
constexpr float kLobeEnd = 0.15f;     ///< correlation below which a place no longer resembles itself blurred

struct Shift {
  int i = 0, j = 0;    ///< cells
  float likeness = 0;  ///< correlation in [-1, 1]
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
bool predict(const TextureMap& map, const std::vector<Shift>& shifts, size_t most, int i, int j, Vec3f& out) {
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

Prediction prediction_of(const TextureMap& map, const std::vector<Shift>& shifts, size_t most_copies) {
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
TextureMap half_of(const TextureMap& map, bool second) {
  TextureMap out = map;
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
double explained_elsewhere(const TextureMap& map, int reach, const TextureSettings& settings) {
  Prediction both;
  for (const bool second : {false, true}) {
    const std::vector<Shift> shifts = shifts_of(SelfLikeness(half_of(map, second), reach, kFewestCells), settings);
    const Prediction p = prediction_of(half_of(map, !second), shifts, settings.most_copies);
    both.agreement += p.agreement;
    both.energy += p.energy;
    both.truth += p.truth;
  }
  return both.explained();
}

}  // namespace

std::vector<Vec3f> repeated_texture(const TextureMap& map, const TextureSettings& settings) {
  const auto cells = std::count_if(map.mask.begin(), map.mask.end(), [](float m) { return m > 0; });
  if (static_cast<size_t>(cells) < kFewestCells) return {};
  const int reach = std::clamp(settings.reach, 1, std::max(map.columns, map.rows));
  const std::vector<Shift> shifts = shifts_of(SelfLikeness(map, reach, kFewestCells), settings);
  const Prediction prediction = prediction_of(map, shifts, settings.most_copies);
  const double least = static_cast<double>(settings.least_explained);
  if (prediction.explained() < least || explained_elsewhere(map, reach, settings) < least) return {};

  const float gain = static_cast<float>(prediction.gain());
  std::vector<Vec3f> texture(map.value.size());
  for (int j = 0; j < map.rows; ++j) {
    for (int i = 0; i < map.columns; ++i) {
      Vec3f copy;
      if (predict(map, shifts, settings.most_copies, i, j, copy)) texture[map.index(i, j)] = copy * gain;
    }
  }
  return texture;
}

}  // namespace aligngs
