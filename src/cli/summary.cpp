#include "cli/summary.h"

#include <fmt/format.h>

#include <cmath>

namespace aligngs {
namespace {

std::string value(double figure, const char* format) {
  return std::isfinite(figure) ? fmt::format(fmt::runtime(format), figure) : "–";
}

std::string novel_views(const RunMetrics& m) {
  if (!m.novel_views) return "novel views  left out\n";
  const NovelViewMetrics& means = *m.novel_views;
  if (means.views == 0) return "novel views  no test views\n";
  const double after_pose_fit = means.pose_refined ? means.pose_refined->psnr : kUndefined;
  return fmt::format("novel views  PSNR {} dB (after colour fit {}, after pose fit {}), SSIM {}, {}{} test views\n",
                     value(means.psnr, "{:.2f}"), value(means.psnr_exposure_fitted, "{:.2f}"),
                     value(after_pose_fit, "{:.2f}"), value(means.ssim, "{:.3f}"),
                     std::isfinite(means.lpips) ? "LPIPS " + value(means.lpips, "{:.3f}") +
                                                      " (inputs in [0, 1]: " + value(means.lpips_unit, "{:.3f}") + "), "
                                                : "",
                     means.views);
}

/// As of a run of somebody's own photos that all train.
bool nothing_to_measure(const RunMetrics& m) {
  return m.novel_views && m.novel_views->views == 0 && !m.geometry && !m.semantics && !m.mesh_labels;
}

std::string geometry(const RunMetrics& m) {
  if (!m.geometry) return "geometry     not measured: the run has no mesh, or the scene no true mesh\n";
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

std::string label_line(const char* name, const SemanticScores& s, const char* samples) {
  return fmt::format(
      "{} mIoU {} over classes with at least {:g} % of the {}, {} over all classes present, accuracy {}\n", name,
      value(s.miou, "{:.3f}"), 100 * kLeastClassShare, samples, value(s.present_miou, "{:.3f}"),
      value(s.accuracy, "{:.3f}"));
}

std::string labels(const RunMetrics& m) {
  if (!m.semantics && !m.mesh_labels) return "labels       not measured: no semantics or no true labels\n";
  std::string text = m.semantics ? label_line("labels      ", *m.semantics, "pixels")
                                 : "labels       no test views with true labels\n";
  if (m.teacher) text += label_line("  teacher   ", *m.teacher, "pixels");
  if (m.mesh_labels) text += label_line("  mesh      ", m.mesh_labels->all, "points");
  return text;
}

}  // namespace

std::string metrics_summary(const RunMetrics& metrics) {
  std::string text = nothing_to_measure(metrics)
                         ? "figures      none: no photo was kept for testing (--test-every 8 keeps some), and no true "
                           "mesh is known\n"
                         : novel_views(metrics) + geometry(metrics) + labels(metrics);
  if (metrics.priors.find("simulated") != std::string::npos)
    text += "priors       simulated (" + metrics.priors + ")\n";
  return text;
}

}  // namespace aligngs
