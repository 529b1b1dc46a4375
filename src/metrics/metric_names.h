// The numbers of metrics.json with their names: one list for the writer, the reader and --fail-under. Each function
// calls number(name, value) for the numbers of a part; `value` is what was passed, const or not.
#pragma once

#include <cmath>
#include <string>

namespace aligngs {

template <class ViewPart, class Number>
void each_view_number(ViewPart& view, Number&& number) {  // TestViewMetrics
  number("psnr", view.psnr);
  number("ssim", view.ssim);
  number("lpips", view.lpips);
  number("lpips_unit", view.lpips_unit);
  number("psnr_exposure_fitted", view.psnr_exposure_fitted);
  number("label_accuracy", view.label_accuracy);
}

template <class FitPart, class Number>
void each_refined_pose_number(FitPart& fit, Number&& number) {  // RefinedPoseMetrics
  number("psnr", fit.psnr);
  number("ssim", fit.ssim);
  number("shift", fit.shift);
  number("turn_degrees", fit.turn_degrees);
}

template <class ErrorPart, class Number>
void each_pose_error_number(ErrorPart& error, Number&& number) {  // PoseError
  number("metres", error.metres);
  number("degrees", error.degrees);
}

template <class MeanPart, class Number>
void each_novel_view_number(MeanPart& means, Number&& number) {  // NovelViewMetrics
  number("psnr", means.psnr);
  number("ssim", means.ssim);
  number("lpips", means.lpips);
  number("lpips_unit", means.lpips_unit);
  number("views", means.views);
}

template <class GroupPart, class Number>
void each_view_group_number(GroupPart& group, Number&& number) {  // ViewGroupMetrics
  number("psnr", group.psnr);
  number("ssim", group.ssim);
  number("views", group.views);
}

template <class FitPart, class Number>
void each_refined_summary_number(FitPart& fit, Number&& number) {  // RefinedPoseSummary
  number("psnr", fit.psnr);
  number("ssim", fit.ssim);
  number("median_error_before_m", fit.median_error_before);
  number("median_error_after_m", fit.median_error_after);
}

template <class MeshPart, class Number>
void each_mesh_number(MeshPart& result, Number&& number) {  // MeshProtocolResult
  number("accuracy", result.scores.accuracy);
  number("completeness", result.scores.completeness);
  number("precision", result.scores.precision);
  number("recall", result.scores.recall);
  number("fscore", result.scores.fscore);
  number("threshold_m", result.scores.threshold);
  number("camera_rmse_m", result.alignment_report.camera_rmse);
  number("truth_area_m2", result.truth_area);
}

/// "_2cm" for a distance of 0.02 m.
inline std::string finer_suffix(double threshold) { return "_" + std::to_string(std::lround(100 * threshold)) + "cm"; }

template <class FinerPart, class Number>
void each_finer_number(FinerPart& finer, Number&& number) {  // ThresholdScores, by its threshold
  const std::string suffix = finer_suffix(finer.threshold);
  number("precision" + suffix, finer.precision);
  number("recall" + suffix, finer.recall);
  number("fscore" + suffix, finer.fscore);
}

template <class SurfacePart, class Number>
void each_surface_number(SurfacePart& surface, Number&& number) {  // SurfaceQuality; angles in degrees
  number("normal_error_mean_deg", surface.normal_error.mean);
  number("normal_error_median_deg", surface.normal_error.median);
  number("structure_normal_error_mean_deg", surface.structure_normal_error.mean);
  number("structure_normal_error_median_deg", surface.structure_normal_error.median);
  number("roughness_mean_deg", surface.roughness.mean);
  number("roughness_median_deg", surface.roughness.median);
  number("pinholes", surface.pinholes);
  number("structure_pinholes", surface.structure_pinholes);
  number("truth_seen_m2", surface.truth_seen);
}

template <class ScorePart, class Number>
void each_semantic_number(ScorePart& scores, Number&& number) {  // SemanticScores: classes that count
  number("miou", scores.miou);
  number("accuracy", scores.accuracy);
  number("classes", scores.classes);
  number("samples", scores.samples);
}

template <class ScorePart, class Number>
void each_present_number(ScorePart& scores, Number&& number) {  // SemanticScores: all classes of the truth
  number("miou", scores.present_miou);
  number("classes", scores.present_classes);
}

template <class ScorePart, class Number>
void each_mesh_label_number(ScorePart& scores, Number&& number) {  // MeshLabelScores
  number("coverage", scores.coverage);
  number("covered_miou", scores.covered.miou);
}

template <class TrainPart, class Number>
void each_training_number(TrainPart& train, Number&& number) {  // TrainingMetrics
  number("seconds", train.seconds);
  number("iterations", train.iterations);
  number("gaussians", train.gaussians);
  number("iterations_per_second", train.iterations_per_second);
  number("peak_memory_bytes", train.peak_memory_bytes);
}

}  // namespace aligngs
