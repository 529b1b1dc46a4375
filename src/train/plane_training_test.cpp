// Runs whose planes are fitted in the loop, on the box room.
#include <gtest/gtest.h>

#include "io/atomic_file.h"
#include "train/run_folder.h"
#include "train/testing/resumed_runs.h"
#include "train/testing/room_scene.h"

namespace aligngs {
namespace {

class PlaneTraining : public box_room::RoomTraining {
 protected:
  TrainOptions options(const std::string& run, const std::string& weight = "1") const {
    TrainOptions o = run_of(run, 24);
    o.config.sets = {"checkpoint.every=10", "train.reference_iterations=240", "loss.plane_every=80",
                     "loss.plane_weight=" + weight, "loss.depth_align_every=110"};
    return o;
  }
  static std::string ply(const TrainOptions& o) { return read_file(RunFolder(o.run).scene_ply()); }
};

TEST_F(PlaneTraining, SaysWhatItFittedAndChangesTheResult) {
  const TrainOptions with = options("with"), without = options("without", "0");
  train_run(with);
  train_run(without);
  EXPECT_NE(read_file(RunFolder(with.run).events()).find("planes of walls, floor and ceiling under"),
            std::string::npos);
  EXPECT_FALSE(ply(with) == ply(without));
}

TEST_F(PlaneTraining, KilledBetweenFitsAndResumedEndsByteIdentical) {
  const TrainOptions whole = options("whole");
  train_run(whole);
  // fits at 8 and 16, checkpoints at 10 and 20
  test_train::expect_resumes(whole, [&](const std::string& name) { return options(name); }, {}, {9, 13, 22});
}

}  // namespace
}  // namespace aligngs
