#include "train/train_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/colmap.h"
#include "scene/testing/scene_folder.h"
#include "train/checkpoint.h"
#include "train/run_folder.h"
#include "train/run_record.h"
#include "train/testing/fake_engine.h"
#include "train/testing/fake_runs.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

using TrainRun = test_train::RunOnFakeEngine;

TEST_F(TrainRun, AnEngineWithoutMultiViewTermsSaysSoBeforeTheFirstStep) {
  TrainOptions o = options("pgsr");
  o.config.preset = "pgsr";
  try {
    train_run(o, plain_engine());
    FAIL() << "expected an error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kUsage);
    EXPECT_THAT(e.details().remedy, HasSubstr("--device cpu"));
  }
}

TEST_F(TrainRun, LeavesACompleteRunFolder) {
  const TrainOptions o = options("a");
  const TrainResult result = train_run(o, plain_engine());
  EXPECT_EQ(result.iterations, 30);
  EXPECT_GT(result.gaussians, 0u);
  for (const char* name :
       {"run.json", "config.toml", "events.ndjson", "scene.ply", "scene.labels.ply", "classes.json", "cameras.json",
        "sparse/0/images.bin", "transforms.json", "checkpoints/step_000030.safetensors"}) {
    EXPECT_TRUE(fs::exists(o.run / name)) << name;
  }
  const RunRecord r = record(o);
  EXPECT_EQ(r.status, RunStatus::kDone);
  EXPECT_EQ(r.scene, "../../scene");
  EXPECT_EQ(r.device, "fake");
  EXPECT_EQ(r.train.iterations, 30);
  EXPECT_TRUE(r.warnings.empty());
}

TEST_F(TrainRun, SceneFileCarriesNoTimeAndNoPath) {
  train_run(options("a"), plain_engine());
  train_run(options("b"), plain_engine());
  EXPECT_TRUE(ply(options("a")) == ply(options("b")));
  EXPECT_THAT(ply(options("a")), Not(HasSubstr(base_.string())));
}

TEST_F(TrainRun, FolderRules) {
  const TrainOptions o = options("a", 5);
  train_run(o, plain_engine());
  EXPECT_EQ(kind_of([&] { train_run(o, plain_engine()); }), ErrorKind::kUsage);
  TrainOptions over = options("a", 6);
  over.overwrite = true;
  EXPECT_EQ(train_run(over, plain_engine()).iterations, 6);
  over.resume = true;
  EXPECT_EQ(kind_of([&] { train_run(over, plain_engine()); }), ErrorKind::kUsage);
}

TEST_F(TrainRun, NonFiniteGaussianIsRemovedAndTrainingGoesOn) {
  const TrainOptions o = options("a"), whole = options("whole");
  const EngineFactory once = [](int) {
    auto engine = std::make_unique<test_train::FakeEngine>();
    engine->before_step = [](int64_t step) { return step == 4 ? NonFinite{true, 2, "opacity"} : NonFinite{}; };
    return engine;
  };
  EXPECT_EQ(train_run(o, once).iterations, 30);
  EXPECT_THAT(read_file(o.run / "events.ndjson"), HasSubstr("opacity of Gaussian 2 became non-finite in view v"));
}

TEST_F(TrainRun, RepeatedNonFiniteStepsEndTheRunWithAValidCheckpoint) {
  const TrainOptions o = options("a");
  const EngineFactory always = [](int) {
    auto engine = std::make_unique<test_train::FakeEngine>();
    engine->before_step = [](int64_t step) { return step >= 10 ? NonFinite{true, -1, "ssim"} : NonFinite{}; };
    return engine;
  };
  EXPECT_EQ(kind_of([&] { train_run(o, always); }), ErrorKind::kFailed);
  EXPECT_EQ(record(o).status, RunStatus::kFailed);
  EXPECT_THAT(record(o).reason, HasSubstr("ssim"));
  const std::vector<fs::path> all = list_checkpoints(o.run / "checkpoints");
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(read_checkpoint(all.front(), record(o).fingerprint).non_finite_steps, 3);
}

TEST_F(TrainRun, BadSceneIsRefusedBeforeAnythingIsWritten) {
  test_scene::write_text(scene_ / "images" / "v2.png", "no image");  // a test view counts too
  TrainOptions o = options("a");
  o.strict = true;
  EXPECT_EQ(kind_of([&] { train_run(o, plain_engine()); }), ErrorKind::kBadInput);
  EXPECT_FALSE(fs::exists(o.run));
}

TEST_F(TrainRun, ABadTestPhotoIsLeftOutAndSaidUnlessStrict) {
  test_scene::write_text(scene_ / "images" / "v2.png", "no image");
  const TrainOptions o = options("a");
  train_run(o, plain_engine());
  EXPECT_EQ(record(o).status, RunStatus::kDone);
  ASSERT_EQ(record(o).left_out.size(), 1u);
}

TEST_F(TrainRun, TooLittleMemoryIsAResourceErrorWithTheSum) {
  TrainOptions o = options("a");
  o.memory_limit = 200000;
  try {
    train_run(o, plain_engine());
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
    EXPECT_THAT(e.what(), HasSubstr("training views"));
  }
}

/// An engine with memory of its own for so many Gaussians of three classes, beside its views.
EngineFactory engine_with_room_for(uint64_t gaussians) {
  return [gaussians](int) {
    auto engine = std::make_unique<test_train::FakeEngine>();
    engine->memory = OwnMemory{5000 + test_train::FakeEngine::bytes(gaussians, 3), 5000, 0};
    return engine;
  };
}

