#include "synth/acceptance.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "synth/acceptance_measures.h"

namespace aligngs {

bool AcceptanceReport::accepted() const {
  for (const AcceptanceFigure& f : figures) {
    if (!f.accepted()) return false;
  }
  return true;
}

double AcceptanceReport::value(const std::string& name) const {
  for (const AcceptanceFigure& f : figures) {
    if (f.name == name) return f.value;
  }
  throw Error({ErrorKind::kFailed, "no acceptance figure is named '" + name + "'", {}, {}, {}});
}

std::string AcceptanceReport::table() const {
  std::string out = fmt::format("{}\n", teacher);
  for (const AcceptanceFigure& f : figures) {
    std::string range = "-";
    if (f.low && f.high)
      range = fmt::format("{:g} to {:g}", *f.low, *f.high);
    else if (f.low)
      range = fmt::format(">= {:g}", *f.low);
    else if (f.high)
      range = fmt::format("<= {:g}", *f.high);
    out += fmt::format("  {:<34} {:>8.3f} {:<4} {:<14} {}\n", f.name, f.value, f.unit, range,
                       f.low || f.high ? (f.accepted() ? "ok" : "outside") : "");
  }
  if (published) {
    out += fmt::format(
        "  published for {}, mean of 19 data sets: AUC at 30 degrees {:.3f}, AbsRel of depth {:.3f}\n"
        "  (these include outdoor scenes and failures; the level keeps the ratios to VGGT-1B)\n",
        published->network, published->auc_30, published->abs_rel);
  }
  if (published_panoptic_quality) {
    out += fmt::format("  published for EoMT-L panoptic 640 on ADE20K: panoptic quality {:.3f}\n",
                       *published_panoptic_quality);
  }
  return out;
}

AcceptanceReport mean_acceptance(const std::vector<AcceptanceReport>& reports) {
  AcceptanceReport mean;
  if (reports.empty()) return mean;
  mean.teacher = reports[0].teacher;
  mean.published = reports[0].published;
  mean.published_panoptic_quality = reports[0].published_panoptic_quality;
  for (AcceptanceFigure figure : reports[0].figures) {
    double sum = 0;
    size_t found = 0;
    for (const AcceptanceReport& report : reports) {
      for (const AcceptanceFigure& f : report.figures) {
        if (f.name == figure.name) sum += f.value, ++found;
      }
    }
    if (found != reports.size()) continue;
    figure.value = sum / static_cast<double>(reports.size());
    mean.figures.push_back(figure);
  }
  return mean;
}

AcceptanceReport measure_acceptance(const SynthScene& scene, ThreadPool& pool) {
  AcceptanceReport report;
  const SynthOptions& o = scene.options;
  report.teacher = geometry_teacher_name(o) + ", " + semantic_teacher_name(o);
  if (const std::string segments = segment_teacher_name(o); !segments.empty()) report.teacher += ", " + segments;
  if (o.segments == SegmentTeacher::kTeacher && o.teacher == TeacherKind::kSimulated)
    report.published_panoptic_quality = kEomtPanopticQuality;
  const bool sensor = o.depth_teacher == DepthTeacher::kSensor;
  const bool ranges = o.teacher == TeacherKind::kSimulated && o.level == TeacherLevel::kMedium && !sensor;
  if (o.teacher == TeacherKind::kSimulated && !sensor) report.published = published_geometry(o.level);
  const auto add = [&](const char* name, double value, const char* unit, std::optional<double> low = {},
                       std::optional<double> high = {}, bool always = false) {
    if (!ranges && !always) low.reset(), high.reset();
    report.figures.push_back({name, value, unit, low, high});
  };
  const FusedPointFigures points = measure_fused_points(scene, pool);
  add("point accuracy mean", 100 * points.accuracy_mean, "cm", 3.0, 4.5);
  add("point accuracy median", 100 * points.accuracy_median, "cm", 1.5, 2.8);
  add("point completeness mean, few views", 100 * points.few_view_completeness, "cm", 4.0, 6.0);
  add("point accuracy mean, few views", 100 * points.few_view_accuracy, "cm");
  add("point completeness mean, all views", 100 * points.completeness_mean, "cm");
  add("point accuracy mean, on cameras", 100 * points.accuracy_on_cameras, "cm");
  const PoseFigures poses = measure_pair_poses(scene);
  add("pair pose error mean (max 3)", poses.clipped_mean, "deg", 1.0, 1.5);
  add("pair pose error mean, unclipped", poses.mean, "deg");
  add("pair pose AUC at 30 degrees", poses.auc_30, "");
  add("focal error", 100 * poses.focal, "%");
  if (o.teacher == TeacherKind::kSimulated) {
    add("confidence rank correlation", measure_confidence(scene), "", 0.4, 0.6);
    const MonoFigures mono = measure_mono_depth(scene);
    add("mono depth RMSE", mono.rmse, "m", 0.28, 0.36);
    add("mono depth Pearson", mono.pearson, "", 0.94, 0.98);
  }
  const SemanticFigures semantic = measure_semantics(scene, pool);
  add("semantic pixel accuracy", semantic.accuracy, "", 0.84, 0.90);
  add("semantic mIoU", semantic.miou, "", 0.52, 0.62);
  add("semantic edge-band accuracy", semantic.edge_accuracy, "", 0.55, 0.70);
  add("wrong pixels wrong in most views", semantic.persistent_share, "", 0.60);
  if (o.segments != SegmentTeacher::kNone) add("panoptic quality", measure_panoptic(scene), "", 0.45, 0.56);
  const CoverageFigures coverage = measure_coverage(scene, pool);
  add("bare surface share", scene.bare_share, "", 0.30, {}, true);
  add("test pixels seen in training", coverage.test_seen, "", kSeenShare, {}, true);
  add("training pixels seen twice", coverage.seen_twice, "");
  return report;
}

}  // namespace aligngs
