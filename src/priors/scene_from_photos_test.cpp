#include "priors/scene_from_photos.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "core/error.h"
#include "core/log.h"
#include "io/image_file.h"
#include "io/npy.h"
#include "io/safetensors.h"
#include "nn/random_weights.h"
#include "priors/scene_priors.h"
#include "scene/scene_json.h"
#include "scene/segment_file.h"
#include "scene/view_data.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// Networks of the published structure and tiny sizes with random weights.
class FromPhotos : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("from_photos_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder / "photos");
    store_options.folder = folder / "models";
    options.precision = nn::Precision::kFloat32;
    options.progress.enabled = false;
    fill.precision = nn::Precision::kFloat32;
    fill.progress.enabled = false;
    set_log_level(LogLevel::kSilent);
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  void write_photo(const std::string& name, int width, int height) const {
    Image<uint8_t> image(width, height, 3);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        image.at(x, y, 0) = uint8_t(x * 255 / width);
        image.at(x, y, 1) = uint8_t(y * 255 / height);
        image.at(x, y, 2) = uint8_t(name.size() * 20);
      }
    }
    write_jpeg(folder / "photos" / name, image);
  }
  fs::path weights_of(const char* model, size_t file = 0) const {
    const PublishedModel& m = published_model(model);
    return ModelStore(store_options).own_path(m, m.files[file]);
  }
  void install_vggt() const {
    nn::VggtSize size;
    size.encoder = {64, 2, false, 4, 5};
    size.depth = 8;
    size.camera_depth = 1;
    size.features = 8;
    size.levels = {8, 8, 8, 8};
    nn::write_random_weights(weights_of("vggt-1b"), nn::vggt_tensors(size), 1);
  }
  void install_da3(const char* model = "da3-base") const {
    nn::Da3Size size;
    size.encoder = {64, 12, false, 0, 5};
    size.heads = 1;
    size.features = 8;
    size.camera_depth = 1;
    size.levels = {8, 8, 8, 8};
    nn::write_random_weights(weights_of(model), nn::da3_tensors(size), 1);
  }
  void install_da3_metric() const {
    nn::Da3MetricSize size;
    size.encoder = {64, 24, false, 0, 5};
    size.features = 8;
    size.levels = {8, 8, 8, 8};
    nn::write_random_weights(weights_of("da3metric-large"), nn::da3_metric_tensors(size), 1);
  }
  void install_label_networks() const {
    nn::EomtSize eomt;
    eomt.encoder = {64, 4, false, 4, 4};  // windows of 64 pixels
    eomt.queries = 6;
    eomt.query_blocks = 2;
    nn::write_random_weights(weights_of("eomt-l"), nn::eomt_tensors(eomt), 1);
    nn::write_random_weights(weights_of("eomt-l-panoptic"), nn::eomt_huggingface_tensors(eomt), 1);
    nn::LingbotSize lingbot;
    lingbot.encoder = {64, 2, false, 4, 0};
    lingbot.heads = 1;
    nn::write_random_weights(weights_of("lingbot-s"), nn::lingbot_tensors(lingbot), 1);
  }
  void install_linear() const {
    const nn::VitSize size{64, 4, false, 0, 5};
    nn::write_random_weights(weights_of("dinov2-s"), nn::dinov2_tensors(size), 1);
    nn::write_random_weights(weights_of("ade20k-linear-s"), nn::bn_head_tensors(size.channels), 2);
    nn::write_random_weights(weights_of("ade20k-ms-s"), nn::bn_head_tensors(4 * size.channels), 2);
    nn::write_random_weights(weights_of("nyu-linear4-s"), nn::linear_depth_tensors(4 * 2 * size.channels), 3);
  }
  ScenePhotosReport make() const {
    return make_scene_from_photos(folder / "photos", folder / "scene", ModelStore(store_options), options);
  }
  template <class F>
  static std::string error_of(ErrorKind kind, F work) {
    try {
      work();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), kind) << error.what();
      return error.what();
    }
    ADD_FAILURE() << "no error";
    return {};
  }
  void three_photos() const {
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) write_photo(name, 120, 90);
  }

  fs::path folder;
  ModelStoreOptions store_options;
  ScenePhotosOptions options;
  ScenePriorsOptions fill;
};

