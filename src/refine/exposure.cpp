#include "refine/exposure.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/median.h"
#include "core/srgb.h"
#include "refine/view_overlap.h"

namespace aligngs {
namespace {

/// Median log ratios of light, `from` over `to`.
struct PairRatio {
  size_t from = 0, to = 0;
  Vec3d log_ratio;
};

bool usable(const ExposureView& view, int x, int y) {
  return view.mask == nullptr || view.mask->empty() || view.mask->at(x, y) > 0;
}

/// The pixel of `to` that shows what pixel (x, y) of `from` shows.
std::optional<PixelIndex> same_surface(const ExposureView& from, int x, int y, const ExposureView& to,
                                       double agreement) {
  const float z = from.match->depth.at(x, y);
  if (!(z > 0) || !std::isfinite(z)) return {};
  const Vec3d place = from.match->camera.unproject(x + 0.5, y + 0.5, static_cast<double>(z));
  return pixel_showing(place, to.match->camera, to.match->depth, agreement);
}

std::optional<PairRatio> compare(const std::vector<ExposureView>& views, size_t from, size_t to,
                                 const ExposureSettings& s) {
  const ExposureView &a = views[from], &b = views[to];
  std::vector<double> ratios[3];
  for (int y = s.step / 2; y < a.color->height; y += s.step) {
    for (int x = s.step / 2; x < a.color->width; x += s.step) {
      if (!usable(a, x, y)) continue;
      const std::optional<PixelIndex> other = same_surface(a, x, y, b, s.depth_agreement);
      if (!other || !usable(b, other->x, other->y)) continue;
      for (int k = 0; k < 3; ++k) {
        const float mine = a.color->at(x, y, k), theirs = b.color->at(other->x, other->y, k);
        const double low = std::min(mine, theirs), high = std::max(mine, theirs);
        if (low < s.darkest || high > s.brightest) continue;
        ratios[k].push_back(
            std::log(static_cast<double>(srgb_decode(mine)) / static_cast<double>(srgb_decode(theirs))));
      }
    }
  }
  PairRatio out{from, to, {}};
  for (int k = 0; k < 3; ++k) {
    if (ratios[k].size() < static_cast<size_t>(s.least_samples)) return {};
    out.log_ratio[k] = median_of(ratios[k]);
    if (std::abs(out.log_ratio[k]) > 2 * s.largest) return {};
  }
  return out;
}

}  // namespace

std::vector<Vec3f> estimate_log_gains(const std::vector<ExposureView>& views, const ExposureSettings& settings,
                                      ThreadPool& pool) {
  std::vector<Vec3f> gains(views.size());
  if (views.size() < 2) return gains;
  std::vector<const MatchView*> photos;
  for (const ExposureView& view : views) photos.push_back(view.match);
  const std::vector<std::vector<int>> neighbours =
      overlapping_views(photos, photos, settings.neighbours + 1, settings.least_overlap, settings.largest_turn);
  std::vector<std::vector<PairRatio>> found(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      for (const int other : neighbours[i]) {
        const size_t j = static_cast<size_t>(other);
        if (j == i || views[j].match->depth.empty()) continue;
        if (const auto ratio = compare(views, i, j, settings)) found[i].push_back(*ratio);
      }
    }
  });
  const Eigen::Index n = static_cast<Eigen::Index>(views.size());
  Eigen::MatrixXd normal = settings.no_change * Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 3);
  for (const auto& ratios : found) {
    for (const PairRatio& r : ratios) {
      const Eigen::Index i = static_cast<Eigen::Index>(r.from), j = static_cast<Eigen::Index>(r.to);
      normal(i, i) += 1;
      normal(j, j) += 1;
      normal(i, j) -= 1;
      normal(j, i) -= 1;
      for (int k = 0; k < 3; ++k) {
        right(i, k) += r.log_ratio[k];
        right(j, k) -= r.log_ratio[k];
      }
    }
  }
  const Eigen::MatrixXd solution = normal.ldlt().solve(right);  // each column's sum is 0, because that of `right` is
  for (size_t i = 0; i < views.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      gains[i][k] = static_cast<float>(
          std::clamp(solution(static_cast<Eigen::Index>(i), k), -settings.largest, settings.largest));
    }
  }
  return gains;
}

}  // namespace aligngs
