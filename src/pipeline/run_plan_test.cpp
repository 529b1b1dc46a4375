#include "pipeline/run_plan.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/log.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "pipeline/step_forecast.h"
#include "priors/model_sets.h"
#include "refine/bundle_adjustment.h"
#include "scene/testing/scene_folder.h"
#include "train/run_folder.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Programs of these names are in PATH while it lives. A plan starts none of them.
class WithPrograms {
 public:
  /// `script`: of each; without one they fail.
  WithPrograms(const fs::path& folder, const std::vector<std::string>& names,
               const std::string& script = "#!/bin/false\n")
      : before_(std::getenv("PATH")) {
    for (const std::string& name : names) {
      write_file_atomically(folder / name, script);
      fs::permissions(folder / name, fs::perms::owner_all);
    }
    setenv("PATH", (folder.string() + ":" + before_).c_str(), 1);
  }
  ~WithPrograms() { setenv("PATH", before_.c_str(), 1); }
  WithPrograms(const WithPrograms&) = delete;
  WithPrograms& operator=(const WithPrograms&) = delete;

 private:
  std::string before_;
};

class RunPlanTest : public testing::Test {
 protected:
  void SetUp() override {
    set_log_level(LogLevel::kWarning);
    base_ = test_scene::fresh_folder("base");
    fs::create_directories(base_);
    store_.folder = base_ / "models";
    request_.train.run = base_ / "run";
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  /// A scene with depth and labels.
  fs::path scene() {
    request_.source = test_scene::write_scene("scene");
    return request_.source;
  }
  /// A scene as COLMAP leaves it: cameras and points alone.
  fs::path colmap_folder() {
    const fs::path folder = scene();
    for (const char* name : {"pred_depths", "segmentation_logits", "truth", "priors.json", "scene.json"})
      fs::remove_all(folder / name);
    return folder;
  }
  fs::path photos(int count = 4) {
    request_.source = base_ / "photos";
    for (int i = 0; i < count; ++i)
      write_png(request_.source / ("p" + std::to_string(i) + ".png"), test_scene::textured_image(uint64_t(i)));
    return request_.source;
  }
  /// Empty files where the weights of a network belong.
  void install(const char* name) const {
    const ModelStore store(store_);
    for (const PublishedModel* model : with_needs(published_model(name)))
      for (const ModelFile& file : model->files) write_file_atomically(store.own_path(*model, file), "weights");
  }
  RunPlan plan() const { return plan_run(request_, ModelStore(store_)); }
  Outlook outlook(RunStep step) const { return plan().step(step).outlook; }
  Error error() const {
    try {
      plan();
    } catch (const Error& error) {
      return error;
    }
    ADD_FAILURE() << "no error";
    return Error({});
  }
  /// Path and content of every file below the test's folder.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(base_.parent_path()))
      found[entry.path().string()] = entry.is_regular_file() ? read_file(entry.path()) : "";
    return found;
  }

  fs::path base_;
  ModelStoreOptions store_;
  RunRequest request_;
};

TEST_F(RunPlanTest, AWholeSceneIsTrainedAsItIs) {
  scene();
  request_.train.config.sets = {"data.refine_cameras=false", "data.fill_depth=false", "data.sensor_exposure=false"};
  const RunPlan made = plan();
  EXPECT_EQ(made.scene, request_.source);
  for (const RunStep step :
       {RunStep::kPoses, RunStep::kDepth, RunStep::kClasses, RunStep::kMeasure, RunStep::kRefine, RunStep::kComplete}) {
    EXPECT_FALSE(made.has(step)) << step_name(step);
    EXPECT_FALSE(made.step(step).reason.empty()) << step_name(step);
  }
  for (const RunStep step :
       {RunStep::kTrain, RunStep::kRender, RunStep::kMesh, RunStep::kEvaluate, RunStep::kReport, RunStep::kRoom})
    EXPECT_TRUE(made.has(step)) << step_name(step);
}

TEST_F(RunPlanTest, ASceneThatIsRefinedBelongsToTheRun) {
  scene();
  const RunPlan made = plan();
  EXPECT_EQ(made.step(RunStep::kRefine).outlook, Outlook::kPlanned) << made.step(RunStep::kRefine).reason;
  EXPECT_EQ(made.scene, base_ / "run" / "scene");
}

TEST_F(RunPlanTest, DepthOfAColmapFolderIsMeasured) {
  colmap_folder();
  const RunPlan made = plan();
  EXPECT_EQ(made.step(RunStep::kMeasure).outlook, Outlook::kPlanned);
  EXPECT_FALSE(made.has(RunStep::kDepth));
  EXPECT_FALSE(made.has(RunStep::kRefine));
  EXPECT_THAT(made.step(RunStep::kClasses).reason, HasSubstr("no weights for them are here"));
  EXPECT_EQ(made.scene, base_ / "run" / "scene");
}

