#include "refine/guided_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "refine/patch.h"

namespace aligngs {
namespace {

constexpr int kCoarseStep = 2;  // pixels of the first search (every_second); corners are some pixels wide

/// Top of a parabola through three scores, in steps from the middle one.
double parabola_top(double left, double middle, double right) {
  const double curvature = left - 2 * middle + right;
  return curvature < 0 ? std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5) : 0;
}

/// Scores around the best place of the coarse search, a row at a time when one of it is asked for.
class NearScores {
 public:
  NearScores(const ShiftedScores& scores, int dx, int dy) : scores_(scores), left_(dx - kReach), top_(dy - kReach) {}

  double at(int dx, int dy) {
    const size_t row = static_cast<size_t>(dy - top_);
    if (!known_[row]) scores_.row(left_, kWidth, dy, rows_[row].data());
    known_[row] = true;
    return rows_[row][static_cast<size_t>(dx - left_)];
  }

 private:
  static constexpr int kReach = kCoarseStep + 1;  // the best place moves that often, and its neighbours are looked at
  static constexpr int kWidth = 2 * kReach + 1;
  const ShiftedScores& scores_;
  int left_, top_;
  std::array<std::array<double, kWidth>, kWidth> rows_;
  std::array<bool, kWidth> known_{};
};

}  // namespace

std::optional<Match> guided_match(const MatchView& from, int x, int y, const MatchView& to, const MatchSettings& s) {
  const std::optional<Patch> patch = carry_over(from, x, y, to, s);
  if (!patch) return {};
  const int reach = std::max(2, static_cast<int>(std::lround(s.search * to.luma.width)));
  struct Place {
    double score;
    int dx, dy;
  };
  const ShiftedScores scores(*patch, to.luma);
  std::vector<Place> coarse;
  const std::vector<double> square = scores.every_second(reach);
  coarse.reserve(square.size());
  for (int dy = -reach; dy <= reach; dy += kCoarseStep) {
    for (int dx = -reach; dx <= reach; dx += kCoarseStep) coarse.push_back({square[coarse.size()], dx, dy});
  }
  Place best =
      *std::max_element(coarse.begin(), coarse.end(), [](const Place& a, const Place& b) { return a.score < b.score; });
  if (best.score < 0.5 * s.least_score) return {};
  NearScores near(scores, best.dx, best.dy);
  for (int round = 0; round < kCoarseStep; ++round) {  // the top may lie a step beyond the coarse grid's best
    const Place middle = best;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const double score = near.at(middle.dx + dx, middle.dy + dy);
        if (score > best.score) best = {score, middle.dx + dx, middle.dy + dy};
      }
    }
  }
  if (best.score < s.least_score) return {};
  if (std::abs(best.dx) >= reach || std::abs(best.dy) >= reach) return {};  // the true place may lie outside
  for (const Place& other : coarse) {
    if (std::max(std::abs(other.dx - best.dx), std::abs(other.dy - best.dy)) < s.elsewhere) continue;
    if (other.score > best.score - s.least_margin) return {};
  }
  std::array<double, 9> around;  // the best place in the middle, row by row
  for (int i = 0; i < 9; ++i)
    around[static_cast<size_t>(i)] = i == 4 ? best.score : near.at(best.dx + i % 3 - 1, best.dy + i / 3 - 1);
  // at the photo's border: so it may here
  if (std::find(around.begin(), around.end(), ShiftedScores::kOutside) != around.end()) return {};
  Match match;
  match.score = best.score;
  match.covariance = match_covariance(around, patch->value.size());
  match.pixel = {patch->centre.x + best.dx + parabola_top(around[3], best.score, around[5]),
                 patch->centre.y + best.dy + parabola_top(around[1], best.score, around[7])};
  return match;
}

}  // namespace aligngs
