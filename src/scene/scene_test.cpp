#include "scene/scene.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "io/colmap.h"
#include "io/image_file.h"
#include "io/torch_archive.h"
#include "scene/testing/scene_folder.h"

namespace aligngs {
namespace {

using namespace test_scene;

/// The text of the error that opening the folder ends in; "" when it opens.
std::string error_of(const fs::path& folder) {
  try {
    open_scene(folder);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_FALSE(error.details().remedy.empty());
    return error.what();
  }
  return "";
}

/// Changes the COLMAP model of a scene folder.
template <class Change>
void change_model(const fs::path& folder, Change change) {
  ColmapModel model = read_colmap_model(folder / "sparse");
  change(model);
  write_colmap_binary(folder / "sparse", model);
}

TEST(OpenScene, ThePublishedLayoutLoadsAsItIs) {
  const fs::path folder = write_scene();
  for (const char* ours : {"scene.json", "split.json", "priors.json", "labels.csv", "truth"})
    fs::remove_all(folder / ours);
  // Their semantic maps are torch files of 150 classes at the size of the image.
  const std::vector<float> scores(size_t(150) * kWidth * kHeight, 0.1f);
  for (const char* name : {"v0", "v1", "v2"}) {
    fs::remove(folder / "segmentation_logits" / (std::string(name) + ".npz"));
    write_torch_tensor(folder / "segmentation_logits" / (std::string(name) + ".pt"), {150, kHeight, kWidth},
                       scores.data());
  }
  write_text(folder / "split.json", R"({"test": ["v1"]})");
  const Scene scene = open_scene(folder);
  EXPECT_FALSE(scene.metric);
  EXPECT_FALSE(scene.up);
  EXPECT_EQ(scene.labels.name, "ade20k150");
  EXPECT_FALSE(scene.semantic_kind_stated);
  EXPECT_EQ(scene.train, (std::vector<int>{0, 2}));
  EXPECT_EQ(scene.test, (std::vector<int>{1}));
  EXPECT_EQ(scene.views[0].semantics.extension(), ".pt");
  EXPECT_FALSE(scene.views[0].truth_camera);
  EXPECT_EQ(scene.evaluation_cameras.size(), 3u);
}

TEST(OpenScene, AModelInSparse0IsFound) {
  const fs::path folder = write_scene();
  fs::rename(folder / "sparse", folder / "model");
  fs::create_directories(folder / "sparse");
  fs::rename(folder / "model", folder / "sparse" / "0");
  EXPECT_EQ(open_scene(folder).views.size(), 3u);
}

TEST(OpenScene, CamerasOfDifferentSizesAreNormal) {
  const fs::path folder = fresh_folder("scene");
  SceneWriter writer(folder, false);
  writer.add_view(view_parts(0));
  SceneViewParts portrait;
  portrait.name = "portrait";
  portrait.camera = camera_at(0);
  std::swap(portrait.camera.width, portrait.camera.height);
  std::swap(portrait.camera.cx, portrait.camera.cy);
  portrait.image = Image<uint8_t>(kHeight, kWidth, 3);
  portrait.truth_camera = portrait.camera;
  writer.add_view(portrait);
  SceneParts parts = scene_parts();
  parts.split.train = {{"v0"}};
  parts.split.test = {{"portrait"}};
  writer.finish(parts);
  const Scene scene = open_scene(folder);
  EXPECT_EQ(scene.views[0].camera.height, kWidth);
  EXPECT_EQ(scene.views[1].camera.height, kHeight);
}

TEST(OpenScene, MapsAreFoundByTheNameUpToTheFirstDot) {
  const fs::path folder = write_scene();
  change_model(folder, [](ColmapModel& model) {
    for (ColmapImage& image : model.images) image.name = image.name.substr(0, 2) + ".color.png";
  });
  for (const char* name : {"v0", "v1", "v2"}) {
    fs::rename(folder / "images" / (std::string(name) + ".png"),
               folder / "images" / (std::string(name) + ".color.png"));
  }
  const Scene scene = open_scene(folder);
  EXPECT_EQ(scene.views[0].name, "v0.color");
  EXPECT_EQ(scene.views[0].prior_depth.filename(), "v0.npy");
  EXPECT_EQ(scene.train.size(), 2u) << "split.json names the short names";
}

TEST(OpenScene, AnAmbiguousShortNameSharesNoMap) {
  const fs::path folder = write_scene();
  change_model(folder, [](ColmapModel& model) {
    for (size_t i = 0; i < model.images.size(); ++i) model.images[i].name = "v0." + std::to_string(i) + ".png";
  });
  for (int i = 0; i < 3; ++i) {
    fs::rename(folder / "images" / ("v" + std::to_string(i) + ".png"),
               folder / "images" / ("v0." + std::to_string(i) + ".png"));
  }
  fs::remove(folder / "split.json");
  EXPECT_TRUE(open_scene(folder).views[1].prior_depth.empty());
}

TEST(OpenScene, WithoutASplitEveryNthViewCanBeATestView) {
  const fs::path folder = write_scene();
  fs::remove(folder / "split.json");
  EXPECT_EQ(open_scene(folder).train.size(), 3u);
  SceneOptions options;
  options.default_test_every = 2;
  EXPECT_EQ(open_scene(folder, options).test, (std::vector<int>{0, 2}));
}

TEST(OpenScene, ViewsInNeitherListAreUnused) {
  const fs::path folder = write_scene();
  write_text(folder / "split.json", R"({"train": ["v0.png"], "test": []})");
  fs::remove(folder / "images" / "v1.png");
  const Scene scene = open_scene(folder);
  EXPECT_EQ(scene.train, (std::vector<int>{0}));
  EXPECT_TRUE(scene.test.empty());
}

TEST(OpenScene, SplitErrorsListTheNames) {
  const fs::path folder = write_scene();
  write_text(folder / "split.json", R"({"train": ["v0", "nope"], "test": ["v1"]})");
  EXPECT_NE(error_of(folder).find("nope"), std::string::npos);
  write_text(folder / "split.json", R"({"train": ["v0", "v1"], "test": ["v1"]})");
  EXPECT_NE(error_of(folder).find("'v1' is in both lists"), std::string::npos);
  write_text(folder / "split.json", R"({"train": [], "test": ["v1"]})");
  EXPECT_NE(error_of(folder).find("no training view"), std::string::npos);
}

TEST(OpenScene, AFolderWithoutAModelIsNamed) {
  const fs::path folder = fresh_folder("empty");
  EXPECT_NE(error_of(folder).find("no folder"), std::string::npos);
  fs::create_directories(folder);
  EXPECT_NE(error_of(folder).find("sparse"), std::string::npos);
}

TEST(OpenScene, ZeroViewsAreAnError) {
  const fs::path folder = write_scene();
  change_model(folder, [](ColmapModel& model) { model.images.clear(); });
  EXPECT_NE(error_of(folder).find("no image is registered"), std::string::npos);
}

TEST(OpenScene, APoseThatIsNotFiniteIsAnError) {
  const fs::path folder = write_scene();
  std::string bytes = read_text(folder / "sparse" / "images.bin");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  bytes.replace(8 + 4 + 32, 8, std::string(reinterpret_cast<const char*>(&nan), 8));  // x of the first translation
  write_text(folder / "sparse" / "images.bin", bytes);
  EXPECT_NE(error_of(folder).find("images.bin"), std::string::npos);
}

TEST(OpenScene, ADistortedCameraAsksForImport) {
  const fs::path folder = write_scene();
  change_model(folder, [](ColmapModel& model) {
    model.cameras[0].model = "SIMPLE_RADIAL";
    model.cameras[0].params = {40, 20, 15, 0.1};
  });
  EXPECT_NE(error_of(folder).find("aligngs import"), std::string::npos);
}

TEST(OpenScene, AnImageOfAnotherAspectThanItsCameraIsLeftOut) {
  const fs::path folder = write_scene();
  write_png(folder / "images" / "v1.png", Image<uint8_t>(20, 20, 3));
  const std::string error = error_of(folder);  // one training view is too few
  EXPECT_NE(error.find("20 x 20"), std::string::npos);
  EXPECT_NE(error.find("40 x 30"), std::string::npos);
}

TEST(OpenScene, ACameraFollowsAPhotoThatWasResized) {
  const fs::path folder = write_scene();
  write_png(folder / "images" / "v1.png", Image<uint8_t>(20, 15, 3));
  const Scene scene = open_scene(folder);
  EXPECT_EQ(scene.views[1].camera.width, 20);
  EXPECT_EQ(scene.views[1].camera.fx, 20);
  EXPECT_TRUE(scene.left_out.empty());
}

TEST(OpenScene, ATestViewWithoutAPhotoIsLeftOut) {
  const fs::path folder = write_scene();
  fs::remove(folder / "images" / "v2.png");
  const Scene scene = open_scene(folder);
  EXPECT_TRUE(scene.test.empty());
  ASSERT_EQ(scene.left_out.size(), 1u);
  EXPECT_EQ(scene.left_out[0].name, "v2");
  EXPECT_NE(scene.left_out[0].reason.find("missing"), std::string::npos);
}

TEST(OpenScene, AMissingImageIsAnError) {
  const fs::path folder = write_scene();
  fs::remove(folder / "images" / "v0.png");
  EXPECT_NE(error_of(folder).find("missing"), std::string::npos);
}

TEST(OpenScene, AnImageOfAnotherFormatWithTheSameNameIsFound) {
  const fs::path folder = write_scene();
  fs::remove(folder / "images" / "v0.png");
  write_jpeg(folder / "images" / "v0.jpg", textured_image(1));
  EXPECT_EQ(open_scene(folder).views[0].image.extension(), ".jpg");
}

TEST(OpenScene, AWrongClassCountNamesBothNumbers) {
  const fs::path folder = write_scene();
  fs::remove(folder / "labels.csv");
  const std::string error = error_of(folder);
  EXPECT_NE(error.find("3 classes"), std::string::npos);
  EXPECT_NE(error.find("150"), std::string::npos);
}

TEST(OpenScene, ANameThatLeavesTheFolderIsAnError) {
  const fs::path folder = write_scene();
  change_model(folder, [](ColmapModel& model) { model.images[0].name = "../../etc/passwd.png"; });
  EXPECT_NE(error_of(folder).find("outside"), std::string::npos);
}

TEST(OpenScene, NormalsOfAnotherCloudAreNotUsed) {
  const fs::path folder = write_scene();
  change_model(folder, [](ColmapModel& model) { std::swap(model.points[0], model.points[1]); });
  EXPECT_FALSE(open_scene(folder).cloud.has_normals());
}

TEST(RobustExtent, GrowsWithTheSceneAndIgnoresOutliers) {
  Scene scene = open_scene(write_scene());
  const double extent = robust_extent(scene);
  EXPECT_GT(extent, 0.3);
  EXPECT_LT(extent, 1.5);
  scene.cloud.positions.push_back({1e6f, 0, 0});
  EXPECT_NEAR(robust_extent(scene) / extent, 1, 0.02);
  for (Vec3f& p : scene.cloud.positions) p *= 0.37f;
  for (View& view : scene.views) view.camera.world_to_camera.translation *= 0.37;
  EXPECT_NEAR(robust_extent(scene) / extent, 0.37, 0.01);
}

TEST(RobustExtent, IsNeverZero) {
  Scene scene;
  EXPECT_EQ(robust_extent(scene), 1);
  scene.views.emplace_back();
  scene.train = {0};
  EXPECT_EQ(robust_extent(scene), 1);
}

TEST(SceneFingerprint, DependsOnTheContentAndNotOnThePlace) {
  const Scene scene = open_scene(write_scene("here"));
  const std::string fingerprint = scene_fingerprint(scene);
  EXPECT_EQ(fingerprint.size(), 64u);
  EXPECT_EQ(scene_fingerprint(open_scene(write_scene("there"))), fingerprint);
  Scene changed = scene;
  changed.views[1].camera.fx += 1e-9;
  EXPECT_NE(scene_fingerprint(changed), fingerprint);
  changed = scene;
  std::swap(changed.train, changed.test);
  EXPECT_NE(scene_fingerprint(changed), fingerprint);
}

TEST(OpenScene, PathsOfAnotherMachineAreNamesBelowTheirSharedFolder) {
  for (const char* before : {"/home/somebody/capture/images/", "C:\\Users\\somebody\\images\\", "D:/x/"}) {
    const fs::path folder = write_scene();
    const std::vector<View> plain = open_scene(folder).views;
    change_model(folder, [&](ColmapModel& model) {
      for (ColmapImage& image : model.images) image.name = before + image.name;
    });
    const Scene scene = open_scene(folder);
    ASSERT_EQ(scene.views.size(), plain.size()) << before;
    for (size_t i = 0; i < plain.size(); ++i) {
      EXPECT_EQ(scene.views[i].name, plain[i].name) << before;
      EXPECT_EQ(scene.views[i].image, plain[i].image) << before;
    }
  }
}

}  // namespace
}  // namespace aligngs