TEST_F(FromPhotos, VggtMakesASceneThatOpensAndChecks) {
  three_photos();
  install_vggt();
  const ScenePhotosReport report = make();
  EXPECT_EQ(report.placed, 3u);
  EXPECT_GT(report.points, 0u);
  const Scene scene = open_scene(folder / "scene");
  ASSERT_EQ(scene.views.size(), 3u);
  EXPECT_TRUE(scene.has_prior_depth());
  EXPECT_TRUE(scene.cloud.has_normals());
  EXPECT_EQ(scene.prior_source, "vggt-1b");
  EXPECT_EQ(read_priors_json(folder / "scene" / "priors.json").depth_scale, DepthScale::kScene);
  for (const SceneProblem& problem : check_scene(scene)) EXPECT_FALSE(problem.fatal) << problem.message;
  const Rigidd& first = scene.views[0].camera.world_to_camera;
  EXPECT_NEAR(norm(first.translation), 0, 1e-9);
  EXPECT_TRUE(fs::exists(folder / "scene" / "pred_confidence" / "a.npy"));
}

TEST_F(FromPhotos, DepthAnything3MakesASceneThatOpensAndChecks) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  const ScenePhotosReport report = make();
  EXPECT_EQ(report.method, "da3-base");
  EXPECT_EQ(report.placed, 3u);
  EXPECT_GT(report.points, 0u);
  const Scene scene = open_scene(folder / "scene");
  EXPECT_TRUE(scene.has_prior_depth());
  EXPECT_TRUE(scene.cloud.has_normals());
  EXPECT_EQ(scene.prior_source, "da3-base");
  for (const SceneProblem& problem : check_scene(scene)) EXPECT_FALSE(problem.fatal) << problem.message;
  EXPECT_NEAR(norm(scene.views[0].camera.world_to_camera.translation), 0, 1e-9);
  EXPECT_TRUE(fs::exists(folder / "scene" / "pred_confidence" / "a.npy"));
}

TEST_F(FromPhotos, AMetricNetworkBesideItMakesMetres) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  make();
  const Scene units = open_scene(folder / "scene");
  EXPECT_FALSE(units.metric);
  EXPECT_FALSE(units.units_estimate);
  const FloatArray depth = read_npy(folder / "scene" / "pred_depths" / "a.npy");

  install_da3_metric();
  options.overwrite = true;
  const ScenePhotosReport report = make();
  ASSERT_TRUE(report.metres);
  EXPECT_EQ(report.metres->photos, 3u);
  const Scene scene = open_scene(folder / "scene");
  EXPECT_TRUE(scene.metric);
  ASSERT_TRUE(scene.units_estimate);
  EXPECT_EQ(scene.units_estimate->model, "da3metric-large");
  EXPECT_EQ(scene.units_estimate->photos, 3);
  EXPECT_NEAR(scene.units_estimate->spread, report.metres->spread, 1e-9);
  const auto baseline = [](const Scene& s) { return norm(s.views[1].camera.centre() - s.views[0].camera.centre()); };
  EXPECT_NEAR(baseline(scene) / baseline(units), report.metres->scale, 1e-6 * report.metres->scale);
  const FloatArray metres = read_npy(folder / "scene" / "pred_depths" / "a.npy");
  ASSERT_EQ(metres.data.size(), depth.data.size());
  for (size_t i = 0; i < depth.data.size(); ++i) {
    // Half floats; depth of the sky and unsure depth are no values.
    if (depth.data[i] > 0 && metres.data[i] > 0) {
      EXPECT_NEAR(metres.data[i] / depth.data[i], report.metres->scale, 2e-3 * report.metres->scale);
    }
  }
}

TEST_F(FromPhotos, AMetricNetworkThatIsAskedForMustBeThere) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  options.metric_model_needed = true;
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { make(); }), HasSubstr("aligngs models download da3metric-large"));
  options.metric_model.clear();
  make();
  EXPECT_FALSE(open_scene(folder / "scene").metric);
}

TEST_F(FromPhotos, RaysThatAreThoseOfNoCameraNameThePhoto) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  options.camera_from_rays = true;
  // The camera of rays of random weights is one that no photo has.
  EXPECT_THAT(error_of(ErrorKind::kFailed, [&] { make(); }), AllOf(HasSubstr("a.jpg"), HasSubstr("impossible camera")));
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(FromPhotos, DepthAnything3SeesTheMiddleOfPhotosOfOtherShapes) {
  write_photo("a.jpg", 120, 90);
  write_photo("b.jpg", 90, 120);
  write_photo("c.jpg", 64, 64);
  install_da3("da3-small");
  options.method = PosesMethod::kDa3;
  options.model = "da3-small";
  make();
  const Scene scene = open_scene(folder / "scene");
  EXPECT_EQ(scene.views[1].camera.height, 120);
  EXPECT_NEAR(scene.views[1].camera.cy, 60, 1);
  const FloatArray depth = read_npy(folder / "scene" / "pred_depths" / "b.npy");
  EXPECT_GT(depth.shape[0], depth.shape[1]);
  EXPECT_EQ(depth.data.front(), 0) << "above what the network was shown";
}

