#include "refine/log_correction.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <cmath>

namespace aligngs {
namespace {

constexpr int kIterations = 300;    // of conjugate gradients; smoothing over 100 pixels needs about as many
constexpr double kTolerance = 1e-4; // relative residual: thousandths of a correction that is some percent

bool is_depth(float z) { return z > 0 && std::isfinite(z); }

}  // namespace

ImageF spread_log_correction(const ImageF& depth, const ImageF& given, const ImageF& weight, const LogCorrectionSettings& settings) {
  const int width = depth.width, height = depth.height;
  ImageF out(width, height, 1);
  std::vector<int> unknown(depth.pixels(), -1);
  int count = 0;
  for (size_t i = 0; i < depth.pixels(); ++i) {
    if (is_depth(depth.data[i])) unknown[i] = count++;
  }
  if (count == 0) return out;

  std::vector<double> diagonal(static_cast<size_t>(count), settings.none);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<size_t>(count) * 3);  // the lower half: itself and two neighbours
  const auto link = [&](size_t i, size_t j) {
    if (unknown[j] < 0) return;
    const float a = depth.data[i], b = depth.data[j];
    const bool jump = std::abs(a - b) > settings.depth_jump * std::min(a, b);
    const double w = settings.smoothness * (jump ? settings.across_edge : 1);
    diagonal[static_cast<size_t>(unknown[i])] += w;
    diagonal[static_cast<size_t>(unknown[j])] += w;
    entries.emplace_back(unknown[j], unknown[i], -w);  // j comes after i
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      if (unknown[i] < 0) continue;
      const float w = weight.data[i];
      if (w > 0 && std::isfinite(given.data[i])) {
        diagonal[static_cast<size_t>(unknown[i])] += w;
        right[unknown[i]] = static_cast<double>(w) * given.data[i];
      }
      if (x + 1 < width) link(i, i + 1);
      if (y + 1 < height) link(i, i + static_cast<size_t>(width));
    }
  }
  for (int i = 0; i < count; ++i) entries.emplace_back(i, i, diagonal[static_cast<size_t>(i)]);
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
  solver.setMaxIterations(kIterations);
  solver.setTolerance(kTolerance);
  solver.compute(matrix);
  const Eigen::VectorXd solution = solver.solve(right);
  for (size_t i = 0; i < depth.pixels(); ++i) {
    if (unknown[i] >= 0) out.data[i] = static_cast<float>(solution[unknown[i]]);
  }
  return out;
}

}  // namespace aligngs
