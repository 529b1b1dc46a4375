// A real capture through the whole program at half its size: colour only from SfM points, and with sensor depth. Only
// as long as a test may take; the figures of full runs are in docs/results.md.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "io/json_text.h"
#include "support/process.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

class Kitchen : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(capture())) GTEST_SKIP() << "no real capture at " << capture();
    base_ = fs::path(testing::TempDir()) / "kitchen_test";
    fs::remove_all(base_);
    fs::create_directories(base_);
  }
  void TearDown() override {
    if (!base_.empty()) fs::remove_all(base_);
  }

  static fs::path capture() { return fs::path(ALIGNGS_SOURCE_DIR) / ".." / "shared" / "data" / "kitchen_rgbd"; }

  /// metrics.json of a run of `iterations` on the capture, imported with `import_options`.
  nlohmann::json measure(const std::string& import_options, int iterations) const {
    const ProcessResult import = run_aligngs(
        "import '" + capture().string() + "' -o '" + (base_ / "scene").string() + "' -q " + import_options, base_);
    EXPECT_EQ(import.status, 0) << import.err;
    const ProcessResult run = run_aligngs("run '" + (base_ / "scene").string() + "' -o '" + (base_ / "run").string() +
                                              "' -q --json --set data.scale=0.5 -n " + std::to_string(iterations),
                                          base_);
    EXPECT_EQ(run.status, 0) << run.err;
    return parse_json(run.out);
  }

  fs::path base_;
};

TEST_F(Kitchen, ColourAloneGivesTheRoomByDepthMeasuredInThePhotos) {
  const nlohmann::json metrics =
      measure("--sfm '" + (capture() / "sfm_train" / "known_intrinsics").string() + "'", 100);
  ASSERT_TRUE(metrics.is_object());
  EXPECT_EQ(metrics["nvs"]["views"], 20);
  EXPECT_GT(metrics["nvs"]["psnr"].get<double>(), 19);  // dB; 6.6 before training from points
  EXPECT_GT(metrics["nvs"]["exposure_fitted"]["psnr"].get<double>(), 20);
  EXPECT_GT(metrics["geometry"]["fscore"].get<double>(), 0.55);  // 0.15 after as many steps from points alone
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
