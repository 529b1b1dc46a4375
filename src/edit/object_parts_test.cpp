#include "edit/object_parts.h"

#include <gmock/gmock.h>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

/// The box of the small room is a pot with a plant on it.
class ObjectParts : public testing::Test {
 protected:
  ObjectParts() : room_(small_room::make(pool_)) {
    GaussianLabels& labels = room_.gaussians.labels;
    for (size_t i = 0; i < labels.label.size(); ++i) {
      if (labels.label[i] != small_room::kBox) continue;
      labels.label[i] = -room_.gaussians.model.positions[3 * i + 1] > 0.2f ? static_cast<uint16_t>(plant_)
                                                                           : static_cast<uint16_t>(pot_);
    }
  }
  std::vector<Instance> parts(int label) const {
    std::vector<uint8_t> selected;
    for (const uint16_t l : room_.gaussians.labels.label) selected.push_back(l == label);
    return parts_of(room_.gaussians, selected, room_.labels, room_.up);
  }
  ThreadPool pool_{2};
  EditableRoom room_;
  const int plant_ = ade20k_labels().find("plant"), pot_ = ade20k_labels().find("pot");
};

TEST_F(ObjectParts, ThePotBelongsToThePlant) {
  ASSERT_EQ(parts(plant_).size(), 1u);
  EXPECT_EQ(parts(plant_)[0].label, pot_);
}

TEST_F(ObjectParts, ThePlantDoesNotBelongToThePot) { EXPECT_TRUE(parts(pot_).empty()); }

TEST_F(ObjectParts, AFewSelectedLeavesAreNoPlant) {
  std::vector<uint8_t> selected(room_.gaussians.labels.label.size(), 0);
  size_t leaves = 0;
  const size_t third = small_room::count_label(room_, static_cast<int>(plant_)) / 3;
  for (size_t i = 0; i < selected.size(); ++i) {
    selected[i] = room_.gaussians.labels.label[i] == plant_ && leaves++ < third;
  }
  EXPECT_TRUE(parts_of(room_.gaussians, selected, room_.labels, room_.up).empty());
}

TEST_F(ObjectParts, APotThatIsNotTouchedStays) {
  for (size_t i = 0; i < room_.gaussians.labels.label.size(); ++i) {
    if (room_.gaussians.labels.label[i] == pot_) room_.gaussians.model.positions[3 * i] += 0.5f;
  }
  EXPECT_TRUE(parts(plant_).empty());
}

TEST_F(ObjectParts, DeletingAPlantTakesItsPot) {
  const EditReport report = apply_edit(room_, small_room::edit_of(EditKind::kDelete, "plant"), pool_);
  ASSERT_EQ(report.parts.size(), 1u);
  EXPECT_EQ(small_room::count_label(room_, pot_), 0u);
}

TEST_F(ObjectParts, APotThatIsExceptedStays) {
  const size_t before = small_room::count_label(room_, pot_);
  const EditReport report =
      apply_edit(room_, small_room::edit_of(EditKind::kDelete, "the plant but not the pot"), pool_);
  EXPECT_TRUE(report.parts.empty());
  EXPECT_GT(small_room::count_label(room_, pot_), before / 2);
}

TEST_F(ObjectParts, PaintingAPlantLeavesItsPot) {
  const EditReport report = apply_edit(room_, small_room::edit_of(EditKind::kRecolor, "plant"), pool_);
  EXPECT_TRUE(report.parts.empty());
  EXPECT_EQ(report.selected, small_room::count_label(room_, plant_));
}

}  // namespace
}  // namespace aligngs
