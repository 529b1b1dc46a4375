#include "metrics/run_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/median.h"

namespace aligngs {
namespace {

/// Mean of the finite values.
class FiniteMean {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    sum_ += value;
    ++count_;
  }
  double value() const { return count_ ? sum_ / count_ : kUndefined; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

/// Mean of the views that have the figure; with `extrapolating`, of those that extrapolate or do not.
double mean_over_views(const std::vector<TestViewMetrics>& views, double TestViewMetrics::*figure,
                       std::optional<bool> extrapolating = {}) {
  FiniteMean mean;
  for (const TestViewMetrics& view : views) {
    if (!extrapolating || view.extrapolates == *extrapolating) mean.add(view.*figure);
  }
  return mean.value();
}

/// The same of a figure after the fit of the poses.
double mean_after_fit(const std::vector<TestViewMetrics>& views, double RefinedPoseMetrics::*figure) {
  FiniteMean mean;
  for (const TestViewMetrics& view : views) {
    if (view.pose_refined) mean.add((*view.pose_refined).*figure);
  }
  return mean.value();
}

double median_pose_error(const std::vector<TestViewMetrics>& views,
                         std::optional<PoseError> RefinedPoseMetrics::*when) {
  std::vector<double> values;
  for (const TestViewMetrics& view : views) {
    if (view.pose_refined && (*view.pose_refined).*when) values.push_back(((*view.pose_refined).*when)->metres);
  }
  return values.empty() ? kUndefined : median_of(std::move(values));
}

ViewGroupMetrics group_of(const std::vector<TestViewMetrics>& views, bool extrapolating) {
  ViewGroupMetrics group;
  group.psnr = mean_over_views(views, &TestViewMetrics::psnr, extrapolating);
  group.ssim = mean_over_views(views, &TestViewMetrics::ssim, extrapolating);
  group.views = static_cast<size_t>(std::count_if(
      views.begin(), views.end(), [&](const TestViewMetrics& view) { return view.extrapolates == extrapolating; }));
  return group;
}

}  // namespace

std::string protocol_text(const MeshProtocolResult& result) {
  if (result.stated) return *result.stated;
  return fmt::format("{}, {}, alignment: {}", word_of(result.protocol), word_of(result.culling),
                     word_of(result.alignment));
}

NovelViewMetrics novel_view_metrics(const std::vector<TestViewMetrics>& views, std::string lpips_note) {
  NovelViewMetrics means;
  means.psnr = mean_over_views(views, &TestViewMetrics::psnr);
  means.ssim = mean_over_views(views, &TestViewMetrics::ssim);
  means.lpips = mean_over_views(views, &TestViewMetrics::lpips);
  means.lpips_unit = mean_over_views(views, &TestViewMetrics::lpips_unit);
  means.psnr_exposure_fitted = mean_over_views(views, &TestViewMetrics::psnr_exposure_fitted);
  means.lpips_note = std::move(lpips_note);
  means.views = views.size();
  means.interpolating = group_of(views, false);
  means.extrapolating = group_of(views, true);
  if (std::any_of(views.begin(), views.end(), [](const auto& view) { return view.pose_refined.has_value(); })) {
    RefinedPoseSummary fitted;
    fitted.psnr = mean_after_fit(views, &RefinedPoseMetrics::psnr);
    fitted.ssim = mean_after_fit(views, &RefinedPoseMetrics::ssim);
    fitted.median_error_before = median_pose_error(views, &RefinedPoseMetrics::before);
    fitted.median_error_after = median_pose_error(views, &RefinedPoseMetrics::after);
    means.pose_refined = fitted;
  }
  return means;
}

double finer_fscore(const MeshScores& scores, double threshold) {
  constexpr double kSame = 1e-9;  // metres
  for (const ThresholdScores& finer : scores.finer) {
    if (std::abs(finer.threshold - threshold) < kSame) return finer.fscore;
  }
  return kUndefined;
}

}  // namespace aligngs
