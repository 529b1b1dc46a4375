#include "train/run_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "core/error.h"
#include "io/atomic_file.h"
#include "train/events.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class RunFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::path(testing::TempDir()) / "aligngs_run_folder_test" /
            testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(base_);
    fs::create_directories(base_);
  }
  fs::path make_run() const {
    const fs::path run = base_ / "run";
    fs::create_directories(run / "checkpoints");
    fs::create_directories(run / "scene" / "images");
    RunRecord record;
    record.status = RunStatus::kRunning;
    write_run_record(run / "run.json", record);
    for (const char* name : {"config.toml", "scene.ply", "my notes.txt", "checkpoints/step_000001.safetensors"}) {
      std::ofstream(run / name) << "x";
    }
    return run;
  }
  static ErrorKind kind_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& e) {
      return e.kind();
    }
    return ErrorKind::kFailed;
  }
  fs::path base_;
};

TEST_F(RunFolderTest, NewRunNeedsAFreshFolder) {
  EXPECT_NO_THROW(RunFolder(base_ / "a" / "b").prepare(RunMode::kNew));
  EXPECT_TRUE(fs::is_directory(base_ / "a" / "b"));
  EXPECT_NO_THROW(RunFolder(base_ / "a" / "b").prepare(RunMode::kNew));  // empty is fine
  EXPECT_EQ(kind_of([&] { RunFolder(make_run()).prepare(RunMode::kNew); }), ErrorKind::kUsage);
}

TEST_F(RunFolderTest, FolderWithTheSceneInItIsFresh) {
  fs::create_directories(base_ / "run" / "scene");
  EXPECT_NO_THROW(RunFolder(base_ / "run").prepare(RunMode::kNew));
}

TEST_F(RunFolderTest, ForeignFilesAreNeverTouched) {
  std::ofstream(base_ / "thesis.tex") << "x";
  for (const RunMode mode : {RunMode::kNew, RunMode::kResume, RunMode::kOverwrite}) {
    EXPECT_EQ(kind_of([&] { RunFolder(base_).prepare(mode); }), ErrorKind::kUsage);
  }
  EXPECT_TRUE(fs::exists(base_ / "thesis.tex"));
}

TEST_F(RunFolderTest, FilesThatAreNamedLikeARunsAreNoRun) {
  for (const char* name : {"config.toml", "run.json", "transforms.json"})
    std::ofstream(base_ / name) << "{\"schema\": 1}";
  for (const RunMode mode : {RunMode::kNew, RunMode::kResume, RunMode::kOverwrite}) {
    EXPECT_EQ(kind_of([&] { RunFolder(base_).prepare(mode); }), ErrorKind::kUsage);
  }
  EXPECT_TRUE(fs::exists(base_ / "transforms.json"));
}

TEST_F(RunFolderTest, ARunNeverLiesInItsSourceNorItsSourceInWhatARunWrites) {
  const auto apart = [&](const fs::path& run, const fs::path& source) {
    return kind_of([&] { RunFolder(base_ / run).require_apart_from(base_ / source); }) != ErrorKind::kUsage;
  };
  fs::create_directories(base_ / "data" / "images");
  fs::create_directories(base_ / "run" / "scene");
  fs::create_directories(base_ / "run" / "sparse");
  fs::create_directory_symlink(base_ / "data", base_ / "link");
  EXPECT_TRUE(apart("run", "data"));
  EXPECT_TRUE(apart("run", "run/scene"));
  EXPECT_FALSE(apart("data", "data"));
  EXPECT_FALSE(apart("data/run", "data"));
  EXPECT_FALSE(apart("link/run", "data"));
  EXPECT_FALSE(apart("run/../data", "data"));
  EXPECT_FALSE(apart("run", "run/sparse"));
}

TEST_F(RunFolderTest, WhatTheRunWroteIsNoPlaceForOtherFiles) {
  const fs::path run = make_run();
  std::ofstream(run / "scene.glb") << "x";
  fs::create_directories(base_ / "scene");
  fs::create_directory_symlink(run, base_ / "link");
  fs::create_directories(base_ / "photos");
  RunRecord record = read_run_record(run / "run.json");
  record.scene = "../photos";
  write_run_record(run / "run.json", record);
  const auto free = [&](const fs::path& file) {
    return kind_of([&] { RunFolder(run).require_not_of_run(file, base_ / "scene"); }) != ErrorKind::kUsage;
  };
  for (const fs::path& file : {run / "scene.glb", run / "scene.edited.ply", base_ / "out.ply"})
    EXPECT_TRUE(free(file)) << file;
  for (const fs::path& file :
       {run / "scene.ply", run / "run.json", run / "mesh" / "mesh.ply", run / "selections.json",
        run / "checkpoints" / "new.ply", run / "scene" / "images" / "a.png", base_ / "photos" / "a.png",
        base_ / "scene" / "a.ply", base_ / "link" / "scene.ply", base_ / "scene" / ".." / "run" / "scene.ply"}) {
    EXPECT_FALSE(free(file)) << file;
  }
}

TEST_F(RunFolderTest, ANameThatIsTooLongIsTold) {
  try {
    RunFolder(base_ / std::string(300, 'n')).prepare(RunMode::kNew);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.details().remedy, "use a shorter name");
  }
}

