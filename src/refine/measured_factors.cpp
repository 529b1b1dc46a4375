#include "refine/measured_factors.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "refine/fused_labels.h"

namespace aligngs {
namespace {

std::vector<StereoResult> measure_depth(const std::vector<MatchView>& photos, const RefineSceneOptions& options,
                                        ThreadPool& pool) {
  std::vector<const MatchView*> pointers;
  for (const MatchView& photo : photos) pointers.push_back(&photo);
  Progress progress(options.progress, "measure depth", photos.size());
  return guided_stereo(pointers, options.stereo_settings, pool, [&](double share) {
    progress.update(static_cast<uint64_t>(share * static_cast<double>(photos.size())));
  });
}

/// Log factors on the photos' depth: stereo's measurements and the planes of the room, each as sure as it is, spread
/// together.
MeasuredFactors factors_with_planes(const Scene& scene, const std::vector<MatchView>& photos,
                                    const std::vector<Image<uint16_t>>& labels, const std::vector<StereoResult>& stereo,
                                    const RefineSceneOptions& options, ThreadPool& pool, RefineSceneReport& report) {
  std::vector<PlaneView> views(photos.size());
  pool.parallel_for(photos.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      views[i].camera = photos[i].camera;
      views[i].depth = photos[i].depth;
      for (size_t p = 0; p < stereo[i].log_factor.data.size(); ++p)
        views[i].depth.data[p] *= std::exp(stereo[i].log_factor.data[p]);
      views[i].certainty = stereo[i].certainty;
      views[i].labels = labels[i];
    }
  });
  if (options.fuse_labels) {
    std::vector<FusedLabels> fused = fuse_labels(views, {}, pool);
    for (size_t i = 0; i < views.size(); ++i) {
      views[i].labels = std::move(fused[i].labels);
      views[i].label_share = std::move(fused[i].share);
    }
  }
  const std::vector<PlaneClass> plane_labels = plane_classes(scene.labels, options.surfaces);
  PlaneDepthResult planes = measure_planes(views, plane_labels, options.plane_settings, pool);
  if (options.panels) {
    const std::vector<PanelClass> classes = panel_classes(scene.labels);
    std::vector<const ImageF*> lumas;
    for (const MatchView& photo : photos) lumas.push_back(&photo.luma);
    report.panels = find_panels(views, classes, planes.planes, options.panel_settings);
    if (options.screen_settings.enabled)
      report.panels =
          place_screens(views, lumas, classes, planes.planes, std::move(report.panels), options.screen_settings, pool);
    measure_on_panels(report.panels, planes.planes, views, classes, options.panel_settings, pool, planes.views);
  }
  if (options.stereo)
    try_planes(photos, views, plane_labels, planes.planes, options.plane_settings, options.stereo_settings,
               options.hypothesis_settings, pool, planes.views);
  report.planes = planes.planes;
  report.axes = planes.axes;
  report.on_planes = planes.share;
  MeasuredFactors factors{std::vector<ImageF>(photos.size()), std::vector<ImageF>(photos.size())};
  pool.parallel_for(photos.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const StereoResult& own = stereo[i];
      const PlaneMeasurement& plane = planes.views[i];
      ImageF given(plane.weight.width, plane.weight.height, 1), weight = plane.weight;
      for (size_t p = 0; p < weight.data.size(); ++p) {
        const float certainty = own.certainty.empty() ? 0 : own.certainty.data[p],
                    spread = own.log_factor.empty() ? 0 : own.log_factor.data[p];
        weight.data[p] += certainty;
        if (weight.data[p] <= 0) continue;
        const float measured = certainty > 0 ? certainty * own.own_factor.data[p] : 0;
        given.data[p] = (measured + plane.weight.data[p] * (spread + plane.log_factor.data[p])) / weight.data[p];
      }
      factors.log_factors[i] = spread_log_correction(photos[i].depth, given, weight, options.stereo_settings.spread);
      factors.certainty[i] = std::move(weight);
    }
  });
  return factors;
}

}  // namespace

bool uses_planes(const Scene& scene, const RefineSceneOptions& options) {
  return options.correct_depth && options.planes && scene.has_semantics();
}

MeasuredFactors measured_factors(const Scene& scene, const std::vector<MatchView>& photos,
                                 const std::vector<Image<uint16_t>>& labels, const RefineSceneOptions& options,
                                 ThreadPool& pool, RefineSceneReport& report) {
  std::vector<StereoResult> stereo(photos.size());
  if (options.stereo) stereo = measure_depth(photos, options, pool);
  report.measured = 0;
  for (const StereoResult& result : stereo) report.measured += result.measured / static_cast<double>(photos.size());
  if (uses_planes(scene, options)) return factors_with_planes(scene, photos, labels, stereo, options, pool, report);
  MeasuredFactors factors;
  for (StereoResult& result : stereo) {
    factors.log_factors.push_back(std::move(result.log_factor));
    factors.certainty.push_back(std::move(result.certainty));
  }
  return factors;
}

}  // namespace aligngs
