#include "refine/measured_scene.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "core/log.h"
#include "io/atomic_file.h"
#include "io/npy.h"
#include "refine/testing/wall_photos.h"
#include "scene/scene_writer.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using namespace wall_photos;

/// A scene folder of photos of the corner without depth; the last one is a test photo.
class MeasuredScene : public testing::Test {
 protected:
  void SetUp() override {
    root_ =
        fs::path(testing::TempDir()) / "measured_scene" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(root_);
    fs::create_directories(root_);
  }

  void write(int count, float light_of_first = 1, bool plain = false, bool points = true) {
    SceneWriter writer(root_ / "scene", false);
    SceneParts parts;
    parts.split.train.emplace();
    parts.split.test.emplace();
    for (int i = 0; i < count; ++i) {
      const RefineView shown = photo(true_camera(i), 0.3);
      SceneViewParts view;
      view.name = "v" + std::to_string(i);
      view.camera = shown.match.camera;
      view.image = Image<uint8_t>(kWidth, kHeight, 3, 128);
      for (size_t p = 0; p < view.image.data.size() && !plain; ++p) {
        const float value = shown.match.luma.data[p / 3] * (i == 0 ? light_of_first : 1);
        view.image.data[p] = static_cast<uint8_t>(255 * std::clamp(value, 0.0f, 1.0f));
      }
      (i + 1 == count ? parts.split.test : parts.split.train)->push_back(view.name);
      for (int k = 5; points && k < kWidth; k += 10) {
        parts.cloud.positions.push_back(
            view.camera.unproject(k + 0.5, 60.5, static_cast<double>(shown.match.depth.at(k, 60))).cast<float>());
        parts.cloud.colors.push_back({0.5f, 0.5f, 0.5f});
      }
      writer.add_view(view);
    }
    writer.finish(parts);
  }

  MeasureSceneReport measure(const MeasureSceneOptions& options = {}) {
    ThreadPool pool(2);
    return measure_scene(open_scene(root_ / "scene"), root_ / "measured", options, pool);
  }

  fs::path root_;
};

TEST_F(MeasuredScene, HasDepthAndCertaintyOfItsTrainingPhotosAndSaysWhoMadeIt) {
  write(5);
  const MeasureSceneReport report = measure();
  EXPECT_EQ(report.views, 4u);
  EXPECT_GT(report.measured, 0.4);
  const Scene before = open_scene(root_ / "scene"), after = open_scene(root_ / "measured");
  EXPECT_FALSE(before.has_prior_depth());
  EXPECT_TRUE(after.has_prior_depth());
  EXPECT_FALSE(after.has_network_depth());
  EXPECT_EQ(after.prior_source, kStereoDepth);
  EXPECT_EQ(after.test, before.test);
  EXPECT_EQ(after.cloud.size(), before.cloud.size());
  const FloatArray depth = read_npy(root_ / "measured" / "pred_depths" / "v1.npy");
  EXPECT_EQ(depth.shape, (std::vector<int64_t>{kHeight, kWidth}));
  EXPECT_TRUE(std::all_of(depth.data.begin(), depth.data.end(), [](float z) { return z > 0; }));
  EXPECT_TRUE(fs::exists(root_ / "measured" / "pred_confidence" / "v1.npy"));
  EXPECT_FALSE(fs::exists(root_ / "measured" / "pred_depths" / "v4.npy"));  // the test photo is not read
}

TEST_F(MeasuredScene, LargePhotosAreMeasuredSmaller) {
  write(4);
  MeasureSceneOptions options;
  options.largest_width = kWidth / 2;
  EXPECT_EQ(measure(options).views, 3u);
  EXPECT_EQ(read_npy(root_ / "measured" / "pred_depths" / "v1.npy").shape,
            (std::vector<int64_t>{kHeight / 2, kWidth / 2}));
  EXPECT_EQ(read_npy(root_ / "measured" / "pred_confidence" / "v1.npy").shape,
            (std::vector<int64_t>{kHeight / 2, kWidth / 2}));
}

TEST_F(MeasuredScene, KnowsHowItsPhotosAreExposed) {
  write(5, 0.8f);
  const MeasureSceneReport report = measure();
  ASSERT_EQ(report.log_gains.size(), 4u);
  EXPECT_LT(report.log_gains[0].y, report.log_gains[1].y - 0.2f);  // 0.8 of the sRGB value: 0.6 of the light
  EXPECT_EQ(open_scene(root_ / "measured").views[0].log_gain.y, report.log_gains[0].y);
}

TEST_F(MeasuredScene, IsNotWrittenWhenNothingCanBeMeasured) {
  write(4, 1, true);
  EXPECT_EQ(measure().views, 0u);
  EXPECT_FALSE(fs::exists(root_ / "measured"));
}

TEST_F(MeasuredScene, APhotoDamagedInItsMiddleIsLeftOut) {
  write(6);
  const fs::path photo = open_scene(root_ / "scene").views[1].image;
  std::string bytes = read_file(photo);
  for (size_t i = bytes.size() / 2; i < bytes.size() / 2 + 16; ++i) bytes[i] = static_cast<char>(~bytes[i]);
  write_file_atomically(photo, bytes);
  set_log_level(LogLevel::kSilent);
  EXPECT_EQ(measure().views, 4u);
  set_log_level(LogLevel::kInfo);
  const Scene measured = open_scene(root_ / "measured");
  EXPECT_EQ(measured.train.size(), 4u);
  for (const int i : measured.train) EXPECT_NE(measured.views[static_cast<size_t>(i)].name, "v1");
}

TEST_F(MeasuredScene, TooFewSoundPhotosAreAnError) {
  write(4);
  for (const View& view : open_scene(root_ / "scene").views)
    write_file_atomically(view.image, read_file(view.image).substr(0, 200));
  set_log_level(LogLevel::kSilent);
  EXPECT_THROW(measure(), Error);
  set_log_level(LogLevel::kInfo);
  EXPECT_FALSE(fs::exists(root_ / "measured"));
}

TEST_F(MeasuredScene, NeedsPoints) {
  write(4, 1, false, false);
  try {
    measure();
    FAIL() << "a scene without points was measured";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().field, "points3D");
    EXPECT_FALSE(error.details().remedy.empty());
  }
}

}  // namespace
}  // namespace aligngs
