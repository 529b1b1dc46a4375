#include "edit/replace_object.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "core/error.h"
#include "edit/edit_change_file.h"
#include "edit/export/moved_room.h"
#include "edit/testing/small_room.h"
#include "gaussians/gaussian_ply.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// A block of 0.2 x 0.3 x 0.4 m as a file of splats: x to the right, z up, its front to -y.
GaussianModel block() {
  GaussianModel model;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      for (int k = 0; k < 6; ++k) {
        const auto at = [](int step, float size) { return static_cast<float>(step) * size / 5; };
        small_room::add_gaussian(model, {5 + at(i, 0.2f), 7 + at(j, 0.3f), 9 + at(k, 0.4f)}, {0, 0, 1},
                                 {0.9f, 0.1f, 0.1f}, -1);
      }
    }
  }
  model.sh_degree = 3;
  return model;
}

class ReplaceObject : public testing::Test {
 protected:
  ReplaceObject() : room_(small_room::make(pool_)), folder_(fs::path(testing::TempDir()) / "replace_object") {
    fs::create_directories(folder_);
    file_ = (folder_ / "block.ply").string();
    write_gaussian_ply(file_, block());
  }
  EditOperation replacement(bool fit = false, double turn = 0) {
    EditOperation edit = small_room::edit_of(EditKind::kReplace, "box");
    edit.with = file_;
    edit.fit = fit;
    edit.motion.turn = turn;
    edit.object = std::make_shared<const InsertedObject>(read_inserted_object(file_, UpAxis::kZ, pool_));
    return edit;
  }
  /// Box around the Gaussians that an edit put in.
  std::pair<Vec3f, Vec3f> box_of_inserted(const EditReport& report) const {
    Vec3f low{1e9f, 1e9f, 1e9f}, high{-1e9f, -1e9f, -1e9f};
    const GaussianModel& m = room_.gaussians.model;
    for (size_t i = m.size() - report.inserted; i < m.size(); ++i) {
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], m.positions[3 * i + static_cast<size_t>(a)]);
        high[a] = std::max(high[a], m.positions[3 * i + static_cast<size_t>(a)]);
      }
    }
    return {low, high};
  }
  ThreadPool pool_{2};
  EditableRoom room_;
  fs::path folder_;
  std::string file_;
};

TEST_F(ReplaceObject, ItStandsWhereTheOldOneStoodInItsOwnSize) {
  const EditReport report = apply_edit(room_, replacement(), pool_);
  const auto [low, high] = box_of_inserted(report);
  EXPECT_EQ(report.inserted, 216u);
  EXPECT_NEAR(high.y, 0, 0.03) << "up is -y, and the floor is at 0";
  EXPECT_NEAR(high.y - low.y, 0.4, 1e-4) << "metres stay metres";
  EXPECT_NEAR(0.5 * (low.x + high.x), 0, 0.03);
  EXPECT_NEAR(0.5 * (low.z + high.z), 0.4, 0.03);
  EXPECT_EQ(small_room::count_label(room_, small_room::kBox), 216u) << "the old one is gone";
}

TEST_F(ReplaceObject, FittedItHasTheHeightOrTheWidthOfTheOldOne) {
  const auto [low, high] = box_of_inserted(apply_edit(room_, replacement(true), pool_));
  EXPECT_NEAR(high.y - low.y, 0.4, 0.03);
  EXPECT_LE(high.x - low.x, 0.43);
}

TEST_F(ReplaceObject, AQuarterTurnSwapsWidthAndDepth) {
  EditableRoom other = room_;
  const auto straight = box_of_inserted(apply_edit(room_, replacement(), pool_));
  std::swap(room_, other);
  const auto turned = box_of_inserted(apply_edit(room_, replacement(false, 90), pool_));
  EXPECT_NEAR(straight.second.x - straight.first.x, turned.second.z - turned.first.z, 1e-3);
}

TEST_F(ReplaceObject, WithoutAClassItHasThatOfTheOldOneAndANumberOfItsOwn) {
  const EditReport report = apply_edit(room_, replacement(), pool_);
  ASSERT_TRUE(report.replacement);
  EXPECT_EQ(report.replacement->label, small_room::kBox);
  EXPECT_EQ(report.replacement->instance, 2);
}

TEST_F(ReplaceObject, AClassOfTheFileIsKept) {
  GaussianLabels labels;
  labels.label_set = ade20k_labels().name;
  labels.label.assign(216, small_room::kPillow);
  labels.instance.assign(216, 4);
  labels.confidence.assign(216, 200);
  write_labelled_gaussian_ply(file_, block(), labels);
  const EditReport report = apply_edit(room_, replacement(), pool_);
  ASSERT_TRUE(report.replacement);
  EXPECT_EQ(report.replacement->label, small_room::kPillow);
  EXPECT_EQ(report.replacement->instance, 3) << "two pillows are there";
}

TEST_F(ReplaceObject, HarmonicsBeyondTheRoomsDegreeAreGone) {
  InsertedObject object = read_inserted_object(file_, UpAxis::kZ, pool_);
  for (float& v : object.room.gaussians.model.sh) v = 1;
  room_.gaussians.model.sh_degree = 1;
  const std::vector<uint8_t> selected(room_.origins.size(), 1);
  const GaussianModel model = labelled_for(room_, selected, object).gaussians.model;
  EXPECT_EQ(model.sh[3 * 3], 1) << "of degree 1";
  EXPECT_EQ(model.sh[3 * 4], 0) << "of degree 2";
}