TEST_F(RunFolderTest, AFileIsNoRunFolder) {
  std::ofstream(base_ / "file") << "x";
  EXPECT_EQ(kind_of([&] { RunFolder(base_ / "file").prepare(RunMode::kNew); }), ErrorKind::kUsage);
}

TEST_F(RunFolderTest, OverwriteRemovesTheRunButNotTheSceneOrNotes) {
  const fs::path run = make_run();
  RunFolder(run).prepare(RunMode::kOverwrite);
  EXPECT_FALSE(fs::exists(run / "config.toml"));
  EXPECT_FALSE(fs::exists(run / "checkpoints"));
  EXPECT_TRUE(fs::exists(run / "scene" / "images"));
  EXPECT_TRUE(fs::exists(run / "my notes.txt"));
}

TEST_F(RunFolderTest, ResumeKeepsTheRunAndClearsTemporaryFiles) {
  const fs::path run = make_run();
  std::ofstream(run / "checkpoints" / "step_000002.safetensors.tmp-2147483646-1") << "half";  // no process has it
  RunFolder(run).prepare(RunMode::kResume);
  EXPECT_TRUE(fs::exists(run / "scene.ply"));
  EXPECT_FALSE(fs::exists(run / "checkpoints" / "step_000002.safetensors.tmp-2147483646-1"));
}

TEST_F(RunFolderTest, RecordRoundTripsAndKeepsForeignFields) {
  const fs::path path = base_ / "run.json";
  write_file_atomically(path, R"({"mesh": {"seconds": 3}})");
  RunRecord r;
  r.status = RunStatus::kRunning;
  r.command = "aligngs train \xff";  // not UTF-8
  r.scene = "../scene";
  r.warnings = {"no semantics"};
  r.train.seconds = 1.5;
  r.train.gaussians = 12;
  write_run_record(path, r);
  EXPECT_THAT(read_file(path), testing::HasSubstr("\"mesh\""));
  const RunRecord back = read_run_record(path);
  EXPECT_EQ(back.status, RunStatus::kRunning);
  EXPECT_EQ(back.scene, "../scene");
  EXPECT_EQ(back.warnings, r.warnings);
  EXPECT_EQ(back.train.gaussians, 12u);
  EXPECT_EQ(back.finished, "");
}

TEST_F(RunFolderTest, CountsOfARecordThatAreNoneAreZero) {
  const fs::path path = base_ / "run.json";
  write_file_atomically(path, R"({"seed": 1e308, "train": {"iterations": 2.5, "gaussians": -1}})");
  const RunRecord record = read_run_record(path);
  EXPECT_EQ(record.seed, 0);
  EXPECT_EQ(record.train.iterations, 0);
  EXPECT_EQ(record.train.gaussians, 0u);
}

TEST_F(RunFolderTest, AWordOfARecordThatNobodyKnowsIsUnknown) {
  const fs::path path = base_ / "run.json";
  write_file_atomically(path, R"({"status": "dreaming", "stage": "mesh"})");
  EXPECT_EQ(read_run_record(path).status, RunStatus::kUnknown);
  EXPECT_EQ(read_run_record(path).stage, RunStage::kMesh);
}

TEST_F(RunFolderTest, DamagedRecordIsBadInput) {
  write_file_atomically(base_ / "run.json", "{");
  EXPECT_EQ(kind_of([&] { read_run_record(base_ / "run.json"); }), ErrorKind::kBadInput);
}

TEST_F(RunFolderTest, SceneIsFoundFromAMovedRun) {
  fs::create_directories(base_ / "scene");
  fs::create_directories(base_ / "runs" / "a");
  const std::string relative = relative_scene_path(base_ / "runs" / "a", base_ / "scene");
  EXPECT_EQ(relative, "../../scene");
  RunRecord r;
  r.scene = relative;
  EXPECT_EQ(scene_of_run(base_ / "runs" / "a", r), fs::canonical(base_ / "scene"));
  fs::create_directory_symlink(base_ / "runs" / "a", base_ / "link");
  EXPECT_EQ(scene_of_run(base_ / "link", r), fs::canonical(base_ / "scene"));
  EXPECT_EQ(scene_of_run(base_ / "runs" / "a", r, "/elsewhere"), "/elsewhere");
}

TEST_F(RunFolderTest, EventsBeyondTheCheckpointAreCutOnResume) {
  const fs::path path = base_ / "events.ndjson";
  {
    EventLog log(path, 0);
    StepReport report;
    for (int64_t step = 10; step <= 40; step += 10) log.step({step, "view", &report, 5, 0.1});
  }
  std::ofstream(path, std::ios::app) << "{\"step\": 45, \"los";  // killed while writing
  EventLog log(path, 20);
  log.message(25, "note", "again");
  const std::string text = read_file(path);
  EXPECT_THAT(text, testing::HasSubstr("\"step\":20"));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("\"step\":30")));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("\"los\n")));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
}

TEST_F(RunFolderTest, EventsStayJsonWithNonFiniteLosses) {
  EventLog log(base_ / "events.ndjson", 0);
  StepReport report;
  report.losses.total = std::numeric_limits<double>::quiet_NaN();
  log.step({1, "view", &report, 5, 0.1});
  EXPECT_THAT(read_file(base_ / "events.ndjson"), testing::HasSubstr("\"total\":null"));
}

}  // namespace
}  // namespace aligngs
