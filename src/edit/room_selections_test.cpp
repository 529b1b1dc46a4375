#include "edit/room_selections.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/apply_edit.h"
#include "edit/edit_change.h"
#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

using small_room::edit_of;
using testing::HasSubstr;

/// A selection "nook" of the right half of the box, and nothing else.
class RoomSelectionsTest : public testing::Test {
 protected:
  RoomSelectionsTest() : room_(small_room::make(pool_)) {
    const GaussianModel& m = room_.gaussians.model;
    std::vector<uint8_t> rows(m.size(), 0);
    for (size_t i = 0; i < rows.size(); ++i)
      rows[i] = room_.gaussians.labels.label[i] == small_room::kBox && m.positions[3 * i] > 0;
    nook_.name = "nook";
    nook_.scene = gaussians_digest(m);
    nook_.set_rows(rows);
    room_.cameras.emplace_back();
    room_.cameras.back().world_to_camera.translation = {0, 0.5, 2.5};
    know({nook_});
  }
  void know(const std::vector<NamedSelection>& list) {
    room_.selections = std::make_shared<const RoomSelections>(room_selections("selections.json", list, room_));
  }
  std::vector<uint8_t> selected(const std::string& text) {
    return select_gaussians(room_.gaussians, read_selection(room_, text), {}, room_.labels, {}, pool_).mask;
  }
  size_t count(const std::string& text) {
    const std::vector<uint8_t> mask = selected(text);
    return static_cast<size_t>(std::count(mask.begin(), mask.end(), uint8_t(1)));
  }
  ThreadPool pool_{2};
  EditableRoom room_;
  NamedSelection nook_;
};

TEST_F(RoomSelectionsTest, ItIsExactlyWhatWasDrawn) {
  ASSERT_GT(nook_.count(), 50u);
  EXPECT_EQ(selected("Nook"), nook_.mask());
  EXPECT_EQ(selected("the nook"), nook_.mask());
  EXPECT_EQ(selection_text(read_selection(room_, "the NOOK"), room_.labels), "nook");
}

TEST_F(RoomSelectionsTest, ItGoesWithClassesAndExceptions) {
  EXPECT_EQ(count("pillow, nook"), count("pillow") + nook_.count());
  EXPECT_EQ(count("box but nook"), count("box") - nook_.count());
  EXPECT_EQ(count("everything but nook"), room_.gaussians.model.size() - nook_.count());
  EXPECT_THROW(count("nook but box"), Error) << "nothing is left of it";
}

TEST_F(RoomSelectionsTest, ARoomWithoutClassesHasSelectionsToo) {
  room_.gaussians.model.semantic_channels = 0;
  room_.gaussians.model.semantics.clear();
  room_.gaussians.labels.label.assign(room_.gaussians.model.size(), kNoLabel);
  room_.gaussians.labels.instance.assign(room_.gaussians.model.size(), 0);
  know({nook_});
  EXPECT_EQ(selected("nook"), nook_.mask());
  EXPECT_THROW(count("nook, box"), Error);
  const EditReport report = apply_edit(room_, edit_of(EditKind::kDelete, "nook", true), pool_);
  EXPECT_EQ(report.selected, nook_.count());
}

TEST_F(RoomSelectionsTest, EditsOfOtherThingsLeaveItsRows) {
  apply_edit(room_, edit_of(EditKind::kDelete, "pillow#1"), pool_);
  const std::vector<uint8_t> mask = selected("nook"), trained = nook_.mask();
  for (size_t i = 0; i < mask.size(); ++i) EXPECT_EQ(mask[i], trained[room_.origins[i].row]);
  EXPECT_EQ(count("nook"), nook_.count());
}

TEST_F(RoomSelectionsTest, ADeletedSelectionIsGoneAndItsFillIsNotIt) {
  apply_edit(room_, edit_of(EditKind::kDelete, "nook", true), pool_);
  EXPECT_THROW(count("nook"), Error);
}

TEST_F(RoomSelectionsTest, AMovedSelectionIsSelectedWhereItIs) {
  EditOperation move = edit_of(EditKind::kMove, "nook");
  move.motion.shift.y = 1;
  apply_edit(room_, move, pool_);
  const std::vector<uint8_t> mask = selected("nook");
  size_t up = 0;
  for (size_t i = 0; i < mask.size(); ++i) up += mask[i] && room_.gaussians.model.positions[3 * i + 1] < -0.9f;
  EXPECT_EQ(up, nook_.count());
}

TEST_F(RoomSelectionsTest, ACopyIsNotTheSelection) {
  EditOperation copy = edit_of(EditKind::kDuplicate, "nook");
  copy.motion.shift.y = 1;
  apply_edit(room_, copy, pool_);
  EXPECT_EQ(count("nook"), nook_.count());
}

TEST_F(RoomSelectionsTest, ASelectionOfAnotherTrainingIsRefused) {
  nook_.scene ^= 1;
  know({nook_});
  try {
    count("nook");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(error.details().message, HasSubstr("another training"));
    EXPECT_THAT(error.details().remedy, HasSubstr("--remove-selection"));
    EXPECT_EQ(error.details().path, "selections.json");
  }
}

TEST_F(RoomSelectionsTest, AnEditAsksForTheClassesOfTheSelection) {
  EXPECT_EQ(apply_edit(room_, edit_of(EditKind::kHighlight, "nook"), pool_).asked,
            std::vector<uint16_t>{small_room::kBox});
}

TEST_F(RoomSelectionsTest, AMistypedNameIsSuggested) {
  try {
    count("nookk");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.details().remedy, HasSubstr("\"nook\""));
  }
}

}  // namespace
}  // namespace aligngs
