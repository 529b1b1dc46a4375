#include "edit/edit_change.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "edit/edit_change_file.h"
#include "edit/edit_independence.h"
#include "edit/testing/small_room.h"
#include "io/gzip.h"

namespace aligngs {
namespace {

EditOperation edit_with_details(EditKind kind, const std::string& select, bool fill = false) {
  EditOperation edit = small_room::edit_of(kind, select, fill);
  edit.color = {46, 139, 87};
  edit.motion.shift = {0.3, 0, 0};
  return edit;
}

class EditChangeTest : public testing::Test {
 protected:
  EditChangeTest() : room_(small_room::make(pool_)) {
    Camera camera;
    camera.width = camera.height = 64;
    camera.fx = camera.fy = 50;
    camera.cx = camera.cy = 32;
    camera.world_to_camera.translation = {0, 0.5, 2.5};
    room_.cameras.push_back(camera);
  }
  /// Makes an edit of the room as it is now; the room has it afterwards.
  EditChange made(const EditOperation& edit, uint32_t number) {
    EditableRoom after = room_;
    const EditReport report = apply_edit(after, edit, pool_);
    const EditChange change = difference(room_, after, edit, report, number, 7);
    EXPECT_TRUE(apply_change(room_, change));
    const size_t probable = room_.gaussians.soft.size();
    EXPECT_TRUE(probable == 0 || probable == room_.gaussians.model.size()) << "a row for every Gaussian, or none";
    edited_ = std::move(after);
    return change;
  }
  ThreadPool pool_{2};
  EditableRoom room_, edited_;  ///< with changes applied; as apply_edit left it
};

void expect_same_room(const EditableRoom& a, const EditableRoom& b) {
  EXPECT_EQ(a.gaussians.model.positions, b.gaussians.model.positions);
  EXPECT_EQ(a.gaussians.model.rotations, b.gaussians.model.rotations);
  EXPECT_EQ(a.gaussians.model.sh, b.gaussians.model.sh);
  EXPECT_EQ(a.gaussians.labels.label, b.gaussians.labels.label);
  EXPECT_EQ(a.gaussians.labels.instance, b.gaussians.labels.instance);
  EXPECT_EQ(a.mesh.vertices.size(), b.mesh.vertices.size());
  EXPECT_EQ(a.mesh.triangles.size(), b.mesh.triangles.size());
  EXPECT_EQ(a.mesh.colors, b.mesh.colors);
}

TEST_F(EditChangeTest, EveryKindOfEditIsWhatItsChangeSays) {
  uint32_t number = 0;
  for (const EditOperation& edit :
       {edit_with_details(EditKind::kRecolor, "pillow#1"), edit_with_details(EditKind::kHighlight, "box"),
        edit_with_details(EditKind::kDuplicate, "pillow#2"), edit_with_details(EditKind::kMove, "pillow#1", true),
        edit_with_details(EditKind::kDelete, "box", true), edit_with_details(EditKind::kExtract, "pillow, floor")}) {
    SCOPED_TRACE(describe(edit));
    made(edit, ++number);
    expect_same_room(room_, edited_);
    for (size_t i = 1; i < room_.origins.size(); ++i) ASSERT_LT(room_.origins[i - 1].id, room_.origins[i].id);
  }
}

TEST_F(EditChangeTest, TheFileReadsBackAndDoesTheSame) {
  const EditableRoom before = room_;
  for (const EditOperation& edit :
       {edit_with_details(EditKind::kRecolor, "pillow"), edit_with_details(EditKind::kMove, "box", true)}) {
    SCOPED_TRACE(describe(edit));
    room_ = before;
    const EditChange change = made(edit, 1);
    const std::string bytes = encode_change(change);
    const EditChange back = decode_change(bytes, "0001.edit");
    EXPECT_EQ(encode_change(back), bytes);
    EditableRoom again = before;
    ASSERT_TRUE(apply_change(again, back));
    expect_same_room(again, room_);
  }
}

TEST_F(EditChangeTest, ARecolouringIsSmall) {
  const EditChange change = made(edit_with_details(EditKind::kRecolor, "floor"), 1);
  ASSERT_TRUE(change.colors);
  EXPECT_GT(change.colors->rows.size(), 1000u);
  EXPECT_LT(encode_change(change).size(), 16 * change.colors->rows.size()) << "no colours are stored";
}

TEST_F(EditChangeTest, DamagedFilesAreRefusedByName) {
  const std::string good = encode_change(made(edit_with_details(EditKind::kDelete, "box", true), 1));
  std::string flipped = good;
  flipped[good.size() / 2] = static_cast<char>(flipped[good.size() / 2] ^ 1);
  for (const std::string& bad : {std::string(), std::string("nonsense"), good.substr(0, good.size() / 2), flipped}) {
    try {
      decode_change(bad, "0001-x.edit");
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      EXPECT_THAT(error.what(), testing::HasSubstr("0001-x.edit"));
    }
  }
}

TEST_F(EditChangeTest, CountsThatAreNoneAreRefused) {
  const std::string bytes = encode_change(made(edit_with_details(EditKind::kDelete, "box", true), 1));
  const std::string text = gzip_expanded(bytes, "1.edit", 1 << 30);
  const size_t line = text.find('\n');
  for (const char* const count : {"removed", "triangles"}) {
    nlohmann::json head = nlohmann::json::parse(text.substr(0, line));
    for (const double damage : {1e308, 2.5, -1.0}) {
      head["counts"][count] = damage;
      EXPECT_THROW(decode_change(gzip_compressed(head.dump() + text.substr(line), 1), "1.edit"), Error) << damage;
    }
  }
}

TEST_F(EditChangeTest, AChangeOfRowsThatAreNotThereChangesNothing) {
  const EditableRoom before = room_;
  const EditChange change = made(edit_with_details(EditKind::kDelete, "box"), 1);
  const EditableRoom once = room_;
  EXPECT_FALSE(apply_change(room_, change)) << "the box is gone already";
  expect_same_room(room_, once);
}

TEST_F(EditChangeTest, AnotherTrainingHasAnotherDigest) {
  const uint64_t digest = room_digest(room_);
  EXPECT_EQ(room_digest(room_), digest);
  room_.gaussians.model.positions[5] += 1e-6f;
  EXPECT_NE(room_digest(room_), digest);
}

TEST_F(EditChangeTest, EditsOfThingsThatAreApartAreIndependent) {
  const EditChange first = made(edit_with_details(EditKind::kDelete, "pillow#2"), 1),
                   second = made(edit_with_details(EditKind::kRecolor, "box"), 2);
  EXPECT_TRUE(is_independent(first, second));
}

TEST_F(EditChangeTest, AnEditThatFollowsFromAnotherIsNot) {
  const EditableRoom before = room_;
  const auto follows = [&](const EditOperation& first, const EditOperation& second) {
    room_ = before;
    const EditChange a = made(first, 1), b = made(second, 2);
    return !is_independent(a, b);
  };
  EXPECT_TRUE(follows(edit_with_details(EditKind::kDuplicate, "box"), edit_with_details(EditKind::kDelete, "box#2")))
      << "its rows";
  EXPECT_TRUE(
      follows(edit_with_details(EditKind::kDelete, "pillow#1"), edit_with_details(EditKind::kRecolor, "pillow")))
      << "the pillow comes back without colour";
  EXPECT_TRUE(follows(edit_with_details(EditKind::kRecolor, "box"), edit_with_details(EditKind::kRecolor, "box")))
      << "its colours";
  EXPECT_TRUE(
      follows(edit_with_details(EditKind::kRecolor, "floor"), edit_with_details(EditKind::kDelete, "box", true)))
      << "the fill has the colour of the floor";
  EXPECT_TRUE(follows(edit_with_details(EditKind::kDelete, "pillow#1"),
                      edit_with_details(EditKind::kExtract, "everything but floor")))
      << "asks for all";
  EXPECT_FALSE(
      follows(edit_with_details(EditKind::kRecolor, "pillow#1"), edit_with_details(EditKind::kDelete, "pillow#2")));
}

TEST(ChangeName, IsANumberAndADigest) {
  EXPECT_TRUE(is_change_name("0001-0123456789abcdef.edit"));
  for (const char* bad : {"", "0001-0123456789abcde.edit", "../1-0123456789abcdef.edit", "0001-0123456789abcdeg.edit",
                          "0001-0123456789abcdef.json", "-0123456789abcdef.edit"}) {
    EXPECT_FALSE(is_change_name(bad)) << bad;
  }
}

}  // namespace
}  // namespace aligngs
