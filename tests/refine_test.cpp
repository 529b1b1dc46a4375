// `aligngs refine` as a user meets it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "core/median.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "io/npy.h"
#include "refine/bundle_adjustment.h"
#include "scene/scene.h"
#include "scene/scene_json.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

class RefineCommand : public testing::Test {
 protected:
  static fs::path root() { return fs::path(testing::TempDir()) / "refine_command"; }
  static fs::path original() { return fs::path(testing::TempDir()) / "refine_command_original"; }
  static void SetUpTestSuite() { testing_support::write_small_scene(original(), {.truth = false}); }
  static void TearDownTestSuite() { fs::remove_all(original()); }
  void SetUp() override {
    fs::remove_all(root());
    fs::create_directories(root());
    fs::copy(original(), root() / "scene", fs::copy_options::recursive);
  }
  static ProcessResult refine(const std::string& arguments) {
    return run_aligngs(
        "refine '" + (root() / "scene").string() + "' -o '" + (root() / "refined").string() + "' -q " + arguments,
        root() / "scratch");
  }
};

TEST_F(RefineCommand, WritesASceneThatOpensAndLeavesTheOldOneAlone) {
  const std::string before = read_file(root() / "scene" / "sparse" / "images.bin");
  const ProcessResult result = refine("--json");
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json printed = parse_json(result.out);
  EXPECT_TRUE(printed["tracks"].is_number());
  const Scene scene = open_scene(root() / "refined"), old = open_scene(root() / "scene");
  EXPECT_EQ(scene.views.size(), old.views.size());
  EXPECT_EQ(scene.train, old.train);
  EXPECT_EQ(scene.cloud.size(), old.cloud.size());
  EXPECT_EQ(read_file(root() / "scene" / "sparse" / "images.bin"), before);
  EXPECT_THAT(read_file(root() / "refined" / "scene.json"), HasSubstr("cameras_refined"));
}

TEST_F(RefineCommand, AnExistingSceneIsReplacedWithOverwriteAlone) {
  ASSERT_EQ(refine("").status, 0);
  EXPECT_EQ(refine("").status, 2);
  EXPECT_EQ(refine("--overwrite").status, 0);
}

/// The median of the positive values of a view's pred_depths/.
double median_depth(const fs::path& scene, const std::string& view) {
  std::vector<double> depths;
  for (const float z : read_npy(scene / "pred_depths" / (view + ".npy")).data) {
    if (z > 0) depths.push_back(static_cast<double>(z));
  }
  return median_of(depths);
}

TEST_F(RefineCommand, APhotoDamagedInItsMiddleIsLeftOutByName) {
  const Scene old = open_scene(root() / "scene");
  const View& damaged = old.views[static_cast<size_t>(old.train[2])];
  std::string bytes = read_file(damaged.image);
  for (size_t i = bytes.size() / 2; i < bytes.size() / 2 + 16; ++i) bytes[i] = static_cast<char>(~bytes[i]);
  write_file_atomically(damaged.image, bytes);
  const ProcessResult result =
      run_aligngs("refine '" + (root() / "scene").string() + "' -o '" + (root() / "refined").string() + "' --json",
                  root() / "scratch");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr(damaged.name));
  const Scene refined = open_scene(root() / "refined");
  EXPECT_EQ(refined.train.size() + 1, old.train.size());
  for (const nlohmann::json& view : parse_json(result.out)["views"]) EXPECT_NE(view["name"], damaged.name);
}

TEST_F(RefineCommand, DepthOfAnotherScaleComesOutInTheUnitsOfTheScene) {
  const fs::path scene = root() / "scene";
  const std::string view = open_scene(scene).views[static_cast<size_t>(open_scene(scene).train[0])].name;
  const double before = median_depth(scene, view);
  for (const auto& entry : fs::directory_iterator(scene / "pred_depths")) {
    FloatArray depth = read_npy(entry.path());
    for (float& z : depth.data) z *= 2.7f;
    write_npy_float32(entry.path(), depth.shape, depth.data.data());
  }
  PriorsJson priors = read_priors_json(scene / "priors.json");
  priors.depth_scale = DepthScale::kOwn;
  write_priors_json(scene / "priors.json", priors);
  const ProcessResult result = refine("");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(open_scene(root() / "refined").depth_scale, DepthScale::kScene);
  EXPECT_NEAR(median_depth(root() / "refined", view) / before, 1, 0.1);
}

// Without labels a network's depth is nearer to the surface than the planes are (docs/decisions/0026).
TEST_F(RefineCommand, DepthOfANetworkIsLaidOnPlanesOfEverythingOnlyWhereThereAreLabels) {
  const ProcessResult labelled = refine("--json");
  ASSERT_EQ(labelled.status, 0) << labelled.err;
  EXPECT_GT(parse_json(labelled.out)["bare_planes"].get<int>(), 0);
  fs::remove_all(root() / "scene" / "segmentation_logits");
  const ProcessResult bare = refine("--json --overwrite");
  ASSERT_EQ(bare.status, 0) << bare.err;
  EXPECT_EQ(parse_json(bare.out)["bare_planes"].get<int>(), 0);
}

TEST_F(RefineCommand, WithoutPriorDepthItIsMeasured) {
  fs::remove_all(root() / "scene" / "pred_depths");
  const ProcessResult result = refine("--json");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_GT(parse_json(result.out)["depth_measured"].get<double>(), 0);
  EXPECT_EQ(open_scene(root() / "refined").prior_source, kStereoDepth);
}

TEST_F(RefineCommand, WithoutPriorDepthAndPointsItSaysWhatIsMissing) {
  fs::remove_all(root() / "scene" / "pred_depths");
  for (const char* file : {"points3D.bin", "points3D.ply"}) fs::remove(root() / "scene" / "sparse" / file);
  const ProcessResult result = refine("");
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("points"));
  EXPECT_THAT(result.err, HasSubstr("remedy"));
  EXPECT_FALSE(fs::exists(root() / "refined"));
}

TEST_F(RefineCommand, RunMeasuresDepthIntoItsOwnSceneFolder) {
  fs::remove_all(root() / "scene" / "pred_depths");
  const std::string run = "run '" + (root() / "scene").string() + "' -o '" + (root() / "run").string() + "' -n 10 -q";
  const ProcessResult first = run_aligngs(run, root() / "scratch");
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_EQ(open_scene(root() / "run" / "scene").prior_source, kStereoDepth);
  const ProcessResult again = run_aligngs(run + " --resume", root() / "scratch");
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST_F(RefineCommand, RunRefinesIntoItsOwnSceneFolderAndResumesWithoutDoingItAgain) {
  const std::string run = "run '" + (root() / "scene").string() + "' -o '" + (root() / "run").string() + "' -n 10 -q";
  ASSERT_EQ(run_aligngs(run, root() / "scratch").status, 0);
  const std::string refined = read_file(root() / "run" / "scene" / "scene.json");
  EXPECT_THAT(refined, HasSubstr("cameras_refined"));
  EXPECT_FALSE(fs::exists(root() / "run" / "scene.refined"));
  const ProcessResult again = run_aligngs(run + " --resume", root() / "scratch");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(read_file(root() / "run" / "scene" / "scene.json"), refined);
}

TEST_F(RefineCommand, RunWithNoRefineTrainsOnTheSceneAsItIs) {
  const ProcessResult result = run_aligngs("run '" + (root() / "scene").string() + "' -o '" +
                                               (root() / "run").string() + "' --no-refine --set train.seed=3 -n 2 -q",
                                           root() / "scratch");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_FALSE(fs::exists(root() / "run" / "scene"));
}

}  // namespace
}  // namespace aligngs