TEST_F(ReplaceObject, OneThatIsTooLargeForTheRoomGetsAWarning) {
  EXPECT_THAT(apply_edit(room_, replacement(), pool_).warnings, IsEmpty());
  GaussianModel large = block();
  for (float& v : large.positions) v *= 12;
  write_gaussian_ply(file_, large);
  EXPECT_THAT(apply_edit(room_, replacement(), pool_).warnings, Contains(HasSubstr(" out of the room")));
}

TEST_F(ReplaceObject, TheFileOfTheEditHasTheObject) {
  const EditableRoom before = room_;
  const EditOperation edit = replacement();
  const EditReport report = apply_edit(room_, edit, pool_);
  const EditChange change =
      decode_change(encode_change(difference(before, room_, edit, report, 1, room_digest(before))), "1.edit");
  fs::remove(file_);
  const auto stored = inserted_by(change, before);
  ASSERT_TRUE(stored);
  EXPECT_TRUE(stored->placed);
  EXPECT_EQ(stored->room.gaussians.model.size(), 216u);
  EXPECT_EQ(stored->class_name, "box");
  EditOperation again = edit;
  again.object = stored;
  EditableRoom anew = before;
  apply_edit(anew, again, pool_);
  EXPECT_EQ(anew.gaussians.model.positions, room_.gaussians.model.positions);
}

TEST_F(ReplaceObject, OtherEditsHaveNone) {
  const EditableRoom before = room_;
  const EditOperation edit = small_room::edit_of(EditKind::kDelete, "box", true);
  const EditReport report = apply_edit(room_, edit, pool_);
  EXPECT_FALSE(inserted_by(difference(before, room_, edit, report, 1, 0), before));
}

TEST_F(ReplaceObject, FilesBeyondTheBoundsAreRefused) {
  const auto refusal = [&](const GaussianModel& model) -> std::string {
    write_gaussian_ply(file_, model);
    try {
      read_inserted_object(file_, UpAxis::kZ, pool_);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      EXPECT_EQ(error.details().path, file_);
      EXPECT_FALSE(error.details().field.empty());
      EXPECT_FALSE(error.details().remedy.empty());
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(block()), "");
  GaussianModel stray = block(), far = block(), wide = block(), faint = block(), all_wide = block(), offset = block();
  stray.positions[3] = 1e6f;
  EXPECT_THAT(refusal(stray), HasSubstr("Gaussian 1 is 1e+06 units from the middle"));
  for (size_t i = 0; i < far.size(); ++i) far.positions[3 * i] = 1e20f;
  EXPECT_THAT(refusal(far), HasSubstr("32-bit numbers"));
  wide.log_scales[0] = 80;
  EXPECT_THAT(refusal(wide), HasSubstr("Gaussian 0 has a standard deviation"));
  for (float& s : all_wide.log_scales) s = 80;
  EXPECT_THAT(refusal(all_wide), HasSubstr("units large"));
  for (float& o : faint.opacity_logits) o = -20;
  EXPECT_THAT(refusal(faint), HasSubstr("no Gaussian of the file can be seen"));
  for (size_t i = 0; i < offset.size(); ++i) offset.positions[3 * i] += 1000;
  EXPECT_EQ(refusal(offset), "") << "a kilometre away the shape is kept";
}

TEST_F(ReplaceObject, OneGaussianIsAnObject) {
  GaussianModel one = block();
  one.resize(1);
  write_gaussian_ply(file_, one);
  EXPECT_EQ(read_inserted_object(file_, UpAxis::kZ, pool_).room.gaussians.model.size(), 1u);
}

TEST_F(ReplaceObject, BadSourcesAreRefused) {
  const auto kind_of = [&](const std::string& source, const std::string& up = "z") {
    try {
      read_inserted_object(source, parse_axis(up), pool_);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::kFailed;
  };
  EXPECT_EQ(kind_of("nothing"), ErrorKind::kUsage);
  EXPECT_EQ(kind_of("run#"), ErrorKind::kUsage);
  EXPECT_EQ(kind_of((folder_ / "absent.ply").string()), ErrorKind::kUsage);
  EXPECT_EQ(kind_of(file_, "w"), ErrorKind::kUsage);
  EXPECT_EQ(kind_of((folder_ / "absent").string() + "#bed"), ErrorKind::kBadInput);
  const std::string damaged = (folder_ / "damaged.ply").string();
  write_file_atomically(damaged, read_file(file_).substr(0, 3000));
  EXPECT_EQ(kind_of(damaged), ErrorKind::kBadInput);
  write_file_atomically(damaged, "not a ply");
  EXPECT_EQ(kind_of(damaged), ErrorKind::kBadInput);
  write_gaussian_ply(damaged, GaussianModel());
  EXPECT_EQ(kind_of(damaged), ErrorKind::kBadInput) << "no Gaussians";
}

}  // namespace
}  // namespace aligngs
