// Photos without poses through the program COLMAP, and metrics that need network weights.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "io/atomic_file.h"
#include "io/json_text.h"
#include "nn/random_weights.h"
#include "priors/child_process.h"
#include "priors/model_store.h"
#include "scene/scene.h"
#include "support/no_weights.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

class PhotosProgram : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("photos_program_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    no_weights.emplace(folder);
  }
  ProcessResult run(const std::string& arguments) const { return run_aligngs(arguments, folder / "scratch"); }
  std::string out(const char* name) const { return "'" + (folder / name).string() + "'"; }
  /// The sample captures that come with the sources on some machines.
  static fs::path sample(const char* name) {
    return fs::path(ALIGNGS_SOURCE_DIR) / "../shared/data/photos_room" / name / "images";
  }
  static std::string why_not(const char* name) {
    if (!fs::exists(sample(name))) return "the sample photos are not here";
    if (find_program("colmap").empty()) return "colmap is not installed";
    return "";
  }

  fs::path folder;
  std::optional<testing_support::NoWeights> no_weights;
};

TEST_F(PhotosProgram, ColmapPlacesOverlappingPhotosAndTheRunTrains) {
  const std::string why = why_not("kitchen_table");
  if (!why.empty()) GTEST_SKIP() << why;
  const ProcessResult result = run("run '" + sample("kitchen_table").string() + "' -o " + out("run") +
                                   " --method colmap --semantics none --preset preview -n 100 --test-every 8");
  ASSERT_EQ(result.status, 0) << result.err;
  const Scene scene = open_scene(folder / "run" / "scene");
  EXPECT_GE(scene.views.size(), 23u);
  EXPECT_GT(scene.cloud.size(), 1000u);
  EXPECT_TRUE(fs::exists(folder / "run" / "scene.ply"));
  EXPECT_TRUE(fs::exists(folder / "run" / "report.html"));
}

TEST_F(PhotosProgram, PhotosWithoutOverlapAreExplainedOneByOne) {
  const std::string why = why_not("bedroom_no_overlap");
  if (!why.empty()) GTEST_SKIP() << why;
  const ProcessResult result =
      run("poses '" + sample("bedroom_no_overlap").string() + "' -o " + out("scene") + " --method colmap");
  EXPECT_EQ(result.status, 3);
  for (const auto& entry : fs::directory_iterator(sample("bedroom_no_overlap")))
    EXPECT_THAT(result.err, HasSubstr(entry.path().stem().string() + ": "));
  EXPECT_THAT(result.err, HasSubstr("of 8 photos could be placed"));
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(PhotosProgram, EvalMeasuresLpipsWhereItsWeightsAre) {
  testing_support::write_small_scene(folder / "scene");
  ASSERT_EQ(run("train " + out("scene") + " -o " + out("run") + " --preset preview -n 20 --set data.scale=1").status,
            0);
  ASSERT_EQ(run("eval " + out("run")).status, 0);
  const auto nvs = [&] { return parse_json(read_file(folder / "run" / "metrics.json"))["nvs"]; };
  EXPECT_TRUE(nvs()["lpips"].is_null());
  EXPECT_THAT(nvs()["lpips_note"].get<std::string>(), HasSubstr("aligngs models download lpips-vgg"));
  const PublishedModel& model = published_model("lpips-vgg");
  ModelStoreOptions options;
  options.folder = folder / "models";
  const std::vector<int64_t> widths = {4, 4, 8, 8, 8};
  nn::write_random_weights(ModelStore(options).own_path(model, model.files[0]), nn::vgg16_tensors(widths), 1);
  nn::write_random_weights(ModelStore(options).own_path(model, model.files[1]), nn::lpips_tensors(widths), 2);
  ASSERT_EQ(run("eval " + out("run")).status, 0);
  EXPECT_TRUE(nvs()["lpips"].is_number());
  EXPECT_TRUE(nvs()["lpips_unit"].is_number());
}

}  // namespace
}  // namespace aligngs
