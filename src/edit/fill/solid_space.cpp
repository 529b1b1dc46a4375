#include "edit/fill/solid_space.h"

#include <algorithm>
#include <cmath>

#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr int kMostCubes = 256;    ///< per side: 16 MB in all
constexpr int kBlock = 4;          ///< cubes along the edge of a block
constexpr double kOwnCubes = 2.5;  ///< before the place: a surface seen at a slant does not hide itself

/// Places of a Gaussian's disc, at most half a cube apart: a surface of few large Gaussians has no gaps for a ray.
void add_disc(const GaussianModel& model, size_t row, double cube, std::vector<Vec3d>& points) {
  constexpr double kSpan = 1.0;  // standard deviations
  constexpr int kMostSteps =
      6;  // on either side of the middle: larger Gaussians are blurs of a surface nobody saw well
  const float* q = &model.rotations[4 * row];
  const Mat3d axes = rotation_matrix(normalized(Quaterniond{q[0], q[1], q[2], q[3]}));
  const Vec3d centre = position_of(model, row);
  int steps[3];
  for (int a = 0; a < 3; ++a) {
    const double span = kSpan * std::exp(static_cast<double>(model.log_scales[3 * row + static_cast<size_t>(a)]));
    steps[a] = std::min(kMostSteps, static_cast<int>(span / (0.5 * cube)));
  }
  for (int i = -steps[0]; i <= steps[0]; ++i) {
    for (int j = -steps[1]; j <= steps[1]; ++j) {
      for (int k = -steps[2]; k <= steps[2]; ++k)
        points.push_back(centre + axes * (Vec3d{1.0 * i, 1.0 * j, 1.0 * k} * (0.5 * cube)));
    }
  }
}

}  // namespace

SolidSpace::SolidSpace(const GaussianModel& model, const std::vector<uint8_t>& selected, double cube) : cube_(cube) {
  std::vector<Vec3d> points;
  Vec3d high{-1e300, -1e300, -1e300};
  low_ = {1e300, 1e300, 1e300};
  for (size_t i = 0; i < selected.size(); ++i) {
    if (!selected[i] || opacity_of(model, i) < kSolidOpacity) continue;
    add_disc(model, i, cube, points);
  }
  for (const Vec3d& p : points) {
    for (int a = 0; a < 3; ++a) {
      low_[a] = std::min(low_[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  if (points.empty()) return;
  for (int a = 0; a < 3; ++a) cube_ = std::max(cube_, (high[a] - low_[a]) / (kMostCubes - 1));
  for (int a = 0; a < 3; ++a) counts_[a] = static_cast<int>((high[a] - low_[a]) / cube_) + 1;
  filled_.assign(static_cast<size_t>(counts_[0]) * static_cast<size_t>(counts_[1]) * static_cast<size_t>(counts_[2]),
                 0);
  for (const Vec3d& p : points) {
    size_t at = 0;
    for (int a = 0; a < 3; ++a)
      at = at * static_cast<size_t>(counts_[a]) + static_cast<size_t>((p[a] - low_[a]) / cube_);
    filled_[at] = 1;
  }
  find_clear_blocks();
}

void SolidSpace::find_clear_blocks() {
  const auto index = [&](int i, int j, int k) {
    return (static_cast<size_t>(i) * static_cast<size_t>(blocks_[1]) + static_cast<size_t>(j)) *
               static_cast<size_t>(blocks_[2]) +
           static_cast<size_t>(k);
  };
  for (int a = 0; a < 3; ++a) blocks_[a] = (counts_[a] - 1) / kBlock + 1;
  clear_.assign(static_cast<size_t>(blocks_[0]) * static_cast<size_t>(blocks_[1]) * static_cast<size_t>(blocks_[2]), 1);
  size_t at = 0;
  for (int x = 0; x < counts_[0]; ++x) {
    for (int y = 0; y < counts_[1]; ++y) {
      for (int z = 0; z < counts_[2]; ++z) {
        if (!filled_[at++]) continue;
        const int i = x / kBlock, j = y / kBlock, k = z / kBlock;
        for (int u = std::max(0, i - 1); u <= std::min(i + 1, blocks_[0] - 1); ++u) {
          for (int v = std::max(0, j - 1); v <= std::min(j + 1, blocks_[1] - 1); ++v) {
            for (int w = std::max(0, k - 1); w <= std::min(k + 1, blocks_[2] - 1); ++w) clear_[index(u, v, w)] = 0;
          }
        }
      }
    }
  }
}

bool SolidSpace::hides(const Vec3d& eye, const Vec3d& place) const {
  if (empty()) return false;
  // Only the part of the segment within the box of the space matters (slab test).
  constexpr double kParallel = 1e-12;  // scene units
  double from = 0, to = 1;
  const Vec3d d = place - eye;
  for (int a = 0; a < 3; ++a) {
    const double low = low_[a], high = low_[a] + counts_[a] * cube_;
    if (std::fabs(d[a]) < kParallel) {
      if (eye[a] < low || eye[a] > high) return false;
      continue;
    }
    const double t0 = (low - eye[a]) / d[a], t1 = (high - eye[a]) / d[a];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  const double length = norm(d);
  if (length < cube_) return false;
  to = std::min(to, 1 - kOwnCubes * cube_ / length);
  const double step = 0.5 * cube_ / length;
  for (double t = from; t <= to; t += step) {
    size_t at = 0, block = 0;
    bool within = true;
    for (int a = 0; a < 3; ++a) {
      const double cubes = (eye[a] + d[a] * t - low_[a]) / cube_;
      within = within && cubes >= 0 && cubes < counts_[a];
      if (!within) break;
      const int cube = static_cast<int>(cubes);
      at = at * static_cast<size_t>(counts_[a]) + static_cast<size_t>(cube);
      block = block * static_cast<size_t>(blocks_[a]) + static_cast<size_t>(cube / kBlock);
    }
    if (!within) continue;
    if (filled_[at]) return true;
    // No step is longer than half a cube, so that the next ones stay in this block and those beside it.
    for (int skipped = 0; clear_[block] && skipped < 2 * kBlock - 1; ++skipped) t += step;
  }
  return false;
}

}  // namespace aligngs
