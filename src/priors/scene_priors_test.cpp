#include "priors/scene_priors.h"

#include <gmock/gmock.h>

#include <fstream>

#include "priors/testing/from_photos.h"
#include "scene/scene_json.h"
#include "scene/segment_file.h"
#include "scene/view_data.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST_F(FromPhotos, LinearSemanticsAreLogitsThatTheSceneLoads) {
  three_photos();
  install_vggt();
  install_linear();
  make();
  const ModelStore store(store_options);
  const ScenePriorsReport report = fill_semantics(folder / "scene", store, semantic_model("linear-s"), fill);
  EXPECT_EQ(report.written, 3u);
  const Scene scene = open_scene(folder / "scene");
  EXPECT_TRUE(scene.has_semantics());
  EXPECT_TRUE(scene.semantic_kind_stated);
  EXPECT_EQ(scene.semantic_kind, SemanticKind::kLogits);
  EXPECT_EQ(scene.semantic_source, "ade20k-linear-s");
  const ViewData data = load_view(scene, 0);
  EXPECT_EQ(data.semantics.channels, 150);
  EXPECT_EQ(data.semantics.height, 64);  // short side 512, one value per 8 pixels
}

TEST_F(FromPhotos, EomtAndLingbotFillSemanticsAsWhatTheyAre) {
  three_photos();
  install_vggt();
  install_label_networks();
  make();
  const ModelStore store(store_options);
  struct Expected {
    const char* name;
    SemanticKind kind;
    int height;  ///< one value per 8 pixels of the short side that the network is shown
  };
  for (const Expected& e :
       {Expected{"eomt-l", SemanticKind::kScores, 8}, Expected{"eomt-l-panoptic", SemanticKind::kScores, 8},
        Expected{"lingbot-s", SemanticKind::kLogits, 64}}) {
    fill.overwrite = true;
    EXPECT_EQ(fill_semantics(folder / "scene", store, semantic_model(e.name), fill).written, 3u);
    const Scene scene = open_scene(folder / "scene");
    EXPECT_EQ(scene.semantic_kind, e.kind);
    EXPECT_EQ(scene.semantic_source, e.name);
    const ViewData data = load_view(scene, 0);
    EXPECT_EQ(data.semantics.channels, 150);
    EXPECT_EQ(data.semantics.height, e.height);
    fill.memory_limit = 1'000'000;
    error_of(ErrorKind::kResources, [&] { fill_semantics(folder / "scene", store, semantic_model(e.name), fill); });
    fill.memory_limit = 0;
  }
}

TEST_F(FromPhotos, ThePanopticNetworkStoresSegmentsAndAnotherRemovesThem) {
  three_photos();
  install_vggt();
  install_label_networks();
  make();
  const ModelStore store(store_options);
  const PublishedModel& panoptic = semantic_model("eomt-panoptic");
  EXPECT_TRUE(fill_semantics(folder / "scene", store, panoptic, fill).makes_segments);
  EXPECT_TRUE(has_segments(open_scene(folder / "scene")));
  EXPECT_TRUE(fill_semantics(folder / "scene", store, panoptic, fill).was_there);
  fs::remove(folder / "scene" / "segments" / "a.png");
  EXPECT_FALSE(fill_semantics(folder / "scene", store, panoptic, fill).was_there) << "segments were missing";
  EXPECT_TRUE(has_segments(open_scene(folder / "scene")));
  fill.overwrite = true;
  fill_semantics(folder / "scene", store, semantic_model("eomt-l"), fill);
  EXPECT_FALSE(fs::exists(folder / "scene" / "segments"));
}

TEST_F(FromPhotos, MapsOfTheSameNetworkAreKept) {
  three_photos();
  install_vggt();
  install_linear();
  make();
  const ModelStore store(store_options);
  fill_semantics(folder / "scene", store, semantic_model("linear-s"), fill);
  EXPECT_TRUE(fill_semantics(folder / "scene", store, semantic_model("linear"), fill).was_there);
  error_of(ErrorKind::kUsage, [&] { fill_semantics(folder / "scene", store, semantic_model("ms-s"), fill); });
}

