#include "refine/labelled_depth.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

enum class Keep { kSure, kUnsure, kAll };

/// The photos with the depth of some of their pixels.
std::vector<PlaneView> with_depth(const std::vector<MatchView>& views, const std::vector<Image<uint16_t>>& labels,
                                  const std::vector<PhotoDepth>& depths, Keep keep) {
  std::vector<PlaneView> out(views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    out[i].camera = views[i].camera;
    if (depths[i].depth.empty()) continue;
    out[i].depth = depths[i].depth;
    out[i].certainty = depths[i].certainty;
    out[i].labels = labels[i];
    for (size_t p = 0; p < out[i].depth.data.size(); ++p) {
      const bool sure = out[i].certainty.data[p] > 0;
      if (keep == (sure ? Keep::kUnsure : Keep::kSure)) out[i].depth.data[p] = 0;
    }
  }
  return out;
}

/// Both in one: a pixel is either sure or not.
PlaneMeasurement merged(PlaneMeasurement sure, const PlaneMeasurement& unsure) {
  for (size_t p = 0; p < sure.weight.data.size(); ++p) {
    if (unsure.weight.data[p] <= 0) continue;
    sure.log_factor.data[p] = unsure.log_factor.data[p];
    sure.weight.data[p] = unsure.weight.data[p];
    sure.plane.data[p] = unsure.plane.data[p];
  }
  return sure;
}

}  // namespace

KnownSurfaces known_surfaces(const std::vector<MatchView>& views, const std::vector<Image<uint16_t>>& labels,
                             const std::vector<PhotoDepth>& depths, const LabelledDepthReport& report,
                             const FlatClasses& classes, const LabelledDepthSettings& settings, ThreadPool& pool) {
  return known_surfaces(with_depth(views, labels, depths, Keep::kAll), {report.planes, report.axes, report.panels},
                        classes, {settings.sure, settings.panels}, pool);
}

LabelledDepthReport lay_on_planes(const std::vector<MatchView>& views, const std::vector<Image<uint16_t>>& labels,
                                  const FlatClasses& classes, const LabelledDepthSettings& settings, ThreadPool& pool,
                                  std::vector<PhotoDepth>& depths) {
  LabelledDepthReport report;
  const std::vector<PlaneView> confirmed = with_depth(views, labels, depths, Keep::kSure);
  PlaneDepthResult sure = measure_planes(confirmed, classes.planes, settings.sure, pool);
  report.planes = sure.planes;
  report.axes = sure.axes;
  const std::vector<PlaneView> all = with_depth(views, labels, depths, Keep::kAll);
  std::vector<const ImageF*> lumas;
  for (const MatchView& view : views) lumas.push_back(&view.luma);
  report.panels = find_panels(confirmed, classes.panels, report.planes, settings.panels);
  if (settings.screens.enabled)
    report.panels =
        place_screens(all, lumas, classes.panels, report.planes, std::move(report.panels), settings.screens, pool);
  if (report.planes.empty() && report.panels.empty()) return report;
  const auto unsure = measure_on_planes(report.planes, with_depth(views, labels, depths, Keep::kUnsure), classes.planes,
                                        settings.unsure, pool);
  std::vector<PlaneMeasurement> flat;
  for (size_t i = 0; i < views.size(); ++i) flat.push_back(merged(std::move(sure.views[i]), unsure[i]));
  measure_on_panels(report.panels, report.planes, all, classes.panels, settings.panels, pool, flat);
  std::vector<size_t> on_planes(views.size(), 0);
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      PhotoDepth& depth = depths[i];
      if (depth.depth.empty()) continue;
      const PlaneMeasurement& plane = flat[i];
      ImageF given(plane.weight.width, plane.weight.height, 1), weight = plane.weight;
      for (size_t p = 0; p < weight.data.size(); ++p) {
        weight.data[p] += depth.certainty.data[p];
        if (weight.data[p] > 0) given.data[p] = plane.weight.data[p] * plane.log_factor.data[p] / weight.data[p];
        if (plane.weight.data[p] <= 0) continue;
        ++on_planes[i];
        depth.certainty.data[p] = std::max(depth.certainty.data[p], static_cast<float>(settings.certainty));
      }
      move_depth(given, weight, settings.spread, views[i].luma, depth);
    }
  });
  report.on_planes = share_of_pixels(on_planes, depths);
  return report;
}

}  // namespace aligngs