TEST_F(RunPlanTest, LabelsComeFromTheFirstInstalledNetwork) {
  colmap_folder();
  install("lingbot-s");
  const RunPlan made = plan();
  ASSERT_TRUE(made.step(RunStep::kClasses).network);
  EXPECT_EQ(made.step(RunStep::kClasses).network->name, "lingbot-s");
  request_.priors.semantics = semantic_choice("none");
  EXPECT_EQ(outlook(RunStep::kClasses), Outlook::kLeftOut);
}

TEST_F(RunPlanTest, ANetworkOfCamerasGivesDepthInsteadOfTheMeasurement) {
  colmap_folder();
  install("da3-small");
  const RunPlan made = plan();
  EXPECT_EQ(made.step(RunStep::kDepth).network->name, "da3-small");
  EXPECT_FALSE(made.has(RunStep::kMeasure));
  EXPECT_NE(made.step(RunStep::kRefine).outlook, Outlook::kPlanned) << "the depth is not there yet";
}

TEST_F(RunPlanTest, PhotosWithoutANetworkAreAnErrorThatNamesTheOtherWay) {
  photos();
  const Error without = error();
  EXPECT_EQ(without.kind(), ErrorKind::kWeights);
  EXPECT_THAT(without.details().remedy, HasSubstr("--method colmap --semantics none"));
  EXPECT_THAT(without.details().remedy, testing::Not(HasSubstr("--method given")));
  fs::create_directories(request_.source.parent_path() / "sparse");
  EXPECT_THAT(error().details().remedy, HasSubstr("cameras that lie beside the photos"));
}

TEST_F(RunPlanTest, PhotosTakeTheBestInstalledNetwork) {
  photos();
  install("vggt-1b");
  install("da3-small");
  const RunPlan made = plan();
  EXPECT_EQ(made.cameras.method, PosesMethod::kDa3);
  EXPECT_EQ(made.step(RunStep::kPoses).network->name, "da3-small");
  EXPECT_THAT(made.step(RunStep::kPoses).reason, HasSubstr("free to use"));
  EXPECT_FALSE(made.has(RunStep::kDepth)) << "it comes with the cameras";
  EXPECT_EQ(made.scene, base_ / "run" / "scene");
}

TEST_F(RunPlanTest, AMethodTakesItsInstalledNetworkThatAnyoneMayUse) {
  photos();
  request_.cameras.method = PosesMethod::kDa3;
  install("da3-large");
  EXPECT_THAT(error().what(), HasSubstr("da3-base")) << "the large one has terms";
  install("da3-small");
  EXPECT_EQ(plan().step(RunStep::kPoses).network->name, "da3-small");
  install("da3-base");
  EXPECT_EQ(plan().step(RunStep::kPoses).network->name, "da3-base");
}

TEST_F(RunPlanTest, ANetworkWithTermsIsToldWithThem) {
  photos();
  install("vggt-1b");
  EXPECT_THAT(plan().step(RunStep::kPoses).terms, HasSubstr("non-commercial"));
  request_.cameras.method = PosesMethod::kVggt;
  EXPECT_EQ(plan().step(RunStep::kPoses).terms, "") << "it was asked for";
}

TEST_F(RunPlanTest, CamerasByColmapLeadToMeasuredDepth) {
  const WithPrograms programs(base_ / "bin", {"colmap"});
  photos();
  request_.cameras.method = PosesMethod::kColmap;
  request_.priors.semantics = semantic_choice("none");
  const RunPlan made = plan();
  EXPECT_EQ(made.step(RunStep::kPoses).outlook, Outlook::kPlanned);
  EXPECT_EQ(made.step(RunStep::kMeasure).outlook, Outlook::kExpected);
  EXPECT_FALSE(made.has(RunStep::kDepth));
}

TEST_F(RunPlanTest, AMissingProgramIsAnErrorBeforeAnythingIsDone) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", base_.c_str(), 1);
  photos();
  request_.cameras.method = PosesMethod::kColmap;
  const Error missing = error();
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(missing.kind(), ErrorKind::kFailed);
  EXPECT_THAT(missing.details().remedy, HasSubstr("apt-get install colmap"));
  EXPECT_FALSE(fs::exists(base_ / "run"));
}

constexpr const char* kProbeOfAVideo =
    "#!/bin/sh\necho '{\"streams\": [{\"width\": 640, \"height\": 480, \"avg_frame_rate\": \"30/1\", \"duration\": "
    "\"9\"}]}'\n";

TEST_F(RunPlanTest, AVideoThatCannotBeReadIsRefusedBeforeAnythingStarts) {
  const WithPrograms programs(base_ / "bin", {"ffmpeg", "ffprobe"});
  request_.source = base_ / "room.mp4";
  write_file_atomically(request_.source, "no frames");
  install("da3-small");
  const Error refused = error();
  EXPECT_EQ(refused.kind(), ErrorKind::kBadInput);
  EXPECT_THAT(refused.what(), AllOf(HasSubstr("room.mp4"), HasSubstr("ffprobe cannot read it")));
  EXPECT_FALSE(fs::exists(base_ / "run"));
}