TEST_F(FromPhotos, DepthAnything3FillsTheDepthOfASceneInTheUnitsOfItsCameras) {
  three_photos();
  install_da3();
  options.method = PosesMethod::kDa3;
  options.model = "da3-base";
  make();
  fill.overwrite = true;
  const ModelStore store(store_options);
  EXPECT_EQ(fill_depth(folder / "scene", store, depth_model("da3"), fill).written, 3u);
  EXPECT_EQ(read_priors_json(folder / "scene" / "priors.json").depth_scale, DepthScale::kScene);
  EXPECT_TRUE(fs::exists(folder / "scene" / "pred_confidence" / "a.npy"));
  fill.memory_limit = 1'000'000;
  error_of(ErrorKind::kResources, [&] { fill_depth(folder / "scene", store, depth_model("da3"), fill); });
}

TEST_F(FromPhotos, WithoutWeightsOfDepthAnything3ItSaysHowToGetThem) {
  three_photos();
  options.method = PosesMethod::kDa3;
  options.model = "da3-large";
  const std::string text = error_of(ErrorKind::kWeights, [&] { make(); });
  EXPECT_THAT(text, HasSubstr("aligngs models download da3-large"));
  EXPECT_THAT(text, HasSubstr("non-commercial"));
}

TEST_F(FromPhotos, PhotosOfAnySizeAndOrientationGoTogether) {
  write_photo("a.jpg", 120, 90);
  write_photo("b.jpg", 90, 120);
  write_photo("c.jpg", 64, 64);
  install_vggt();
  make();
  const Scene scene = open_scene(folder / "scene");
  EXPECT_EQ(scene.views[1].camera.height, 120);
  EXPECT_NEAR(scene.views[1].camera.cx, 45, 1);
}

TEST_F(FromPhotos, UnsureDepthIsLeftOut) {
  three_photos();
  install_vggt();
  options.drop_percent = 40;
  make();
  size_t none = 0, all = 0;
  for (const char* name : {"a", "b", "c"}) {
    for (const float z : read_npy(folder / "scene" / "pred_depths" / (std::string(name) + ".npy")).data) {
      none += z == 0;
      ++all;
    }
  }
  EXPECT_NEAR(double(none) / double(all), 0.4, 0.02);
}

TEST_F(FromPhotos, OneFocalLengthForAllWhenAskedFor) {
  three_photos();
  install_vggt();
  options.shared_focal = true;
  make();
  const Scene scene = open_scene(folder / "scene");
  EXPECT_DOUBLE_EQ(scene.views[0].camera.fx, scene.views[2].camera.fx);
  EXPECT_DOUBLE_EQ(scene.views[0].camera.fx, scene.views[0].camera.fy);
}

TEST_F(FromPhotos, EveryNthPhotoIsKeptForTesting) {
  for (const char* name : {"1.jpg", "2.jpg", "3.jpg", "4.jpg"}) write_photo(name, 120, 90);
  install_vggt();
  options.test_every = 2;
  EXPECT_EQ(make().test, 2u);
  EXPECT_EQ(open_scene(folder / "scene").test.size(), 2u);
}

TEST_F(FromPhotos, WithoutWeightsNothingIsWritten) {
  three_photos();
  EXPECT_THAT(error_of(ErrorKind::kWeights, [&] { make(); }), HasSubstr("aligngs models download vggt-1b"));
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(FromPhotos, MemoryIsPredictedFirst) {
  three_photos();
  install_vggt();
  options.memory_limit = 1 << 20;
  EXPECT_THAT(error_of(ErrorKind::kResources, [&] { make(); }), HasSubstr("weights of the network"));
}

TEST_F(FromPhotos, AnImpossibleCameraIsRefused) {
  three_photos();
  // Without its bias the head predicts fields of view of nearly nothing.
  install_vggt();
  TensorFile file = read_safetensors(weights_of("vggt-1b"));
  TensorBytes& bias = file.tensors.at("camera_head.pose_branch.fc2.bias");
  bias.bytes.assign(bias.bytes.size(), 0);
  write_safetensors(weights_of("vggt-1b"), file);
  EXPECT_THAT(error_of(ErrorKind::kFailed, [&] { make(); }), HasSubstr("impossible camera"));
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(FromPhotos, ASceneThatExistsIsKept) {
  three_photos();
  install_vggt();
  make();
  error_of(ErrorKind::kUsage, [&] { make(); });
  options.overwrite = true;
  EXPECT_NO_THROW(make());
}

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
