#include "edit/fill/pattern_lattice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "edit/fill/self_likeness.h"

namespace aligngs {
namespace {

constexpr size_t kMostPeaks = 24;        // whose pairs are tried
constexpr double kLeastAngleSine = 0.5;  // of the two vectors: 30 degrees

Vec2d lattice_shift(const PatternLattice& lattice, int m, int n) {
  return {m * lattice.first.x + n * lattice.second.x, m * lattice.first.y + n * lattice.second.y};
}

/// Calls visit(shift) for the shifts of the lattice that are at most `reach` long along either axis, but not for 0.
template <class Visit>
void for_each_shift(const PatternLattice& lattice, double reach, const Visit& visit) {
  const double area = std::fabs(lattice.first.x * lattice.second.y - lattice.first.y * lattice.second.x);
  const auto most = [&](const Vec2d& other) {  // multiples of a vector within the square of the reach
    return static_cast<int>(std::ceil(1.5 * reach * std::hypot(other.x, other.y) / area));
  };
  const int last_m = most(lattice.second), last_n = most(lattice.first);
  for (int n = -last_n; n <= last_n; ++n) {
    for (int m = -last_m; m <= last_m; ++m) {
      const Vec2d shift = lattice_shift(lattice, m, n);
      if ((m != 0 || n != 0) && std::fabs(shift.x) <= reach && std::fabs(shift.y) <= reach) visit(shift);
    }
  }
}

/// Between the four cells around a shift.
float likeness_at(const SelfLikeness& likeness, const Vec2d& shift) {
  const int i = static_cast<int>(std::floor(shift.x)), j = static_cast<int>(std::floor(shift.y));
  const float x = static_cast<float>(shift.x - i), y = static_cast<float>(shift.y - j);
  return (likeness.at(i, j) * (1 - x) + likeness.at(i + 1, j) * x) * (1 - y) +
         (likeness.at(i, j + 1) * (1 - x) + likeness.at(i + 1, j + 1) * x) * y;
}

/// Peaks of the correlation in half of the plane, the highest first.
std::vector<Vec2d> peaks_of(const SelfLikeness& likeness, const LatticeSettings& settings) {
  struct Peak {
    int i, j;
    float value;
  };
  std::vector<Peak> all;
  for (int j = 0; j < likeness.reach(); ++j) {
    for (int i = -likeness.reach() + 1; i < likeness.reach(); ++i) {
      const float value = likeness.at(i, j);
      if (value < settings.least_peak || std::hypot(i, j) < settings.shortest || (j == 0 && i < 0)) continue;
      bool is_peak = true;
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) is_peak &= likeness.at(i + x, j + y) <= value;
      }
      if (is_peak) all.push_back({i, j, value});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Peak& a, const Peak& b) { return a.value > b.value; });
  std::vector<Vec2d> out;
  for (const Peak& p : all) {
    if (out.size() == kMostPeaks) break;
    out.push_back({static_cast<double>(p.i), static_cast<double>(p.j)});
  }
  return out;
}

/// Sum of the correlations over the root of their number, and their mean. Shifts without enough overlap do not count.
struct LatticeScore {
  double significance = 0;
  float mean = 0;
};

LatticeScore score_of(const SelfLikeness& likeness, const PatternLattice& lattice) {
  double sum = 0, count = 0;
  for_each_shift(lattice, likeness.reach() - 1, [&](const Vec2d& shift) {
    const float value = likeness_at(likeness, shift);
    if (value == 0) return;
    sum += static_cast<double>(value);
    ++count;
  });
  if (count == 0) return {};
  return {sum / std::sqrt(count), static_cast<float>(sum / count)};
}

/// Moves the ends of both vectors by parts of a cell: far copies lie right then.
PatternLattice refined(const SelfLikeness& likeness, PatternLattice lattice) {
  constexpr double kSteps[] = {0.5, 0.25, 0.125};  // cells
  constexpr int kMostRounds = 8;
  double best = score_of(likeness, lattice).significance;
  for (const double step : kSteps) {
    bool is_better = true;
    for (int round = 0; is_better && round < kMostRounds; ++round) {
      is_better = false;
      for (int k = 0; k < 8; ++k) {
        PatternLattice moved = lattice;
        Vec2d& end = k < 4 ? moved.first : moved.second;
        (k % 2 ? end.y : end.x) += k % 4 < 2 ? step : -step;
        const double score = score_of(likeness, moved).significance;
        if (score <= best) continue;
        best = score;
        lattice = moved;
        is_better = true;
      }
    }
  }
  return lattice;
}

}  // namespace

std::optional<PatternLattice> pattern_lattice(const TextureMap& map, const LatticeSettings& settings) {
  const auto known = std::count_if(map.mask.begin(), map.mask.end(), [](float m) { return m > 0; });
  const int reach = std::min(settings.reach, std::max(map.columns, map.rows) - 1);
  if (known == 0 || reach < 2) return std::nullopt;
  const SelfLikeness likeness(map, reach, static_cast<size_t>(settings.least_overlap * static_cast<double>(known)) + 1);
  const std::vector<Vec2d> peaks = peaks_of(likeness, settings);
  std::optional<PatternLattice> best;
  double most = 0;
  for (size_t a = 0; a < peaks.size(); ++a) {
    for (size_t b = a + 1; b < peaks.size(); ++b) {
      const PatternLattice lattice{peaks[a], peaks[b]};
      const double sine = std::fabs(peaks[a].x * peaks[b].y - peaks[a].y * peaks[b].x) /
                          (std::hypot(peaks[a].x, peaks[a].y) * std::hypot(peaks[b].x, peaks[b].y));
      if (sine < kLeastAngleSine) continue;
      const double score = score_of(likeness, lattice).significance;
      if (score <= most) continue;
      most = score;
      best = lattice;
    }
  }
  if (!best) return std::nullopt;
  best = refined(likeness, *best);
  best->likeness = score_of(likeness, *best).mean;
  if (best->likeness < settings.least_mean) return std::nullopt;
  return best;
}

std::vector<Vec3f> mean_of_copies(const TextureMap& map, const PatternLattice& lattice) {
  std::vector<std::pair<int, int>> shifts;
  for_each_shift(lattice, std::max(map.columns, map.rows), [&](const Vec2d& s) {
    shifts.emplace_back(static_cast<int>(std::lround(s.x)), static_cast<int>(std::lround(s.y)));
  });
  std::vector<Vec3f> out(map.value.size());
  for (int j = 0; j < map.rows; ++j) {
    for (int i = 0; i < map.columns; ++i) {
      Vec3f sum;
      float count = 0;
      for (const auto& [x, y] : shifts) {
        if (!map.knows(i + x, j + y)) continue;
        sum += map.value[map.index(i + x, j + y)];
        ++count;
      }
      if (count > 0) out[map.index(i, j)] = sum * (1 / count);
    }
  }
  return out;
}

}  // namespace aligngs