TEST_F(RunPlanTest, FramesOfAVideoAreOfUnknownSize) {
  const WithPrograms programs(base_ / "bin", {"ffmpeg", "ffprobe"}, kProbeOfAVideo);
  request_.source = base_ / "room.mp4";
  write_file_atomically(request_.source, "frames");
  install("da3-small");
  const RunPlan made = plan();
  EXPECT_TRUE(made.has(RunStep::kPoses));
  EXPECT_FALSE(made.step(RunStep::kTrain).memory_bytes);
  EXPECT_EQ(made.memory_bytes(), 0u);
}

TEST_F(RunPlanTest, ARunThatHasBegunKeepsItsScene) {
  scene();
  fs::create_directories(base_ / "run");
  RunRecord record;
  record.status = RunStatus::kStopped;
  record.scene = relative_scene_path(base_ / "run", request_.source);
  record.train.iterations = 300;
  record.train.iterations_per_second = 2;
  record.train.peak_memory_bytes = 1'000'000'000;
  write_run_record(base_ / "run" / "run.json", record);
  request_.train.resume = true;
  request_.train.config.iterations = 1000;
  const RunPlan made = plan();
  EXPECT_TRUE(made.begun);
  EXPECT_FALSE(made.has(RunStep::kRefine));
  EXPECT_EQ(made.scene, request_.source);
  EXPECT_DOUBLE_EQ(made.step(RunStep::kTrain).seconds.value_or(0), 350) << "what is left, at the speed of before";
  EXPECT_EQ(made.step(RunStep::kTrain).memory_bytes.value_or(0), 1'100'000'000u);
}

TEST_F(RunPlanTest, TimeOfANewRunIsUnknown) {
  scene();
  EXPECT_FALSE(plan().step(RunStep::kTrain).seconds);
  EXPECT_GT(plan().step(RunStep::kTrain).memory_bytes.value_or(0), 0u);
}

TEST_F(RunPlanTest, TimeOfANetworkFollowsFromItsOperationsAndThePhotos) {
  photos();
  install("da3-small");
  RunPlan made = plan();
  ASSERT_GT(made.photos, 0u);
  EXPECT_FALSE(made.step(RunStep::kPoses).seconds) << "no rate was measured";
  forecast_network_time(0.5e12, made);
  EXPECT_DOUBLE_EQ(made.step(RunStep::kPoses).seconds.value_or(0),
                   tera_operations_per_photo("da3-small") / 0.5 * double(made.photos));
  EXPECT_THAT(made.steps_of_unknown_time(), testing::Contains("train"));
  EXPECT_THAT(made.steps_of_unknown_time(), testing::Not(testing::Contains("poses")));
}

TEST_F(RunPlanTest, WhatNoRunCanUseIsAnError) {
  request_.source = base_ / "nowhere";
  EXPECT_EQ(error().kind(), ErrorKind::kBadInput);
  photos(1);
  install("da3-small");
  EXPECT_THAT(error().what(), HasSubstr("one photo"));
  request_.source = scene();
  request_.train.run = request_.source / "run";
  EXPECT_EQ(error().kind(), ErrorKind::kUsage);
}

/// Its photos alone would lose the cameras, and its depth would count as photos.
TEST_F(RunPlanTest, ACaptureWithPosesNamesTheImport) {
  write_file_atomically(photos() / "groundtruth.txt", "");
  write_file_atomically(request_.source / "rgb.txt", "");
  install("da3-small");
  EXPECT_THAT(error().what(), HasSubstr("this is a capture (TUM RGB-D), which has cameras of its own"));
  EXPECT_THAT(error().what(), HasSubstr("aligngs import"));
}

TEST_F(RunPlanTest, OptionsOfAnotherMethodAreRefused) {
  photos();
  request_.cameras.method = PosesMethod::kVggt;
  request_.cameras.camera_from_rays = true;
  EXPECT_THAT(error().what(), HasSubstr("--method da3"));
}

TEST_F(RunPlanTest, PlanningChangesNoFile) {
  colmap_folder();
  install("lingbot-s");
  photos();
  install("da3-small");
  const auto before = files();
  plan();
  request_.source = base_.parent_path() / "scene";
  plan();
  EXPECT_EQ(files(), before);
}

TEST_F(RunPlanTest, ADemoMakesItsScene) {
  const RunPlan made = plan_demo(request_.train, "kitchen", 1000);
  EXPECT_THAT(made.step(RunStep::kSynth).reason, HasSubstr("kitchen"));
  EXPECT_EQ(made.scene, base_ / "run" / "scene");
  EXPECT_FALSE(made.has(RunStep::kPoses));
}

}  // namespace
}  // namespace aligngs
