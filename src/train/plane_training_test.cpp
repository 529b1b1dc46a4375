// Runs whose planes are fitted in the loop, on the box room.
#include <gtest/gtest.h>

#include "core/log.h"
#include "core/stop_signal.h"
#include "io/atomic_file.h"
#include "train/resumed_runs_for_tests.h"
#include "train/room_scene_for_tests.h"
#include "train/run_folder.h"
#include "train/train_run.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class PlaneTraining : public testing::Test {
 protected:
  void SetUp() override {
    set_log_level(LogLevel::kSilent);
    clear_stop_request();
    static const fs::path scene = box_room::write_room();
    scene_ = scene;
    base_ = test_scene::fresh_folder("runs");
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  TrainOptions options(const std::string& run, const std::string& weight = "1") const {
    TrainOptions o;
    o.scene = scene_;
    o.run = base_ / run;
    o.config.iterations = 24;
    o.config.sets = {"checkpoint.every=10", "train.reference_iterations=240", "loss.plane_every=80", "loss.plane_weight=" + weight,
                     "train.closed_room=false", "loss.depth_align_every=110"};
    o.progress.enabled = false;
    o.threads = 2;
    return o;
  }
  static std::string ply(const TrainOptions& o) { return read_file(RunFolder(o.run).scene_ply()); }
  fs::path scene_, base_;
};

TEST_F(PlaneTraining, SaysWhatItFittedAndChangesTheResult) {
  const TrainOptions with = options("with"), without = options("without", "0");
  train_run(with);
  train_run(without);
  EXPECT_NE(read_file(RunFolder(with.run).events()).find("planes of walls, floor and ceiling under"), std::string::npos);
  EXPECT_FALSE(ply(with) == ply(without));
}

TEST_F(PlaneTraining, KilledBetweenFitsAndResumedEndsByteIdentical) {
  const TrainOptions whole = options("whole");
  train_run(whole);
  test_train::expect_resumes(whole, [&](const std::string& name) { return options(name); }, {}, {9, 13, 22});  // fits at 8 and 16, checkpoints at 10 and 20
}

}  // namespace
}  // namespace aligngs
