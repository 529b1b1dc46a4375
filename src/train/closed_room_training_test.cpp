// Runs that close the room after their last step.
#include <gtest/gtest.h>

#include "io/atomic_file.h"
#include "train/run_folder.h"
#include "train/testing/room_scene.h"

namespace aligngs {
namespace {

class ClosedRoomTraining : public box_room::RoomTraining {
 protected:
  /// Events of a run.
  std::string events_of_run(const std::string& closed) const {
    TrainOptions o = run_of("run", 2);
    o.config.sets = {"train.closed_room=" + closed, "densify.enabled=false",  // without growth the start is the cap
                     "init.voxel_footprints=0.3",   "init.gaussians_per_pixel=0",
                     "init.depth_opacity=0.9",      "init.single_view_opacity=0.9"};
    train_run(o);
    return read_file(RunFolder(o.run).events());
  }
};

TEST_F(ClosedRoomTraining, AModelThatGrowthHasFilledUpIsClosedAllTheSame) {
  EXPECT_NE(events_of_run("true").find("Gaussians for walls, floor and ceiling that no photo shows"),
            std::string::npos);
}

TEST_F(ClosedRoomTraining, LeavesTheRoomOpenWhereNotAskedTo) {
  EXPECT_EQ(events_of_run("false").find("that no photo shows"), std::string::npos);
}

}  // namespace
}  // namespace aligngs
