#include "metrics/metrics_json.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "metrics/metric_names.h"

namespace aligngs {
namespace {

TestViewMetrics view(const char* name, double psnr, bool extrapolates) {
  TestViewMetrics view;
  view.name = name;
  view.psnr = psnr;
  view.extrapolates = extrapolates;
  return view;
}

TEST(MetricsJson, WhatWasNotMeasuredIsNull) {
  const nlohmann::json json = metrics_json({});
  for (const char* part : {"nvs", "geometry", "semantics"}) EXPECT_TRUE(json[part].is_null()) << part;
  EXPECT_TRUE(json["train"]["seconds"].is_null());
  EXPECT_TRUE(json["train"]["peak_memory_bytes"].is_null());
  EXPECT_EQ(json["per_view"], nlohmann::json::array());
}

TEST(MetricsJson, MeansLeaveOutViewsWithoutTheFigure) {
  RunMetrics metrics;
  metrics.views = {view("a", 20, false), view("b", kUndefined, false), view("c", 30, true)};
  metrics.novel_views = novel_view_metrics(metrics.views, "");
  const nlohmann::json json = metrics_json(metrics), &nvs = json["nvs"];
  EXPECT_EQ(nvs["psnr"], 25);
  EXPECT_EQ(nvs["views"], 3);
  EXPECT_EQ(nvs["interpolating"]["psnr"], 20);
  EXPECT_EQ(nvs["interpolating"]["views"], 2);
  EXPECT_EQ(nvs["extrapolating"]["psnr"], 30);
  EXPECT_TRUE(nvs["ssim"].is_null());
  EXPECT_TRUE(json["per_view"][1]["psnr"].is_null());
  EXPECT_TRUE(nvs["pose_refined"].is_null());
  EXPECT_FALSE(json["per_view"][0].contains("pose_refined"));
}

TEST(MetricsJson, FittedPosesHaveTheMedianOfTheirErrors) {
  RunMetrics metrics;
  for (const double metres : {0.1, 0.3, 0.2}) {
    metrics.views.push_back(view("v", 20, false));
    RefinedPoseMetrics refined;
    refined.psnr = 22;
    refined.before = PoseError{metres, 1};
    metrics.views.back().pose_refined = refined;
  }
  metrics.novel_views = novel_view_metrics(metrics.views, "");
  const nlohmann::json json = metrics_json(metrics), &refined = json["nvs"]["pose_refined"];
  EXPECT_EQ(refined["psnr"], 22);
  EXPECT_DOUBLE_EQ(refined["median_error_before_m"].get<double>(), 0.2);
  EXPECT_TRUE(refined["median_error_after_m"].is_null());
}

TEST(MetricsJson, LabelsOfAMeshStandWithoutThoseOfViews) {
  RunMetrics metrics;
  metrics.labels.classes = {{"wall", {}, {1, 1, 1}}, {"floor", {}, {2, 2, 2}}};
  MeshLabelScores labels;
  labels.all.miou = 0.5;
  labels.all.iou = labels.all.present_iou = {0.5, kUndefined};
  labels.class_coverage = {1, kUndefined};
  metrics.mesh_labels = labels;
  const nlohmann::json json = metrics_json(metrics)["semantics"];
  EXPECT_TRUE(json["miou"].is_null());
  EXPECT_EQ(json["mesh"]["miou"], 0.5);
  EXPECT_EQ(json["mesh"]["iou"], (nlohmann::json{{"wall", 0.5}})) << "classes without a value are left out";
}

/// Every part, with a number of its own in each place.
RunMetrics everything() {
  RunMetrics m;
  double next = 1;
  const auto fill = [&next](const std::string&, auto& value) { value = static_cast<uint64_t>(next++); };
  m.scene_source = "synthetic";
  m.priors = "simulated";
  m.width = 320;
  m.height = 240;
  m.labels.classes = {{"floor", {}, {}}, {"wall", {}, {}}};
  m.views = {view("a", 20, false), view("b", 24, true)};
  for (TestViewMetrics& v : m.views) each_view_number(v, fill);
  RefinedPoseMetrics fit;
  each_refined_pose_number(fit, fill);
  fit.before = PoseError{next++, next++};
  fit.after = PoseError{next++, next++};
  m.views[0].pose_refined = fit;
  m.novel_views = novel_view_metrics(m.views, "VGG16");
  const auto semantics = [&] {
    SemanticScores scores;
    each_semantic_number(scores, fill);
    each_present_number(scores, fill);
    scores.iou = {next++, kUndefined};
    scores.present_iou = {next++, next++};
    return scores;
  };
  m.semantics = semantics();
  m.teacher = semantics();
  m.mesh_labels.emplace().all = semantics();
  each_mesh_label_number(*m.mesh_labels, fill);
  m.mesh_labels->class_coverage = {kUndefined, next++};
  MeshProtocolResult& headline = m.geometry.emplace().headline;
  each_mesh_number(headline, fill);
  headline.alignment = MeshAlignment::kCamerasAndIcp;
  headline.scores.finer = {{0.01, next++, next++, next++}, {0.02, next++, next++, next++}};
  headline.alignment_report.icp.emplace().rmse_after = next++;
  m.geometry->variants = {headline};
  m.geometry->variants[0].protocol = MeshProtocol::kAreaSamples;
  m.geometry->variants[0].culling = CullingViews::kTraining;
  each_surface_number(m.geometry->surface, fill);
  each_training_number(m.train, fill);
  m.train.device = "cpu";
  return m;
}

TEST(MetricsJson, ReadingIsTheInverseOfWriting) {
  const nlohmann::json json = metrics_json(everything());
  EXPECT_EQ(metrics_json(metrics_from_json(json)), json);
}

TEST(MetricsJson, ReadingKeepsThePartsOfTheProtocol) {
  const RunMetrics back = metrics_from_json(metrics_json(everything()));
  EXPECT_FALSE(back.geometry->headline.stated);
  EXPECT_EQ(back.geometry->headline.alignment, MeshAlignment::kCamerasAndIcp);
  EXPECT_EQ(back.geometry->variants.at(0).protocol, MeshProtocol::kAreaSamples);
  EXPECT_EQ(back.geometry->variants.at(0).culling, CullingViews::kTraining);
}

TEST(MetricsJson, NumbersThatAnOldFileLacksAreUndefined) {
  const RunMetrics m = metrics_from_json(
      {{"nvs", {{"psnr", 21.5}}}, {"geometry", {{"fscore", 0.8}, {"protocol", "area"}}}, {"semantics", nullptr}});
  ASSERT_TRUE(m.novel_views && m.geometry);
  EXPECT_EQ(m.novel_views->psnr, 21.5);
  EXPECT_TRUE(std::isnan(m.novel_views->ssim));
  EXPECT_FALSE(m.novel_views->interpolating);
  EXPECT_EQ(protocol_text(m.geometry->headline), "area");
  EXPECT_TRUE(std::isnan(m.geometry->surface.pinholes));
  EXPECT_TRUE(std::isnan(finer_fscore(m.geometry->headline.scores, 0.02)));
  EXPECT_FALSE(m.semantics);
  EXPECT_FALSE(m.train.gaussians);
  EXPECT_TRUE(std::isnan(m.train.seconds));
}

TEST(MetricsJson, ValuesOfOtherTypesCountAsMissing) {
  const RunMetrics m = metrics_from_json({{"nvs", {{"psnr", "21.5"}, {"views", -3}}},
                                          {"geometry", 3},
                                          {"train", {{"gaussians", "many"}}},
                                          {"width", 1e300},
                                          {"per_view", {{{"name", 7}}, 5}}});
  EXPECT_TRUE(std::isnan(m.novel_views->psnr));
  EXPECT_EQ(m.novel_views->views, 0u);
  EXPECT_FALSE(m.geometry);
  EXPECT_FALSE(m.train.gaussians);
  EXPECT_EQ(m.width, 0);
  ASSERT_EQ(m.views.size(), 1u);
  EXPECT_EQ(m.views[0].name, "");
}

TEST(MetricsJson, NamedFiguresAreTheNumbersOfTheFile) {
  const RunMetrics m = everything();
  const nlohmann::json json = metrics_json(m);
  const std::map<std::string, double> figures = named_figures(m);
  for (const auto& [name, value] : figures) {
    std::string pointer = "/" + name;
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    EXPECT_EQ(json.at(nlohmann::json::json_pointer(pointer)).get<double>(), value) << name;
  }
  EXPECT_EQ(figures.count("semantics.mesh.class_coverage.wall"), 1u);
  EXPECT_EQ(figures.count("semantics.iou.wall"), 0u) << "NaN is no figure";
  EXPECT_EQ(figures.count("geometry.fscore_2cm"), 1u);
}

}  // namespace
}  // namespace aligngs
