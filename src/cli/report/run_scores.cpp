#include "cli/report/run_scores.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "cli/report/json_field.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"

namespace aligngs {

using Json = nlohmann::json;

namespace {

std::string text_at(const Json& node, const char* key) {
  return node.is_object() && node.contains(key) && node[key].is_string() ? node[key].get<std::string>() : std::string();
}

}  // namespace

const std::array<ScoreColumn, kScoreCount>& score_columns() {
  static constexpr std::array<ScoreColumn, kScoreCount> kColumns = {{
      {"PSNR (dB)", "psnr", "nvs.psnr", 2},
      {"after colour fit", "psnr_fitted", "nvs.exposure_fitted.psnr", 2},
      {"after pose fit", "psnr_pose", "nvs.pose_refined.psnr", 2},
      {"between", "psnr_interpolating", "nvs.interpolating.psnr", 2},
      {"beyond", "psnr_extrapolating", "nvs.extrapolating.psnr", 2},
      {"SSIM", "ssim", "nvs.ssim", 3},
      {"LPIPS", "lpips", "nvs.lpips", 3},
      {"Acc (m)", "accuracy", "geometry.accuracy", 4},
      {"Comp (m)", "completeness", "geometry.completeness", 4},
      {"Prec", "precision", "geometry.precision", 3},
      {"Recall", "recall", "geometry.recall", 3},
      {"F", "fscore", "geometry.fscore", 3},
      {"F at 2 cm", "fscore_2cm", "geometry.fscore_2cm", 3},
      {"F at 1 cm", "fscore_1cm", "geometry.fscore_1cm", 3},
      {"normals (deg)", "normal_error_deg", "geometry.surface.normal_error_median_deg", 2},
      {"on structure", "structure_normal_error_deg", "geometry.surface.structure_normal_error_median_deg", 2},
      {"roughness (deg)", "roughness_deg", "geometry.surface.roughness_median_deg", 2},
      {"pinholes", "pinholes", "geometry.surface.pinholes", 4},
      {"mIoU (classes from 0.1 %)", "miou", "semantics.miou", 3},
      {"mIoU (all present)", "miou_present", "semantics.present.miou", 3},
      {"seconds", "seconds", "train.seconds", 0},
      {"Gaussians", "gaussians", "train.gaussians", 0},
  }};
  return kColumns;
}

const std::array<ViewScoreColumn, 3>& view_score_columns() {
  static constexpr std::array<ViewScoreColumn, 3> columns = {
      {{"PSNR (dB)", "psnr", &ViewScore::psnr, 2},
       {"SSIM", "ssim", &ViewScore::ssim, 3},
       {"label accuracy", "label_accuracy", &ViewScore::label_accuracy, 3}}};
  return columns;
}

RunScores read_run_scores(const std::filesystem::path& run) {
  const std::filesystem::path file = run / "metrics.json";
  if (!std::filesystem::exists(file)) {
    throw_bad_input(file, "metrics.json", "this run has not been measured",
                    "run `aligngs eval " + run.string() + "` first");
  }
  const Json metrics = parse_json(read_file(file));
  if (!metrics.is_object()) throw_bad_input(file, "metrics.json", "is not JSON", "measure again with `aligngs eval`");
  RunScores out;
  out.folder = run;
  out.name = std::filesystem::absolute(run).lexically_normal().filename().string();
  if (out.name.empty()) out.name = std::filesystem::absolute(run).lexically_normal().parent_path().filename().string();
  for (size_t i = 0; i < kScoreCount; ++i) out.score[i] = number_at(metrics, score_columns()[i].field);
  if (metrics.contains("per_view") && metrics["per_view"].is_array()) {
    for (const Json& view : metrics["per_view"]) {
      ViewScore score{text_at(view, "name")};
      for (const ViewScoreColumn& c : view_score_columns()) score.*c.score = number_at(view, c.field);
      out.views.push_back(std::move(score));
    }
  }
  if (metrics.contains("geometry")) out.protocol = text_at(metrics["geometry"], "protocol");
  out.priors = text_at(metrics, "priors");
  return out;
}

std::string score_text(size_t column, double value) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, score_columns()[column].digits) : "–";
}

}  // namespace aligngs
