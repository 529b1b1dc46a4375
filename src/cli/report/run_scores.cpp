#include "cli/report/run_scores.h"

#include <fmt/format.h>

#include <cmath>

#include "cli/folder_kind.h"
#include "core/error.h"
#include "metrics/metrics_json.h"

namespace aligngs {

namespace {

double views(const RunMetrics& m, double NovelViewMetrics::*figure) {
  return m.novel_views ? (*m.novel_views).*figure : kUndefined;
}

double group_psnr(const RunMetrics& m, std::optional<ViewGroupMetrics> NovelViewMetrics::*group) {
  return m.novel_views && (*m.novel_views).*group ? ((*m.novel_views).*group)->psnr : kUndefined;
}

double mesh(const RunMetrics& m, double MeshScores::*figure) {
  return m.geometry ? m.geometry->headline.scores.*figure : kUndefined;
}

}  // namespace

const std::array<ScoreColumn, kScoreCount>& score_columns() {
  static constexpr std::array<ScoreColumn, kScoreCount> kColumns = {{
      {"PSNR (dB)", "psnr", [](const RunMetrics& m) { return views(m, &NovelViewMetrics::psnr); }, 2},
      {"after colour fit", "psnr_fitted",
       [](const RunMetrics& m) { return views(m, &NovelViewMetrics::psnr_exposure_fitted); }, 2},
      {"after pose fit", "psnr_pose",
       [](const RunMetrics& m) {
         return m.novel_views && m.novel_views->pose_refined ? m.novel_views->pose_refined->psnr : kUndefined;
       },
       2},
      {"between", "psnr_interpolating",
       [](const RunMetrics& m) { return group_psnr(m, &NovelViewMetrics::interpolating); }, 2},
      {"beyond", "psnr_extrapolating",
       [](const RunMetrics& m) { return group_psnr(m, &NovelViewMetrics::extrapolating); }, 2},
      {"SSIM", "ssim", [](const RunMetrics& m) { return views(m, &NovelViewMetrics::ssim); }, 3},
      {"LPIPS", "lpips", [](const RunMetrics& m) { return views(m, &NovelViewMetrics::lpips); }, 3},
      {"Acc (m)", "accuracy", [](const RunMetrics& m) { return mesh(m, &MeshScores::accuracy); }, 4},
      {"Comp (m)", "completeness", [](const RunMetrics& m) { return mesh(m, &MeshScores::completeness); }, 4},
      {"Prec", "precision", [](const RunMetrics& m) { return mesh(m, &MeshScores::precision); }, 3},
      {"Recall", "recall", [](const RunMetrics& m) { return mesh(m, &MeshScores::recall); }, 3},
      {"F", "fscore", [](const RunMetrics& m) { return mesh(m, &MeshScores::fscore); }, 3},
      {"F at 2 cm", "fscore_2cm",
       [](const RunMetrics& m) { return m.geometry ? finer_fscore(m.geometry->headline.scores, 0.02) : kUndefined; },
       3},
      {"F at 1 cm", "fscore_1cm",
       [](const RunMetrics& m) { return m.geometry ? finer_fscore(m.geometry->headline.scores, 0.01) : kUndefined; },
       3},
      {"normals (deg)", "normal_error_deg",
       [](const RunMetrics& m) { return m.geometry ? m.geometry->surface.normal_error.median : kUndefined; }, 2},
      {"on structure", "structure_normal_error_deg",
       [](const RunMetrics& m) { return m.geometry ? m.geometry->surface.structure_normal_error.median : kUndefined; },
       2},
      {"roughness (deg)", "roughness_deg",
       [](const RunMetrics& m) { return m.geometry ? m.geometry->surface.roughness.median : kUndefined; }, 2},
      {"pinholes", "pinholes",
       [](const RunMetrics& m) { return m.geometry ? m.geometry->surface.pinholes : kUndefined; }, 4},
      {"mIoU (classes from 0.1 %)", "miou",
       [](const RunMetrics& m) { return m.semantics ? m.semantics->miou : kUndefined; }, 3},
      {"mIoU (all present)", "miou_present",
       [](const RunMetrics& m) { return m.semantics ? m.semantics->present_miou : kUndefined; }, 3},
      {"seconds", "seconds", [](const RunMetrics& m) { return m.train.seconds; }, 0},
      {"Gaussians", "gaussians",
       [](const RunMetrics& m) { return m.train.gaussians ? static_cast<double>(*m.train.gaussians) : kUndefined; }, 0},
  }};
  return kColumns;
}

const std::array<ViewScoreColumn, 3>& view_score_columns() {
  static constexpr std::array<ViewScoreColumn, 3> columns = {
      {{"PSNR (dB)", "psnr", &TestViewMetrics::psnr, 2},
       {"SSIM", "ssim", &TestViewMetrics::ssim, 3},
       {"label accuracy", "label_accuracy", &TestViewMetrics::label_accuracy, 3}}};
  return columns;
}

RunScores read_run_scores(const std::filesystem::path& run) {
  const std::filesystem::path file = run / "metrics.json";
  if (!std::filesystem::exists(file)) {
    require_run_of(run);
    throw_bad_input(file, "metrics.json", "this run has not been measured",
                    "run `aligngs eval " + run.string() + "` first");
  }
  const RunMetrics metrics = read_metrics(file);
  RunScores out;
  out.folder = run;
  out.name = std::filesystem::absolute(run).lexically_normal().filename().string();
  if (out.name.empty()) out.name = std::filesystem::absolute(run).lexically_normal().parent_path().filename().string();
  for (size_t i = 0; i < kScoreCount; ++i) out.score[i] = score_columns()[i].value(metrics);
  out.views = metrics.views;
  if (metrics.geometry) out.protocol = protocol_text(metrics.geometry->headline);
  out.priors = metrics.priors;
  return out;
}

std::string score_text(size_t column, double value) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, score_columns()[column].digits) : "–";
}

}  // namespace aligngs
