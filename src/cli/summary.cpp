#include "cli/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

std::string value(double figure, const char* format) {
  return std::isfinite(figure) ? fmt::format(fmt::runtime(format), figure) : "–";
}

std::string novel_views(const RunMetrics& m) {
  if (!m.views_measured) return "novel views  left out\n";
  if (m.views.empty()) return "novel views  no test views\n";
  const auto mean = [&](double TestViewMetrics::*figure, const char* format) {
    return value(mean_over_views(m.views, figure), format);
  };
  const bool lpips = std::isfinite(mean_over_views(m.views, &TestViewMetrics::lpips));
  return fmt::format("novel views  PSNR {} dB (after colour fit {}, after pose fit {}), SSIM {}, {}{} test views\n",
                     mean(&TestViewMetrics::psnr, "{:.2f}"), mean(&TestViewMetrics::psnr_exposure_fitted, "{:.2f}"),
                     value(mean_over_views(m.views, &RefinedPoseMetrics::psnr), "{:.2f}"),
                     mean(&TestViewMetrics::ssim, "{:.3f}"),
                     lpips ? "LPIPS " + mean(&TestViewMetrics::lpips, "{:.3f}") +
                                 " (inputs in [0, 1]: " + mean(&TestViewMetrics::lpips_unit, "{:.3f}") + "), "
                           : "",
                     m.views.size());
}

/// F at one of the finer distances, in metres.
double finer_fscore(const MeshScores& scores, double threshold) {
  for (const ThresholdScores& finer : scores.finer) {
    if (std::abs(finer.threshold - threshold) < 1e-9) return finer.fscore;
  }
  return kUndefined;
}

std::string geometry(const RunMetrics& m) {
  if (!m.geometry) return "geometry     not measured: the scene has no true mesh\n";
  const MeshProtocolResult& headline = m.geometry->headline;
  const MeshScores& s = headline.scores;
  const SurfaceQuality& surface = m.geometry->surface;
  return fmt::format(
             "geometry     F {} at {} m (precision {}, recall {}), accuracy {} m, completeness {} m\n             "
             "[{}]\n",
             value(s.fscore, "{:.3f}"), value(s.threshold, "{:g}"), value(s.precision, "{:.3f}"),
             value(s.recall, "{:.3f}"), value(s.accuracy, "{:.4f}"), value(s.completeness, "{:.4f}"),
             protocol_text(headline)) +
         fmt::format(
             "surface      normals {} degrees off (median; walls, floor and ceiling {}), F {} at 2 cm, {} at 1 cm, "
             "pinholes {} %\n",
             value(surface.normal_error.median, "{:.1f}"), value(surface.structure_normal_error.median, "{:.1f}"),
             value(finer_fscore(s, 0.02), "{:.3f}"), value(finer_fscore(s, 0.01), "{:.3f}"),
             value(100 * surface.pinholes, "{:.2f}"));
}

std::string label_line(const char* name, double miou, double present, double accuracy, const char* samples) {
  return fmt::format(
      "{} mIoU {} over classes with at least {:g} % of the {}, {} over all classes present, accuracy {}\n", name,
      value(miou, "{:.3f}"), 100 * kLeastClassShare, samples, value(present, "{:.3f}"), value(accuracy, "{:.3f}"));
}

std::string label_line(const char* name, const SemanticScores& s, const char* samples) {
  return label_line(name, s.miou, s.present_miou, s.accuracy, samples);
}

std::string labels(const RunMetrics& m) {
  if (!m.semantics && !m.mesh_labels) return "labels       not measured: no semantics or no true labels\n";
  std::string text = m.semantics ? label_line("labels      ", *m.semantics, "pixels")
                                 : label_line("labels      ", kUndefined, kUndefined, kUndefined, "pixels");
  if (m.teacher) text += label_line("  teacher   ", *m.teacher, "pixels");
  if (m.mesh_labels) text += label_line("  mesh      ", m.mesh_labels->all, "points");
  return text;
}

}  // namespace

std::string metrics_summary(const RunMetrics& metrics) {
  std::string text = novel_views(metrics) + geometry(metrics) + labels(metrics);
  if (metrics.priors.find("simulated") != std::string::npos)
    text += "priors       simulated (" + metrics.priors + ")\n";
  return text;
}

}  // namespace aligngs
