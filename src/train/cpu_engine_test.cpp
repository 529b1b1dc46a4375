// The whole of train_run with the real engine, on a scene of a few hundred pixels.
#include <gtest/gtest.h>

#include "core/log.h"
#include "core/stop_signal.h"
#include "io/atomic_file.h"
#include "scene/testing/scene_folder.h"
#include "train/run_folder.h"
#include "train/testing/resumed_runs.h"
#include "train/testing/textured_scene.h"
#include "train/train_run.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using test_train::expect_resumes;

class TrainOnCpu : public testing::Test {
 protected:
  void SetUp() override {
    set_log_level(LogLevel::kSilent);
    clear_stop_request();
    static const fs::path scene = test_train::write_textured_scene("textured");
    scene_ = scene;
    base_ = test_scene::fresh_folder("runs");
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  TrainOptions options(const std::string& run, const std::string& preset, int threads = 1) const {
    TrainOptions o;
    o.scene = scene_;
    o.run = base_ / run;
    o.config.preset = preset;
    o.config.iterations = 42;
    // Everything that changes state happens within 42 iterations: density control, free space, alignment, coupling.
    o.config.sets = {"checkpoint.every=10",
                     "train.reference_iterations=420",
                     "densify.every=60",
                     "densify.start=60",
                     "densify.min_epochs=0",
                     "densify.stop=350",
                     "densify.free_space_every=130",
                     "loss.depth_align_every=110",
                     "loss.normal_start=50",
                     "loss.multi_view_from=60",
                     "loss.depth_start=20",
                     "semantic.coupling_start=50",
                     "semantic.coupling_stop=380",
                     "densify.opacity_reset_every=200",
                     "train.sh_every=100"};
    o.progress.enabled = false;
    o.threads = threads;
    return o;
  }
  static std::string ply(const TrainOptions& o) { return read_file(RunFolder(o.run).scene_ply()); }

  fs::path scene_, base_;
};

TEST_F(TrainOnCpu, KilledAnywhereAndResumedEndsByteIdentical) {
  for (const char* preset : {"default", "paper", "pgsr"}) {
    const auto resetting = [&](const std::string& name) {
      TrainOptions o = options(name, preset);
      o.config.sets.push_back("optimizer.opacity=2");  // recovers within the 22 steps after a reset
      return o;
    };
    const TrainOptions whole = resetting(std::string(preset) + "_whole");
    train_run(whole);
    EXPECT_NE(read_file(RunFolder(whole.run).events()).find("opacity_reset"), std::string::npos);
    expect_resumes(whole, resetting);
  }
}

TEST_F(TrainOnCpu, RowsInMortonOrderResumeByteIdentical) {
  const auto ordered = [&](const std::string& name, int threads) { return options(name, "default", threads); };
  const TrainOptions whole = ordered("ordered", 1);
  TrainOptions plain = options("plain", "default");
  plain.config.sets.push_back("densify.morton_order=false");
  train_run(whole);
  train_run(plain);
  EXPECT_FALSE(ply(whole) == ply(plain));
  expect_resumes(whole, [&](const std::string& run) { return ordered(run, 2); });
}

TEST_F(TrainOnCpu, MovedCamerasResumeByteIdentical) {
  const auto moving = [&](const std::string& name, int threads) {
    TrainOptions o = options(name, "default", threads);
    for (const char* set :
         {"optimizer.pose_rotation=3e-4", "optimizer.pose_translation=3e-4", "optimizer.pose_start=50"}) {
      o.config.sets.emplace_back(set);
    }
    return o;
  };
  const TrainOptions whole = moving("moving", 1);
  train_run(whole);
  train_run(options("still", "default"));
  const std::string cameras = read_file(whole.run / "cameras.json");
  EXPECT_NE(cameras, read_file(base_ / "still" / "cameras.json"));
  expect_resumes(
      whole, [&](const std::string& run) { return moving(run, 2); },
      [&](const TrainOptions& o) { EXPECT_EQ(read_file(o.run / "cameras.json"), cameras) << o.run; });
}

TEST_F(TrainOnCpu, McmcGrowthWithAFloorOfScalesResumesByteIdentical) {
  const auto growing = [&](const std::string& name, int threads) {
    TrainOptions o = options(name, "default", threads);
    for (const char* set : {"densify.strategy=mcmc", "optimizer.scale_min_pixels=0.7", "densify.max_growth=3"}) {
      o.config.sets.emplace_back(set);
    }
    return o;
  };
  const TrainOptions whole = growing("mcmc", 1);
  TrainOptions without = options("without", "default");
  without.config.sets.emplace_back("densify.enabled=false");
  const TrainResult grown = train_run(whole), start = train_run(without);
  EXPECT_GT(grown.gaussians, start.gaussians);
  expect_resumes(whole, [&](const std::string& run) { return growing(run, 2); });
}

TEST_F(TrainOnCpu, MultiViewTermsActAndAreLogged) {
  TrainOptions o = options("pgsr", "pgsr");
  o.config.sets.push_back("train.log_every=1");
  train_run(o);
  const std::string events = read_file(RunFolder(o.run).events());
  const auto is_zero = [&](int step) {
    const size_t begin = events.find("\"step\":" + std::to_string(step) + ",");
    const std::string line = events.substr(begin, events.find('\n', begin) - begin);
    EXPECT_NE(line.find("\"multi_view_geometric\":"), std::string::npos) << line;
    return line.find("\"multi_view_geometric\":0.0,") != std::string::npos;
  };
  EXPECT_TRUE(is_zero(6));
  for (int step = 7; step < 20; ++step) EXPECT_FALSE(is_zero(step)) << step;
}

TEST_F(TrainOnCpu, CoarseStepsResumeByteIdentical) {
  const auto coarse = [&](const std::string& name) {
    TrainOptions o = options(name, "default");
    o.config.sets.push_back("train.coarse_scale=0.5");
    o.config.sets.push_back("train.coarse_stop=200");  // steps 1 to 20
    return o;
  };
  const TrainOptions whole = coarse("coarse"), fine = options("fine", "default");
  train_run(whole);
  train_run(fine);
  EXPECT_FALSE(ply(whole) == ply(fine));
  EXPECT_NE(read_file(RunFolder(whole.run).events()).find("views at 1 of the working resolution"), std::string::npos);
  expect_resumes(whole, coarse, {}, {15, 20, 21});  // checkpoints exist at 10 and 20
}

TEST_F(TrainOnCpu, ResultDoesNotDependOnThreads) {
  const TrainOptions one = options("one", "default", 1), three = options("three", "default", 3);
  train_run(one);
  train_run(three);
  EXPECT_TRUE(ply(one) == ply(three));
}

TEST_F(TrainOnCpu, ShortRunsEndAsIfThereWereNoOpacityResets) {
  for (const char* preset : {"paper", "pgsr"}) {
    TrainOptions brief = options(std::string("brief_") + preset, preset),
                 never = options(std::string("never_") + preset, preset);
    brief.config.iterations = never.config.iterations = 60;
    brief.config.sets.clear();
    never.config.sets = {"densify.opacity_reset_every=0"};
    train_run(brief);
    train_run(never);
    EXPECT_TRUE(ply(brief) == ply(never)) << preset;
  }
}

TEST_F(TrainOnCpu, TrainingImprovesThePicture) {
  TrainOptions brief = options("brief", "default"), longer = options("longer", "default");
  brief.config = {};
  brief.config.iterations = 2;
  longer.config = {};
  longer.config.iterations = 150;
  EXPECT_GT(train_run(longer).psnr, train_run(brief).psnr + 3);
}

}  // namespace
}  // namespace aligngs