TEST_F(FromPhotos, MetricDepthReplacesTheOtherWhenAskedFor) {
  three_photos();
  install_vggt();
  install_linear();
  make();
  const ModelStore store(store_options);
  const PublishedModel& depther = depth_model("linear-s");
  error_of(ErrorKind::kUsage, [&] { fill_depth(folder / "scene", store, depther, fill); });
  fill.overwrite = true;
  EXPECT_EQ(fill_depth(folder / "scene", store, depther, fill).written, 3u);
  const Scene scene = open_scene(folder / "scene");
  EXPECT_EQ(scene.prior_source, "nyu-linear4-s");
  const PriorsJson notes = read_priors_json(folder / "scene" / "priors.json");
  constexpr size_t kDigest = 64;
  EXPECT_EQ(notes.depth->weights.size(), 2 * kDigest + 1) << "of backbone and head";
  EXPECT_EQ(notes.depth_scale, DepthScale::kMetres);
  const ViewData data = load_view(scene, 0);
  for (const float z : data.prior_depth.data) EXPECT_TRUE(z > 0 && z <= 10);
  EXPECT_FALSE(fs::exists(folder / "scene" / "pred_confidence")) << "was that of VGGT's depth";
}

TEST_F(FromPhotos, VggtFillsTheDepthOfASceneWithOtherPoses) {
  three_photos();
  install_vggt();
  make();
  fill.overwrite = true;
  const ScenePriorsReport report = fill_depth(folder / "scene", ModelStore(store_options), depth_model("vggt"), fill);
  EXPECT_EQ(report.written, 3u);
  EXPECT_TRUE(fs::exists(folder / "scene" / "pred_confidence" / "a.npy"));
  EXPECT_EQ(open_scene(folder / "scene").depth_scale, DepthScale::kOwn);
}

TEST_F(FromPhotos, NetworksThatDoNotFitInMemoryAreRefusedBeforeAnythingIsReplaced) {
  three_photos();
  install_vggt();
  install_linear();
  make();
  const ModelStore store(store_options);
  fill.overwrite = true;
  fill.memory_limit = 1'000'000;
  const auto refusal_of = [&](const auto& work) {
    const std::string text = error_of(ErrorKind::kResources, work);
    EXPECT_THAT(text, HasSubstr("weights of the network"));
    EXPECT_THAT(text, HasSubstr("--memory"));
  };
  refusal_of([&] { fill_semantics(folder / "scene", store, semantic_model("linear-s"), fill); });
  refusal_of([&] { fill_semantics(folder / "scene", store, semantic_model("ms-s"), fill); });
  refusal_of([&] { fill_depth(folder / "scene", store, depth_model("linear-s"), fill); });
  refusal_of([&] { fill_depth(folder / "scene", store, depth_model("vggt"), fill); });
  EXPECT_TRUE(open_scene(folder / "scene").has_prior_depth());
}

TEST_F(FromPhotos, AnUnknownNetworkIsAUsageError) {
  for (const char* name : {"linear-x", "m3f", "ms-", ""}) EXPECT_THROW(semantic_model(name), Error) << name;
  EXPECT_THROW(depth_model("dpt-xl"), Error);
  EXPECT_EQ(semantic_model("ms-l").name, "ade20k-ms-l");
}

TEST_F(FromPhotos, TheBestInstalledTeacherIsChosen) {
  const ModelStore store(store_options);
  EXPECT_EQ(installed_semantic_model(store), nullptr);
  EXPECT_EQ(installed_depth_model(store), nullptr);
  install_linear();
  EXPECT_EQ(installed_semantic_model(store)->name, "ade20k-ms-s");
  EXPECT_EQ(installed_depth_model(store)->name, "nyu-linear4-s");
  install_vggt();  // not free to use in every way
  EXPECT_EQ(installed_depth_model(store)->name, "nyu-linear4-s");
}

TEST_F(FromPhotos, AutoPicksAnyNetworkThatIsTheOnlyOne) {
  const auto picked = [&](const PublishedModel& model, const auto& choose) {
    fs::remove_all(store_options.folder);
    const ModelStore store(store_options);
    for (const PublishedModel* part : with_needs(model)) {
      for (const ModelFile& file : part->files) {
        fs::create_directories(store.own_path(*part, file).parent_path());
        std::ofstream(store.own_path(*part, file)) << "weights";
      }
    }
    const PublishedModel* chosen = choose(store);
    return chosen ? chosen->name : "none";
  };
  for (const std::string& word : semantic_choices())
    EXPECT_EQ(picked(semantic_model(word), installed_semantic_model), semantic_model(word).name);
  for (const std::string& word : depth_choices())
    EXPECT_EQ(picked(depth_model(word), installed_depth_model), depth_model(word).name);
}

}  // namespace
}  // namespace aligngs
