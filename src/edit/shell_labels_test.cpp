#include "edit/shell_labels.h"

#include <gmock/gmock.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

class ShellLabelsTest : public testing::Test {
 protected:
  ShellLabelsTest() : room_(small_room::make(pool_)) {}

  /// Gives Gaussians of a class between two heights over the floor another label.
  size_t relabel(int from, float lowest, float highest, int to) {
    size_t count = 0;
    GaussianLabels& labels = room_.gaussians.labels;
    for (size_t i = 0; i < labels.label.size(); ++i) {
      const float height = -room_.gaussians.model.positions[3 * i + 1];
      if (labels.label[i] != from || height < lowest || height > highest) continue;
      labels.label[i] = static_cast<uint16_t>(to);
      labels.instance[i] = to == kNoLabel ? 0 : 1;
      ++count;
    }
    return count;
  }
  size_t correct(int threads = 2) {
    ThreadPool pool(threads);
    RoomTree tree(room_.gaussians.model);
    return correct_shell_labels(room_.gaussians, room_.labels, room_.cameras, pool, tree);
  }
  ThreadPool pool_{2};
  EditableRoom room_;
};

TEST_F(ShellLabelsTest, FloorThatStandsOnTheFloorJoinsTheThingThere) {
  const size_t box = small_room::count_label(room_, small_room::kBox);
  ASSERT_GT(relabel(small_room::kBox, 0.1f, 0.25f, small_room::kFloor), 50u);
  correct();
  EXPECT_EQ(small_room::count_label(room_, small_room::kBox), box);
}

TEST_F(ShellLabelsTest, TheFloorItselfStays) {
  const size_t floor = small_room::count_label(room_, small_room::kFloor);
  correct();
  EXPECT_EQ(small_room::count_label(room_, small_room::kFloor), floor);
}

TEST_F(ShellLabelsTest, WithoutAFloorNothingChanges) {
  relabel(small_room::kFloor, -1, 1, kNoLabel);
  const std::vector<uint16_t> before = room_.gaussians.labels.label;
  EXPECT_EQ(correct(), 0u);
  EXPECT_EQ(room_.gaussians.labels.label, before);
}

TEST_F(ShellLabelsTest, AnyNumberOfThreadsGivesTheSameLabels) {
  relabel(small_room::kBox, 0.1f, 0.25f, small_room::kFloor);
  const GaussianLabels before = room_.gaussians.labels;
  correct(1);
  const std::vector<uint16_t> one = room_.gaussians.labels.label;
  room_.gaussians.labels = before;
  correct(4);
  EXPECT_EQ(room_.gaussians.labels.label, one);
}

}  // namespace
}  // namespace aligngs
