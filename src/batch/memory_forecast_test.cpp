#include "batch/memory_forecast.h"

#include <gtest/gtest.h>

#include "io/image_file.h"
#include "pipeline/room_memory.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kGigabyte = 1'000'000'000;

class MemoryForecast : public testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::path(testing::TempDir()) / "forecast";
    fs::remove_all(base_);
    for (const char* name : {"a.png", "b.png"}) {
      fs::create_directories(base_ / "photos");
      write_png(base_ / "photos" / name, Image<uint8_t>(40, 30, 3));
    }
    batch_.list = base_ / "rooms.tsv";
  }
  uint64_t predicted(const std::string& source, std::vector<std::string> options = {}) const {
    RoomEntry room;
    room.name = "room";
    room.source = source;
    room.options = std::move(options);
    return predicted_room_bytes(BatchFolder(base_ / "out"), batch_, room);
  }

  fs::path base_;
  Batch batch_;
};

TEST_F(MemoryForecast, CountsThePixelsOfTheSource) {
  EXPECT_EQ(predicted("photos", {"--method", "colmap", "--semantics", "none"}), estimated_training_bytes(2 * 40 * 30));
}

TEST_F(MemoryForecast, PhotosWithoutCamerasMayNeedANetwork) {
  EXPECT_GT(predicted("photos"), 6 * kGigabyte);
  fs::create_directories(base_ / "photos" / "sparse");
  EXPECT_EQ(predicted("photos"), estimated_training_bytes(2 * 40 * 30));
}

TEST_F(MemoryForecast, KnowsTheSizeOfASyntheticRoom) {
  EXPECT_EQ(predicted("demo", {"--size", "64x48", "--views", "10"}), estimated_training_bytes(64 * 48 * 10));
}

TEST_F(MemoryForecast, TheRoomsOwnLimitCounts) { EXPECT_EQ(predicted("photos", {"--memory", "2.5"}), 2'500'000'000u); }

TEST(MemoryShare, IsAnEqualPartUnlessARoomNeedsMore) {
  EXPECT_EQ(memory_share(kGigabyte, 8 * kGigabyte, 4), 2 * kGigabyte);
  EXPECT_EQ(memory_share(3 * kGigabyte, 8 * kGigabyte, 4), 3 * kGigabyte);
  EXPECT_EQ(memory_share(9 * kGigabyte, 8 * kGigabyte, 4), 8 * kGigabyte);
}

}  // namespace
}  // namespace aligngs
