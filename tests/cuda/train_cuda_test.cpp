// Whole trainings with the CUDA engine, on a scene of a few hundred pixels. Tests events between steps, and the files
// left when a training ends in the middle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "core/log.h"
#include "core/stop_signal.h"
#include "device/testing/device.h"
#include "engine/cuda/cuda_engine.h"
#include "io/atomic_file.h"
#include "scene/testing/scene_folder.h"
#include "train/checkpoint.h"
#include "train/run_folder.h"
#include "train/run_record.h"
#include "train/testing/watched_engine.h"
#include "train/train_run.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using test_train::Killed;
using test_train::WatchedEngine;
using testing::HasSubstr;

/// Looks at the engine after each step.
using Look = std::function<void(const StepRequest&, const cuda::CudaEngine&)>;
void look_away(const StepRequest&, const cuda::CudaEngine&) {}

class TrainOnCuda : public testing::Test {
 protected:
  void SetUp() override {
    const cuda::DeviceChoice choice = cuda::test_device();
    if (!choice.cuda) GTEST_SKIP() << choice.message;
    device_ = choice.index;
    set_log_level(LogLevel::kSilent);
    clear_stop_request();
    scene_ = test_scene::write_scene();
    base_ = test_scene::fresh_folder("runs");
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  /// Within 12 iterations everything happens that changes state: density control after 4 and 8, the start of the labels
  /// before 4. Scales of the prior follow after 5, opacity reset after 6, free space after 7.
  TrainOptions options(const std::string& run) const {
    TrainOptions o;
    o.scene = scene_;
    o.run = base_ / run;
    o.config.preset = "default";
    o.config.iterations = 12;
    o.config.sets = {"checkpoint.every=3",
                     "train.reference_iterations=120",
                     "init.max_gaussians=60",
                     "densify.every=40",
                     "densify.start=30",
                     "densify.min_epochs=0",
                     "densify.stop=110",
                     "densify.gradient=1e-9",
                     "densify.residual_quantile=0",
                     "densify.unsupported_min=0",
                     "densify.opacity_reset_every=60",
                     "densify.free_space_every=70",
                     "loss.depth_align_every=50",
                     "loss.normal_start=20",
                     "loss.depth_start=10",
                     "semantic.lift=true",
                     "semantic.lift_at=30",
                     "semantic.coupling_start=40",
                     "semantic.coupling_stop=100",
                     "train.sh_every=40",
                     "train.log_every=1",
                     "optimizer.opacity=3"};  // recovers from the reset within the steps that are left
    o.progress.enabled = false;
    o.threads = 1;
    return o;
  }
  /// Grows from 60 Gaussians to 25 times as many: every one doubles after every second step.
  TrainOptions growing(const std::string& run) const {
    TrainOptions o = options(run);
    for (const char* set : {"densify.every=20", "densify.start=10", "densify.max_growth=25", "densify.prune_opacity=0",
                            "densify.opacity_reset_every=0", "densify.free_space_every=0"}) {
      o.config.sets.push_back(set);
    }
    return o;
  }

  EngineFactory engine(Look look = look_away, uint64_t budget = 0) const {
    return [this, look, budget](int threads) {
      auto cuda = std::make_unique<cuda::CudaEngine>(device_, budget, threads);
      const cuda::CudaEngine& inside = *cuda;
      return std::make_unique<WatchedEngine>(std::move(cuda),
                                             [look, &inside](const StepRequest& request) { look(request, inside); });
    };
  }
  EngineFactory killed_at(int64_t step) const {
    return engine([die = test_train::killed_at(step)](const StepRequest& r, const cuda::CudaEngine&) { die(r); });
  }

  static std::string file(const TrainOptions& o, const char* name) { return read_file(o.run / name); }
  static RunRecord record(const TrainOptions& o) { return read_run_record(RunFolder(o.run).record()); }

  fs::path scene_, base_;
  int device_ = 0;
};

TEST_F(TrainOnCuda, GrowsResetsPrunesAndLeavesACompleteRun) {
  const TrainOptions o = options("whole");
  const TrainResult result = train_run(o, engine());
  EXPECT_EQ(result.iterations, 12);
  EXPECT_GT(result.gaussians, 60u);
  const std::string events = file(o, "events.ndjson");
  for (const char* what : {"\"densify\"", "\"opacity_reset\"", "\"free_space\""}) EXPECT_THAT(events, HasSubstr(what));
  for (const char* name : {"scene.ply", "scene.labels.ply", "checkpoints/step_000012.safetensors"}) {
    EXPECT_TRUE(fs::exists(o.run / name)) << name;
  }
  EXPECT_THAT(record(o).device, HasSubstr("cuda:"));
  EXPECT_TRUE(record(o).warnings.empty());
}

TEST_F(TrainOnCuda, LabelsStartFromTheTeachers) {
  TrainOptions lifted = options("lifted"), plain = options("plain");
  for (TrainOptions* o : {&lifted, &plain}) {
    o->config.iterations = 4;
    o->config.sets.push_back("train.schedule_iterations=12");
    o->config.sets.push_back("densify.enabled=false");
    // they are drawn from the photos anew, wherever rows started
    o->config.sets.push_back("semantic.object_labels=false");
  }
  plain.config.sets.push_back("semantic.lift=false");
  train_run(lifted, engine());
  train_run(plain, engine());
  EXPECT_FALSE(file(lifted, "scene.labels.ply") == file(plain, "scene.labels.ply"));
}

TEST_F(TrainOnCuda, KilledAnywhereAndResumedEndsByteIdentical) {
  const TrainOptions whole = options("whole");
  train_run(whole, engine());
  for (const int64_t at : {2, 5, 11}) {  // before the first checkpoint, between density control and reset, late
    TrainOptions o = options("killed_at_" + std::to_string(at));
    EXPECT_THROW(train_run(o, killed_at(at)), Killed);
    o.resume = true;
    train_run(o, engine());
    EXPECT_TRUE(file(o, "scene.ply") == file(whole, "scene.ply")) << at;
    EXPECT_TRUE(file(o, "scene.labels.ply") == file(whole, "scene.labels.ply")) << at;
  }
}

TEST_F(TrainOnCuda, MultiViewTermsActAndAResumedRunDrawsTheSameNeighbours) {
  const auto with_terms = [&](const char* run) {
    TrainOptions o = options(run);
    for (const char* set : {"loss.multi_view_geometric=0.03", "loss.multi_view_photometric=0.15",
                            "loss.multi_view_from=40", "init.max_gaussians=400", "densify.enabled=false"}) {
      o.config.sets.push_back(set);
    }
    return o;
  };
  const TrainOptions whole = with_terms("whole");
  train_run(whole, engine());
  const std::string events = file(whole, "events.ndjson");
  const auto acts = [&](int step) {
    const size_t begin = events.find("\"step\":" + std::to_string(step) + ",");
    const std::string line = events.substr(begin, events.find('\n', begin) - begin);
    EXPECT_THAT(line, HasSubstr("\"multi_view_geometric\":"));
    return line.find("\"multi_view_geometric\":0.0,") == std::string::npos;
  };
  EXPECT_FALSE(acts(4));
  EXPECT_TRUE(acts(5));
  EXPECT_TRUE(acts(12));
  TrainOptions resumed = with_terms("resumed");
  EXPECT_THROW(train_run(resumed, killed_at(8)), Killed);
  resumed.resume = true;
  train_run(resumed, engine());
  EXPECT_TRUE(file(resumed, "scene.ply") == file(whole, "scene.ply"));
}

TEST_F(TrainOnCuda, OutOfMemoryInTheMiddleLeavesACheckpointToGoOnFrom) {
  // The need of device memory before any growth, and at the end.
  uint64_t early = 0, late = 0;
  const TrainOptions whole = growing("whole");
  train_run(whole, engine([&](const StepRequest& r, const cuda::CudaEngine& e) {
              if (r.step <= 2) early = std::max(early, e.context().peak());
              late = e.context().used();
            }));
  const uint64_t budget = early + (late - early) / 3;
  ASSERT_GT(late, early + (uint64_t(1) << 19)) << "the scene does not grow enough for this test";

  TrainOptions o = growing("small");
  EXPECT_THROW(train_run(o, killed_at(4)), Killed);  // a checkpoint exists at 3
  o.resume = true;
  int64_t last_step = 0;
  try {
    train_run(o, engine([&](const StepRequest& r, const cuda::CudaEngine&) { last_step = r.step; }, budget));
    FAIL() << "it fits";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
    EXPECT_THAT(e.what(), HasSubstr("the device has no room for"));
    EXPECT_THAT(e.details().remedy, HasSubstr("the last checkpoint is valid"));
  }
  EXPECT_GE(last_step, 4);
  EXPECT_LT(last_step, 12);
  EXPECT_EQ(record(o).status, RunStatus::kFailed);
  train_run(o, engine());
  EXPECT_TRUE(file(o, "scene.ply") == file(whole, "scene.ply"));

  // A run that begins on such a device knows it and grows less.
  const TrainOptions fitted = growing("fitted");
  const TrainResult result = train_run(fitted, engine(look_away, budget));
  EXPECT_LT(result.gaussians, record(whole).train.gaussians);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings[0], HasSubstr("growth stops there"));
}

}  // namespace
}  // namespace aligngs
