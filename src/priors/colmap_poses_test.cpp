#include "priors/colmap_poses.h"

#include <gmock/gmock.h>

#include <optional>
#include <utility>

#include "core/log.h"
#include "io/atomic_file.h"
#include "priors/testing/fake_colmap.h"
#include "priors/testing/from_photos.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

class ColmapAttempts : public FromPhotos {
 protected:
  void SetUp() override {
    FromPhotos::SetUp();
    three_photos();
    options.method = PosesMethod::kColmap;
    program.emplace(folder);
  }
  std::optional<FakeColmap> program;
};

TEST_F(ColmapAttempts, ASecondAttemptThatAbortsLeavesTheFirst) {
  write_photo("d.jpg", 120, 90);
  EXPECT_EQ(make().placed, 3u);
}

TEST_F(ColmapAttempts, TheWarningNamesTheFailureOfTheSecondAttempt) {
  write_photo("d.jpg", 120, 90);
  set_log_level(LogLevel::kWarning);
  testing::internal::CaptureStderr();
  make();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("the second attempt failed"));
}

TEST_F(ColmapAttempts, TheLogOfTheSecondAttemptStays) {
  write_photo("d.jpg", 120, 90);
  make();
  size_t logs = 0, others = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().string().find("scene.work-") == std::string::npos || entry.is_directory()) continue;
    ++(entry.path().filename() == "colmap.log" ? logs : others);
  }
  EXPECT_EQ(std::make_pair(logs, others), std::make_pair(size_t(1), size_t(0)));
}

TEST_F(ColmapAttempts, APhotoThatIsTooNarrowIsLeftOutWithItsSide) {
  write_photo("e.jpg", 120, kLeastColmapSide - 1);
  const ScenePhotosReport report = make();
  ASSERT_EQ(report.unplaced.size(), 1u);
  EXPECT_EQ(report.unplaced[0].reason, "its shorter side has 15 pixels, and COLMAP needs 16");
}

TEST_F(ColmapAttempts, ColmapDoesNotSeeAPhotoThatIsTooNarrow) {
  write_photo("e.jpg", 120, kLeastColmapSide - 1);
  make();
  EXPECT_EQ(read_file(folder / "seen.txt"), "a.jpg\nb.jpg\nc.jpg\n");
}

}  // namespace
}  // namespace aligngs
