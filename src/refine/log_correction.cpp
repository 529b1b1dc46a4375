#include "refine/log_correction.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/is_depth.h"
#include "io/resample.h"
#include "refine/grid_gradients.h"

namespace aligngs {
namespace {

// of conjugate gradients; smoothing over 100 pixels needs about as many from nothing
constexpr int kSolverIterations = 300;
constexpr double kTolerance = 3e-4;  // relative residual: a hundredth of a correction that is some percent
constexpr int kSmallest = 16;        // pixels; a smaller problem is solved from nothing

/// The system to solve, at one resolution.
struct CorrectionLevel {
  ImageF depth, given, weight, luma;
  double none;  ///< LogCorrectionSettings::none of a pixel of this size
};

/// Half the resolution: what four pixels know together, on the depth of one of them, so that jumps stay jumps. The sum
/// of squared differences between neighbours is the same at every resolution; what belongs to single pixels adds up.
CorrectionLevel half_of(const CorrectionLevel& fine) {
  const int width = (fine.depth.width + 1) / 2, height = (fine.depth.height + 1) / 2;
  CorrectionLevel out{ImageF(width, height, 1), ImageF(width, height, 1), ImageF(width, height, 1), {}, 4 * fine.none};
  if (!fine.luma.empty()) out.luma = resize_area(fine.luma, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float weight = 0, sum = 0, depth = 0;
      for (int k = 0; k < 4; ++k) {
        const int u = 2 * x + (k & 1), v = 2 * y + (k >> 1);
        if (u >= fine.depth.width || v >= fine.depth.height || !is_depth(fine.depth.at(u, v))) continue;
        if (depth == 0) depth = fine.depth.at(u, v);
        const float w = fine.weight.at(u, v), g = fine.given.at(u, v);
        if (!(w > 0) || !std::isfinite(g)) continue;
        weight += w;
        sum += w * g;
      }
      out.depth.at(x, y) = depth;
      out.weight.at(x, y) = weight;
      out.given.at(x, y) = weight > 0 ? sum / weight : 0;
    }
  }
  return out;
}

/// Conjugate gradients on one level, from `guess` (the level's size) on.
ImageF solve_level(const CorrectionLevel& level, const ImageF& guess, const LogCorrectionSettings& settings) {
  const ImageF& depth = level.depth;
  const int width = depth.width, height = depth.height;
  const bool looks = settings.luma_edge > 0 && !level.luma.empty();
  ImageF out(width, height, 1);
  std::vector<int> unknown(depth.pixels(), -1);
  int count = 0;
  for (size_t i = 0; i < depth.pixels(); ++i) {
    if (is_depth(depth.data[i])) unknown[i] = count++;
  }
  if (count == 0) return out;

  const bool everywhere = static_cast<size_t>(count) == depth.pixels();  // unknown[i] is i then
  GridMatrix grid(everywhere ? width : 0, everywhere ? height : 0);
  std::vector<double> diagonal(static_cast<size_t>(count), level.none);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count), start(count);
  std::vector<Eigen::Triplet<double>> entries;
  if (!everywhere) entries.reserve(static_cast<size_t>(count) * 3);  // the lower half: itself and two neighbours
  const auto link = [&](size_t i, size_t j) {
    if (unknown[j] < 0) return;
    const float a = depth.data[i], b = depth.data[j];
    const bool jump = std::abs(a - b) > settings.depth_jump * std::min(a, b);
    double w = settings.smoothness * (jump ? settings.across_edge : 1);
    if (looks) {
      const double step = static_cast<double>(level.luma.data[i] - level.luma.data[j]) / settings.luma_edge;
      w *= std::max(settings.across_edge, 1 / (1 + step * step * step * step));
    }
    diagonal[static_cast<size_t>(unknown[i])] += w;
    diagonal[static_cast<size_t>(unknown[j])] += w;
    if (everywhere)
      (j == i + 1 ? grid.right : grid.lower)[i] = -w;
    else
      entries.emplace_back(unknown[j], unknown[i], -w);  // j comes after i
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      if (unknown[i] < 0) continue;
      start[unknown[i]] = static_cast<double>(guess.data[i]);
      const float w = level.weight.data[i];
      if (w > 0 && std::isfinite(level.given.data[i])) {
        diagonal[static_cast<size_t>(unknown[i])] += w;
        right[unknown[i]] = static_cast<double>(w) * level.given.data[i];
      }
      if (x + 1 < width) link(i, i + 1);
      if (y + 1 < height) link(i, i + static_cast<size_t>(width));
    }
  }
  if (everywhere) {
    grid.diagonal = std::move(diagonal);
    solve_on_grid(grid, right, kSolverIterations, kTolerance, start);
    for (size_t i = 0; i < depth.pixels(); ++i) out.data[i] = static_cast<float>(start[static_cast<Eigen::Index>(i)]);
    return out;
  }
  for (int i = 0; i < count; ++i) entries.emplace_back(i, i, diagonal[static_cast<size_t>(i)]);
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
  solver.setMaxIterations(kSolverIterations);
  solver.setTolerance(kTolerance);
  solver.compute(matrix);
  const Eigen::VectorXd solution = solver.solveWithGuess(right, start);
  for (size_t i = 0; i < depth.pixels(); ++i) {
    if (unknown[i] >= 0) out.data[i] = static_cast<float>(solution[unknown[i]]);
  }
  return out;
}

/// From the solution at half the resolution on: what is far away is known there after few iterations.
ImageF solve(const CorrectionLevel& level, const LogCorrectionSettings& settings) {
  const int width = level.depth.width, height = level.depth.height;
  ImageF guess(width, height, 1);
  if (std::min(width, height) > kSmallest) {
    const ImageF coarse = solve(half_of(level), settings);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) guess.at(x, y) = coarse.at(x / 2, y / 2);
    }
  }
  return solve_level(level, guess, settings);
}

}  // namespace

ImageF spread_log_correction(const ImageF& depth, const ImageF& given, const ImageF& weight,
                             const LogCorrectionSettings& settings, const ImageF& luma) {
  return solve({depth, given, weight, settings.luma_edge > 0 ? luma : ImageF(), settings.none}, settings);
}

}  // namespace aligngs
