#include "refine/depth_grid.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr int kNodes = DepthGrid::kColumns * DepthGrid::kRows;
constexpr int kGridRounds = 10;  // of reweighting; weights settle in fewer
constexpr double kHuber = 1.5;   // standard deviations

struct Weights {
  int node[4];
  double share[4];
};

Weights weights_at(double x, double y) {
  const double gx = std::clamp(x, 0.0, 1.0) * (DepthGrid::kColumns - 1),
               gy = std::clamp(y, 0.0, 1.0) * (DepthGrid::kRows - 1);
  const int x0 = std::min(static_cast<int>(gx), DepthGrid::kColumns - 2),
            y0 = std::min(static_cast<int>(gy), DepthGrid::kRows - 2);
  const double fx = gx - x0, fy = gy - y0;
  const int first = y0 * DepthGrid::kColumns + x0;
  return {{first, first + 1, first + DepthGrid::kColumns, first + DepthGrid::kColumns + 1},
          {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

using NodeMatrix = Eigen::Matrix<double, kNodes, kNodes>;
using NodeVector = Eigen::Matrix<double, kNodes, 1>;

/// Nodes near zero, and near their neighbours.
NodeMatrix regularisation(const DepthGridSettings& s) {
  NodeMatrix out = NodeMatrix::Identity() / (s.deviation * s.deviation);
  const double tie = 1 / (s.smoothness * s.smoothness);
  const auto join = [&](int a, int b) {
    out(a, a) += tie;
    out(b, b) += tie;
    out(a, b) -= tie;
    out(b, a) -= tie;
  };
  for (int r = 0; r < DepthGrid::kRows; ++r) {
    for (int c = 0; c < DepthGrid::kColumns; ++c) {
      const int i = r * DepthGrid::kColumns + c;
      if (c + 1 < DepthGrid::kColumns) join(i, i + 1);
      if (r + 1 < DepthGrid::kRows) join(i, i + DepthGrid::kColumns);
    }
  }
  return out;
}

}  // namespace

double DepthGrid::at(double x, double y) const {
  const Weights w = weights_at(x, y);
  double sum = 0;
  for (int k = 0; k < 4; ++k) sum += w.share[k] * log_factor[static_cast<size_t>(w.node[k])];
  return sum;
}

void DepthGrid::apply(ImageF& depth) const {
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      float& z = depth.at(x, y);
      if (z > 0 && std::isfinite(z))
        z *= static_cast<float>(std::exp(at((x + 0.5) / depth.width, (y + 0.5) / depth.height)));
    }
  }
}

DepthGrid fit_depth_grid(const std::vector<DepthGridSample>& samples, const DepthGridSettings& s) {
  DepthGrid grid;
  if (samples.size() < s.min_samples) return grid;
  const NodeMatrix prior = regularisation(s);
  for (int round = 0; round < kGridRounds; ++round) {
    NodeMatrix normal = prior;
    NodeVector right = NodeVector::Zero();
    for (const DepthGridSample& sample : samples) {
      if (!std::isfinite(sample.log_ratio)) continue;
      const double residual = std::abs(sample.log_ratio - grid.at(sample.x, sample.y)) / s.sigma;
      const double weight = (residual > kHuber ? kHuber / residual : 1.0) / (s.sigma * s.sigma);
      const Weights w = weights_at(sample.x, sample.y);
      for (int i = 0; i < 4; ++i) {
        right(w.node[i]) += weight * w.share[i] * sample.log_ratio;
        for (int j = 0; j < 4; ++j) normal(w.node[i], w.node[j]) += weight * w.share[i] * w.share[j];
      }
    }
    const NodeVector solution = normal.ldlt().solve(right);
    for (int i = 0; i < kNodes; ++i)
      grid.log_factor[static_cast<size_t>(i)] = std::clamp(solution(i), -s.limit, s.limit);
  }
  return grid;
}

}  // namespace aligngs
