#include "scene/scene_json.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"

namespace aligngs {
namespace {

std::filesystem::path json_file(const std::string& name, const std::string& content) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "scene_json_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name) << content;
  return folder / name;
}

template <class Read>
std::string message_of(Read read, const std::string& content) {
  try {
    read(json_file("bad.json", content));
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    return error.what();
  }
  return "";
}

TEST(SceneJson, AbsentFilesGiveTheDefaults) {
  EXPECT_FALSE(read_scene_json("/no/such/scene.json").metric);
  EXPECT_FALSE(read_split_json("/no/such/split.json").train);
  EXPECT_FALSE(read_priors_json("/no/such/priors.json").kind);
}

TEST(SceneJson, ANumberThatNoMachineHoldsIsNamed) {
  EXPECT_NE(message_of(read_scene_json, R"({"up": [0, 0, 1e999]})").find("too large"), std::string::npos);
}

TEST(SceneJson, WrittenSceneReadsBackEqual) {
  SceneJson scene;
  scene.metric = true;
  scene.up = normalized(Vec3d{0, -1, 0.25});
  scene.source = "a \"quoted\" source";
  const auto path = json_file("scene.json", "");
  write_scene_json(path, scene);
  const SceneJson back = read_scene_json(path);
  EXPECT_TRUE(back.metric);
  EXPECT_NEAR(back.up->z, scene.up->z, 1e-15);
  EXPECT_EQ(back.source, scene.source);
}

TEST(SceneJson, UpIsBroughtToUnitLength) {
  EXPECT_EQ(read_scene_json(json_file("up.json", R"({"up": [0, 0, 3]})")).up->z, 1);
}

TEST(SceneJson, WrittenSplitReadsBackEqual) {
  SplitJson split;
  split.train = {{"a", "b"}};
  const auto path = json_file("split.json", "");
  write_split_json(path, split);
  EXPECT_EQ(read_split_json(path).train, split.train);
  EXPECT_FALSE(read_split_json(path).test);
}

TEST(SceneJson, WrittenPriorsReadBackEqual) {
  PriorsJson priors;
  priors.depth = PriorJson{"sensor", "", {{"unit", "metres"}}};
  priors.semantics = PriorJson{"simulated", "abc", {}};
  priors.kind = SemanticKind::kScores;
  priors.depth_scale = DepthScale::kOwn;
  const auto path = json_file("priors.json", "");
  write_priors_json(path, priors);
  const PriorsJson back = read_priors_json(path);
  EXPECT_EQ(back.depth->settings.at("unit"), "metres");
  EXPECT_EQ(back.semantics->weights, "abc");
  EXPECT_EQ(back.kind, SemanticKind::kScores);
  EXPECT_EQ(back.depth_scale, DepthScale::kOwn);
}

TEST(SceneJson, EveryDepthScaleHasANameThatReadsBack) {
  for (const DepthScale scale : {DepthScale::kScene, DepthScale::kMetres, DepthScale::kOwn, DepthScale::kPerView}) {
    PriorsJson priors;
    priors.depth = PriorJson{"any", "", {}};
    priors.depth_scale = scale;
    const auto path = json_file("priors.json", "");
    write_priors_json(path, priors);
    EXPECT_EQ(read_priors_json(path).depth_scale, scale) << name_of(scale);
  }
}

/// The depth entry of a file that states no scale.
PriorsJson depth_without_scale(const std::string& model, const std::string& units = "") {
  PriorsJson priors;
  priors.depth = PriorJson{model, "", {}};
  if (!units.empty()) priors.depth->settings["units"] = units;
  return priors;
}

TEST(SceneJson, OlderFilesSayTheScaleOfDepthByUnits) {
  EXPECT_EQ(depth_scale_of(depth_without_scale("nyu-dpt-b", "metres"), false), DepthScale::kMetres);
  EXPECT_EQ(depth_scale_of(depth_without_scale("nyu-linear4-b", "metres"), false), DepthScale::kMetres);
  EXPECT_EQ(depth_scale_of(depth_without_scale("vggt-1b", "arbitrary"), false), DepthScale::kOwn);
  EXPECT_EQ(depth_scale_of(depth_without_scale("vggt-1b", "arbitrary"), true), DepthScale::kScene)
      << "corrected with the scene's cameras";
}

TEST(SceneJson, DepthOfNoStatedScaleIsPerViewWhateverTheNameOfItsNetwork) {
  for (const char* model : {"DINOv2 DPT head, NYU", "MiDaS", "vggt-1b", "somebody's network", ""}) {
    EXPECT_EQ(depth_scale_of(depth_without_scale(model), false), DepthScale::kPerView) << model;
    EXPECT_TRUE(assumes_depth_scale(depth_without_scale(model), false)) << model;
    EXPECT_FALSE(assumes_depth_scale(depth_without_scale(model), true)) << model;
    EXPECT_FALSE(assumes_depth_scale(depth_without_scale(model, "metres"), false)) << model;
  }
}

TEST(SceneJson, DepthThatNoNetworkMadeIsInSceneUnits) {
  for (const char* model : {kSensorDepth, kSimulatedSensorDepth, kStereoDepth}) {
    EXPECT_EQ(depth_scale_of(depth_without_scale(model), false), DepthScale::kScene) << model;
    EXPECT_FALSE(assumes_depth_scale(depth_without_scale(model), false)) << model;
  }
  EXPECT_EQ(depth_scale_of({}, false), DepthScale::kScene);
  EXPECT_FALSE(assumes_depth_scale({}, false));
}

TEST(SceneJson, AStatedScaleWinsOverUnitsAndName) {
  PriorsJson priors;
  priors.depth = PriorJson{"mono", "", {{"units", "arbitrary"}}};
  priors.depth_scale = DepthScale::kMetres;
  EXPECT_EQ(depth_scale_of(priors, true), DepthScale::kMetres);
}

TEST(SceneJson, AnEstimateOfTheUnitsReadsBackEqual) {
  SceneJson scene;
  scene.metric = true;
  scene.units_estimate = {"da3metric-large", 0.03, 20};
  const auto path = json_file("scene.json", "");
  write_scene_json(path, scene);
  const SceneJson back = read_scene_json(path);
  ASSERT_TRUE(back.units_estimate);
  EXPECT_EQ(back.units_estimate->model, "da3metric-large");
  EXPECT_DOUBLE_EQ(back.units_estimate->spread, 0.03);
  EXPECT_EQ(back.units_estimate->photos, 20);
}

TEST(SceneJson, WrittenExposureReadsBackEqual) {
  const auto path = json_file("exposure.json", "");
  write_exposure_json(path, {{"a", {0.1f, -0.2f, 0.0f}}});
  const ExposureJson back = read_exposure_json(path);
  ASSERT_EQ(back.size(), 1u);
  EXPECT_FLOAT_EQ(back.at("a").y, -0.2f);
}

TEST(SceneJson, MalformedFilesNameTheField) {
  EXPECT_NE(message_of(read_scene_json, "{").find("no valid JSON"), std::string::npos);
  EXPECT_NE(message_of(read_scene_json, "[]").find("object expected"), std::string::npos);
  EXPECT_NE(message_of(read_scene_json, R"({"units": "feet"})").find("units"), std::string::npos);
  EXPECT_NE(message_of(read_scene_json, R"({"up": [0, 0, 0]})").find("up"), std::string::npos);
  for (const char* estimate : {"3", R"({"model": "x", "spread": -1, "photos": 3})", R"({"model": "x", "spread": 0.1})",
                               R"({"model": 1, "spread": 0, "photos": 3})"}) {
    EXPECT_NE(
        message_of(read_scene_json, std::string(R"({"units_estimate": )") + estimate + "}").find("units_estimate"),
        std::string::npos)
        << estimate;
  }
  EXPECT_NE(message_of(read_scene_json, R"({"up": [0, "x", 0]})").find("up"), std::string::npos);
  EXPECT_NE(message_of(read_split_json, R"({"test": "a"})").find("test"), std::string::npos);
  EXPECT_NE(message_of(read_split_json, R"({"test": [1]})").find("test"), std::string::npos);
  EXPECT_NE(message_of(read_split_json, "{}").find("neither"), std::string::npos);
  EXPECT_NE(message_of(read_priors_json, R"({"semantics": {"kind": "x"}})").find("semantics.kind"), std::string::npos);
  EXPECT_NE(message_of(read_priors_json, R"({"depth": {"scale": "feet"}})").find("depth.scale"), std::string::npos);
  EXPECT_NE(message_of(read_exposure_json, "{}").find("log_gains"), std::string::npos);
  EXPECT_NE(message_of(read_exposure_json, R"({"log_gains": {"a": [0, 1]}})").find("log_gains.a"), std::string::npos);
  EXPECT_NE(message_of(read_exposure_json, R"({"log_gains": {"a": [0, 1, 1e9]}})").find("log_gains.a"),
            std::string::npos);
}

}  // namespace
}  // namespace aligngs
