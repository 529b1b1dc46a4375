#include "scene/segment_file.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "scene/testing/scene_folder.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class SegmentFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  ErrorKind kind_of(const fs::path& file, int classes = 150) const {
    try {
      read_segments(file, classes);
    } catch (const Error& error) {
      return error.kind();
    }
    ADD_FAILURE() << "no error";
    return ErrorKind::kFailed;
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / "segment_file";
  const fs::path file_ = folder_ / "a.png";
};

/// A wall, two chairs and a pixel of nothing.
SegmentMap two_chairs() { return {2, 2, {0, 1, 2, SegmentMap::kNone}, {{0, Segment::kStuff}, {19, 0}, {19, 7}}}; }

TEST_F(SegmentFile, KeepsClassesNumbersAndPixels) {
  write_segments(file_, two_chairs());
  const SegmentMap read = read_segments(file_, 150);
  EXPECT_EQ(read.width, 2);
  EXPECT_EQ(read.height, 2);
  EXPECT_EQ(read.of_pixel, two_chairs().of_pixel);
  ASSERT_EQ(read.list.size(), 3u);
  EXPECT_FALSE(read.list[0].is_thing());
  EXPECT_EQ(read.list[2].label, 19);
  EXPECT_EQ(read.list[2].number, 7);
}

TEST_F(SegmentFile, StoresTheDocumentedNumbers) {
  write_segments(file_, two_chairs());
  EXPECT_EQ(read_gray_png(file_).data, (std::vector<uint16_t>{256, 1 + 19 * 256, 1 + 19 * 256 + 7, 0}));
}

TEST_F(SegmentFile, APictureWithoutSegmentsIsRead) {
  write_segments(file_, {1, 1, {SegmentMap::kNone}, {}});
  EXPECT_TRUE(read_segments(file_, 150).list.empty());
}

TEST_F(SegmentFile, AClassThatTheLabelSetHasNotIsRefused) {
  write_segments(file_, two_chairs());
  EXPECT_EQ(kind_of(file_, 19), ErrorKind::kBadInput);
}

TEST_F(SegmentFile, APictureOfEightBitsIsRefused) {
  write_png(file_, Image<uint8_t>(4, 4, 1, 3));
  EXPECT_EQ(kind_of(file_), ErrorKind::kBadInput);
}

TEST_F(SegmentFile, AClassThatDoesNotFitIsNotWritten) {
  SegmentMap map = two_chairs();
  map.list[1] = {255, 255};
  EXPECT_THROW(write_segments(file_, map), Error);
  EXPECT_FALSE(fs::exists(file_));
}

}  // namespace
}  // namespace aligngs
