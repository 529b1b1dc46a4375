// One thing wrong with a scene at a time: the program says what and where, ends with status 3 and leaves nothing
// half-written. Each test damages a copy of the same small room.
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <functional>

#include "io/image_file.h"
#include "io/npy.h"
#include "io/npz.h"
#include "io/torch_archive.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

class BadInput : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    pristine_ = fs::path(testing::TempDir()) / ("bad_input_pristine_" + std::to_string(getpid()));
    testing_support::write_small_scene(pristine_);
  }

  static void TearDownTestSuite() { fs::remove_all(pristine_); }

  void SetUp() override {
    base_ = fs::path(testing::TempDir()) /
            ("bad_input_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(base_);
    fs::create_directories(base_);
    scene_ = base_ / "scene";
    fs::copy(pristine_, scene_, fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(base_); }

  /// The first file of a subfolder in name order; `last` gives the last one.
  fs::path file_in(const std::string& folder, bool last = false) const {
    fs::path found;
    for (const auto& entry : fs::directory_iterator(scene_ / folder)) {
      if (found.empty() || (entry.path() < found) != last) found = entry.path();
    }
    return found;
  }
  static void truncate(const fs::path& file, double share = 0.6) {
    fs::resize_file(file, static_cast<uintmax_t>(static_cast<double>(fs::file_size(file)) * share));
  }
  static void overwrite(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }

  /// Trains on the damaged scene and expects status 3 with the words, and no result.
  void expect_refused(const std::vector<std::string>& words, const std::string& options = "") {
    const ProcessResult result =
        run_aligngs("train '" + scene_.string() + "' -o '" + (base_ / "run").string() + "' -n 2 -q " + options, base_);
    EXPECT_EQ(result.status, 3) << result.err;
    for (const std::string& word : words) EXPECT_THAT(result.err, HasSubstr(word));
    EXPECT_THAT(result.err, HasSubstr("remedy"));
    EXPECT_FALSE(fs::exists(base_ / "run" / "scene.ply"));
    EXPECT_FALSE(fs::exists(base_ / "run" / "checkpoints" / "step_000002.safetensors"));
  }

  /// A problem of one view leaves it out with a line; with --strict it is refused.
  void expect_left_out(const std::vector<std::string>& words) {
    expect_refused(words, "--strict");
    const ProcessResult result =
        run_aligngs("train '" + scene_.string() + "' -o '" + (base_ / "lenient").string() + "' -n 2", base_);
    EXPECT_EQ(result.status, 0) << result.err;
    for (const std::string& word : words) EXPECT_THAT(result.err, HasSubstr(word));
    EXPECT_THAT(result.err, HasSubstr("views; left out: "));
    EXPECT_TRUE(fs::exists(base_ / "lenient" / "scene.ply"));
  }

  static fs::path pristine_;
  fs::path base_, scene_;
};

fs::path BadInput::pristine_;

TEST_F(BadInput, ThePristineSceneTrains) {
  const ProcessResult result =
      run_aligngs("train '" + scene_.string() + "' -o '" + (base_ / "run").string() + "' -n 2 -q", base_);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(fs::exists(base_ / "run" / "scene.ply"));
}

TEST_F(BadInput, MissingImage) {
  const fs::path image = file_in("images");
  fs::remove(image);
  expect_left_out({image.filename().string()});
}

TEST_F(BadInput, MissingTestImage) {
  const fs::path image = file_in("images", true);
  fs::remove(image);
  expect_left_out({image.filename().string()});
}

TEST_F(BadInput, TruncatedImage) {
  const fs::path image = file_in("images");
  truncate(image);
  expect_left_out({image.filename().string()});
}

TEST_F(BadInput, ImageOfAnotherSizeThanItsCamera) {
  const fs::path image = file_in("images");
  image.extension() == ".png" ? write_png(image, Image<uint8_t>(40, 40, 3, 9))
                              : write_jpeg(image, Image<uint8_t>(40, 40, 3, 9));
  expect_left_out({image.filename().string(), "40"});
}

TEST_F(BadInput, TruncatedDepth) {
  const fs::path depth = file_in("pred_depths");
  truncate(depth);
  expect_left_out({depth.filename().string()});
}

TEST_F(BadInput, DepthOfAnotherAspect) {
  const fs::path depth = file_in("pred_depths");
  const std::vector<float> values(10 * 40, 1.f);
  write_npy_float32(depth, {10, 40}, values.data());
  expect_left_out({depth.filename().string()});
}

TEST_F(BadInput, DisparityGivenAsDepth) {
  for (const auto& entry : fs::directory_iterator(scene_ / "pred_depths")) {
    FloatArray map = read_npy(entry.path());
    for (float& v : map.data) v = v > 0 ? 1 / v : 0;
    write_npy_float32(entry.path(), map.shape, map.data.data());
  }
  expect_refused({"pred_depths", "disparity"});
}

TEST_F(BadInput, TruncatedSemantics) {
  const fs::path map = file_in("segmentation_logits");
  truncate(map);
  expect_left_out({map.filename().string()});
}

TEST_F(BadInput, TruncatedTorchSemantics) {
  const fs::path npy = file_in("segmentation_logits");
  const FloatArray map = read_npz(npy);
  fs::path pt = npy;
  pt.replace_extension(".pt");
  write_torch_tensor(pt, map.shape, map.data.data());
  fs::remove(npy);
  truncate(pt);
  expect_left_out({pt.filename().string()});
}

TEST_F(BadInput, WrongClassCount) {
  const fs::path map = file_in("segmentation_logits");
  const std::vector<uint16_t> values(7 * 12 * 16, 0x2e66);  // 0.1 as float16
  write_npz_float16(map, {7, 12, 16}, values.data());
  expect_left_out({map.filename().string(), "7", "150"});
}

TEST_F(BadInput, TruncatedCameraModel) {
  truncate(file_in("sparse"));
  expect_refused({"sparse"});
}

TEST_F(BadInput, TruncatedPoints) {
  truncate(scene_ / "sparse" / "points3D.bin");
  expect_refused({"points3D"});
}

TEST_F(BadInput, PosesThatAreNotFinite) {
  // Byte offset of the first quaternion in images.bin: count (8) + image id (4).
  std::fstream file(scene_ / "sparse" / "images.bin", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(12);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  file.write(reinterpret_cast<const char*>(&nan), sizeof(nan));
  file.close();
  expect_left_out({"images.bin"});
}

TEST_F(BadInput, NoViews) {
  overwrite(scene_ / "sparse" / "images.bin", std::string(8, '\0'));
  expect_refused({"sparse"});
}

TEST_F(BadInput, SplitNamesAViewThatDoesNotExist) {
  overwrite(scene_ / "split.json", R"({"train": ["nobody"], "test": []})");
  expect_refused({"split.json", "nobody"});
}

TEST_F(BadInput, SplitThatIsNoJson) {
  overwrite(scene_ / "split.json", "{\"train\": [");
  expect_refused({"split.json"});
}

TEST_F(BadInput, DataCheckListsEveryProblem) {
  const fs::path image = file_in("images"), depth = file_in("pred_depths", true);
  truncate(image);
  truncate(depth);
  const ProcessResult result = run_aligngs("data check '" + scene_.string() + "'", base_);
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.out, HasSubstr(image.filename().string()));
  EXPECT_THAT(result.out, HasSubstr(depth.filename().string()));
}

TEST_F(BadInput, ANerfstudioFolderIsToldFromAScene) {
  const fs::path folder = scene_.parent_path() / "nerfstudio";
  fs::create_directories(folder / "images");
  overwrite(folder / "transforms.json", R"({"frames": []})");
  fs::copy(scene_ / "images", folder / "images", fs::copy_options::overwrite_existing);
  for (const std::string command : {"train ", "run "}) {
    const ProcessResult result = run_aligngs(
        command + "'" + folder.string() + "' -o '" + (folder.parent_path() / "nerfstudio_run").string() + "'",
        folder.parent_path());
    EXPECT_EQ(result.status, 3) << command << result.err;
    EXPECT_THAT(result.err, HasSubstr("nerfstudio")) << command;
    EXPECT_THAT(result.err, HasSubstr("aligngs import")) << command;
  }
}

}  // namespace
}  // namespace aligngs
