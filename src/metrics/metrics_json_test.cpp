#include "metrics/metrics_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

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
  metrics.views_measured = true;
  metrics.views = {view("a", 20, false), view("b", kUndefined, false), view("c", 30, true)};
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
  metrics.views_measured = true;
  for (const double metres : {0.1, 0.3, 0.2}) {
    metrics.views.push_back(view("v", 20, false));
    RefinedPoseMetrics refined;
    refined.psnr = 22;
    refined.before = PoseError{metres, 1};
    metrics.views.back().pose_refined = refined;
  }
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

}  // namespace
}  // namespace aligngs
