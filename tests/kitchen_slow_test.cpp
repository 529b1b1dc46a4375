// A real capture with small photos through the whole program: colour only from SfM points, and with sensor depth. Only
// as long as a test may take; the figures of full runs are in docs/results.md.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/image_file.h"
#include "io/json_text.h"
#include "io/resample.h"
#include "support/process.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

constexpr int kSmaller = 4;  ///< times fewer rows and columns: measuring depth takes a sixth of the time

class Kitchen : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(capture())) GTEST_SKIP() << "no real capture at " << capture();
    base_ = fs::path(testing::TempDir()) / "kitchen_test";
    fs::remove_all(base_);
    fs::create_directories(base_);
    write_small();
  }
  void TearDown() override {
    if (!base_.empty()) fs::remove_all(base_);
  }

  static fs::path capture() { return fs::path(ALIGNGS_SOURCE_DIR) / ".." / "shared" / "data" / "kitchen_rgbd"; }

  fs::path small() const { return base_ / "capture"; }

  /// The capture with fewer rows and columns.
  void write_small() const {
    fs::create_directories(small() / "images");
    fs::create_directories(small() / "depth");
    for (const char* same :
         {"poses", "sfm_train", "train.txt", "test.txt", "reference_mesh_train.ply", "reference_mesh.ply"})
      fs::copy(capture() / same, small() / same, fs::copy_options::recursive);
    for (const fs::directory_entry& file : fs::directory_iterator(capture() / "images")) {
      const Image<uint8_t> photo = read_image(file.path());
      write_jpeg(small() / "images" / file.path().filename(),
                 to_bytes(resize_area(photo, photo.width / kSmaller, photo.height / kSmaller)));
    }
    for (const fs::directory_entry& file : fs::directory_iterator(capture() / "depth")) {
      const Image<uint16_t> depth = read_gray_png(file.path());
      write_png16(small() / "depth" / file.path().filename(),
                  resize_nearest(depth, depth.width / kSmaller, depth.height / kSmaller));
    }
    std::ifstream whole(capture() / "intrinsics.txt");
    std::ofstream smaller(small() / "intrinsics.txt");
    for (int i = 0; i < 9; ++i) {
      double value = 0;
      whole >> value;
      smaller << (i < 6 ? value / kSmaller : value) << (i % 3 == 2 ? '\n' : ' ');  // the last row is 0 0 1
    }
  }

  /// metrics.json of a run of `iterations` on the small capture, imported with `import_options`.
  nlohmann::json measure(const std::string& import_options, int iterations) const {
    const ProcessResult import = run_aligngs(
        "import '" + small().string() + "' -o '" + (base_ / "scene").string() + "' -q " + import_options, base_);
    EXPECT_EQ(import.status, 0) << import.err;
    const ProcessResult run = run_aligngs("run '" + (base_ / "scene").string() + "' -o '" + (base_ / "run").string() +
                                              "' -q --json -n " + std::to_string(iterations),
                                          base_);
    EXPECT_EQ(run.status, 0) << run.err;
    return parse_json(run.out);
  }

  fs::path base_;
};

TEST_F(Kitchen, ColourAloneGivesTheRoomByDepthMeasuredInThePhotos) {
  const nlohmann::json metrics = measure("--sfm '" + (small() / "sfm_train" / "known_intrinsics").string() + "'", 100);
  ASSERT_TRUE(metrics.is_object());
  EXPECT_EQ(metrics["nvs"]["views"], 20);
  EXPECT_GT(metrics["nvs"]["psnr"].get<double>(), 19);  // dB; 6.6 before training from points
  EXPECT_GT(metrics["nvs"]["exposure_fitted"]["psnr"].get<double>(), 20);
  EXPECT_GT(metrics["geometry"]["fscore"].get<double>(), 0.55);  // 0.15 from points alone, with larger photos
  EXPECT_TRUE(metrics["semantics"].is_null());                   // the capture has no labels
}

TEST_F(Kitchen, SensorDepthGivesTheRoomAtOnce) {
  const nlohmann::json metrics = measure("", 40);
  ASSERT_TRUE(metrics.is_object());
  EXPECT_GT(metrics["nvs"]["psnr"].get<double>(), 16);
  EXPECT_GT(metrics["geometry"]["fscore"].get<double>(), 0.7);
}

}  // namespace
}  // namespace aligngs