TEST_F(TrainRun, TheMemoryOfADeviceLimitsGrowth) {
  TrainOptions o = options("a");
  o.config.sets.push_back("init.max_gaussians=100");
  o.config.sets.push_back("densify.max_growth=3");
  train_run(o, engine_with_room_for(120));
  ASSERT_EQ(record(o).warnings.size(), 1u);
  EXPECT_THAT(record(o).warnings[0], HasSubstr("the memory of fake holds 120 Gaussians"));
  const std::vector<fs::path> checkpoints = list_checkpoints(o.run / "checkpoints");
  EXPECT_EQ(read_checkpoint(checkpoints.front(), record(o).fingerprint).facts.max_gaussians, 120u);
}

TEST_F(TrainRun, ADeviceTooSmallForTheStartIsAResourceErrorBeforeTheFirstStep) {
  TrainOptions o = options("a");
  o.config.sets.push_back("init.max_gaussians=100");
  try {
    train_run(o, engine_with_room_for(10));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
    EXPECT_THAT(e.what(), HasSubstr("training on fake"));
    EXPECT_THAT(e.details().remedy, HasSubstr("--device cpu"));
  }
  EXPECT_EQ(record(o).status, RunStatus::kFailed);
  EXPECT_FALSE(fs::exists(o.run / "events.ndjson"));
}

TEST_F(TrainRun, LabelsThatNobodyWantsAreNoWarning) {
  fs::remove_all(scene_ / "segmentation_logits");
  TrainOptions o = options("a");
  o.labels_unwanted = true;
  EXPECT_TRUE(train_run(o, plain_engine()).warnings.empty());
  EXPECT_TRUE(record(o).warnings.empty());
}

TEST_F(TrainRun, MissingPriorsAreSaidOrRefused) {
  fs::remove_all(scene_ / "segmentation_logits");
  TrainOptions o = options("a");
  const TrainResult result = train_run(o, plain_engine());
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings[0], HasSubstr("segmentation_logits"));
  EXPECT_EQ(record(o).warnings, result.warnings);
  EXPECT_FALSE(fs::exists(o.run / "scene.labels.ply"));
  TrainOptions strict = options("b");
  strict.require_priors = true;
  EXPECT_EQ(kind_of([&] { train_run(strict, plain_engine()); }), ErrorKind::kWeights);
}

/// The 200 points of the test scene, 2 % farther away than its prior depth has them, from cameras that are 0 to 0.2
/// units apart.
void move_points_away(const fs::path& scene) {
  ColmapModel model = read_colmap_model(scene / "sparse");
  for (ColmapPoint& point : model.points) point.position = point.position * 1.02;
  write_colmap_binary(scene / "sparse", model);
}

TEST_F(TrainRun, DepthThatWasRefinedWithItsCamerasKeepsItsScaleWhateverThePointsSay) {
  move_points_away(scene_);
  TrainOptions by_points = options("by_points", 1), refined = options("refined", 1);
  train_run(by_points, plain_engine());
  nlohmann::json description = nlohmann::json::parse(read_file(scene_ / "scene.json"));
  description["cameras_refined"] = nlohmann::json::object();  // the mark of `aligngs refine`
  write_file_atomically(scene_ / "scene.json", description.dump());
  train_run(refined, plain_engine());
  const auto scales = [](const TrainOptions& o) {
    return read_latest_checkpoint(RunFolder(o.run).checkpoints(), record(o).fingerprint)->depth_scales;
  };
  for (const float scale : scales(by_points)) EXPECT_NEAR(scale, 1.02, 0.003);
  for (const float scale : scales(refined)) EXPECT_EQ(scale, 1);
}

TEST_F(TrainRun, EveryStartWorks) {
  for (const char* start : {"depth", "cloud", "random"}) {
    TrainOptions o = options(start, 3);
    o.config.sets.push_back(std::string("init.start=") + start);
    o.config.sets.push_back("init.max_gaussians=150");
    o.config.sets.push_back("densify.free_space_every=0");  // in three iterations it would come after each
    const TrainResult result = train_run(o, plain_engine());
    EXPECT_GT(result.gaussians, 0u) << start;
    EXPECT_LE(result.gaussians, 150u) << start;
  }
}

TEST_F(TrainRun, ASceneWithoutPointsAndDepthStartsFromRandomOnes) {
  fs::remove_all(scene_ / "pred_depths");
  for (const char* file : {"points3D.bin", "points3D.txt", "points3D.ply"}) fs::remove(scene_ / "sparse" / file);
  TrainOptions o = options("bare", 3);
  EXPECT_GT(train_run(o, plain_engine()).gaussians, 0u);
  o = options("cloud", 3);
  o.config.sets.push_back("init.start=cloud");
  EXPECT_THROW(train_run(o, plain_engine()), Error);
}

TEST_F(TrainRun, ConfigOfARunReproducesIt) {
  const TrainOptions o = options("a");
  train_run(o, plain_engine());
  TrainOptions copy = options("b");
  copy.config = {};
  copy.config.config_file = o.run / "config.toml";
  train_run(copy, plain_engine());
  EXPECT_TRUE(ply(o) == ply(copy));
}

}  // namespace
}  // namespace aligngs
