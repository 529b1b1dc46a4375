#include "scene/scene_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "scene/image_quality.h"
#include "scene/segment_file.h"
#include "scene/testing/scene_folder.h"

namespace aligngs {
namespace {

using namespace test_scene;

std::vector<SceneProblem> problems_of(const fs::path& folder) {
  SceneOptions options;
  options.check_headers = false;
  return check_scene(open_scene(folder, options));
}

/// The problems of one file.
std::vector<SceneProblem> of_file(const std::vector<SceneProblem>& problems, const std::string& file) {
  std::vector<SceneProblem> out;
  std::copy_if(problems.begin(), problems.end(), std::back_inserter(out),
               [&](const SceneProblem& p) { return p.path.filename() == file; });
  return out;
}

void write_depth(const fs::path& folder, const std::string& name, float (*value)(float)) {
  ImageF depth = surface_depth_map(camera_at(0.1 * (name[1] - '0')), kWidth, kHeight);
  for (float& z : depth.data) z = value(z);
  write_npy_float32(folder / "pred_depths" / (name + ".npy"), {kHeight, kWidth}, depth.data.data());
}

TEST(CheckScene, AGoodSceneHasNoProblem) {
  for (const SceneProblem& p : problems_of(write_scene()))
    ADD_FAILURE() << p.path << " " << p.field << " " << p.message;
}

/// Segments of half a view: one chair.
void write_chair(const fs::path& folder, const std::string& view, uint16_t label = 2) {
  fs::create_directories(folder / "segments");
  SegmentMap map{kWidth, kHeight, std::vector<uint16_t>(size_t(kWidth) * kHeight, SegmentMap::kNone), {{label, 0}}};
  std::fill_n(map.of_pixel.begin(), map.of_pixel.size() / 2, uint16_t(0));
  write_segments(folder / "segments" / (view + ".png"), map);
}

TEST(CheckScene, SegmentsOfEveryTrainingViewAreFine) {
  const fs::path folder = write_scene();
  write_chair(folder, "v0");
  write_chair(folder, "v1");
  EXPECT_TRUE(problems_of(folder).empty());
  EXPECT_TRUE(has_segments(open_scene(folder)));
}

TEST(CheckScene, SegmentsOfSomeViewsAreNotUsedAndLeaveNoViewOut) {
  const fs::path folder = write_scene();
  write_chair(folder, "v0");
  const auto problems = of_file(problems_of(folder), "segments");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_FALSE(problems[0].fatal);
  EXPECT_FALSE(has_segments(open_scene(folder)));
}

TEST(CheckScene, ASegmentOfAClassThatTheLabelSetHasNotIsFound) {
  const fs::path folder = write_scene();
  write_chair(folder, "v0", 3);
  write_chair(folder, "v1");
  const auto problems = of_file(problems_of(folder), "v0.png");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_TRUE(problems[0].fatal);
}

TEST(CheckScene, SegmentsOfAnotherAspectAreFound) {
  const fs::path folder = write_scene();
  write_chair(folder, "v0");
  write_segments(folder / "segments" / "v1.png", {kWidth, kWidth, std::vector<uint16_t>(kWidth * kWidth, 0), {{2, 0}}});
  EXPECT_EQ(of_file(problems_of(folder), "v1.png").size(), 1u);
}

TEST(CheckScene, EveryProblemIsListedOnce) {
  const fs::path folder = write_scene();
  fs::remove(folder / "images" / "v0.png");
  write_png(folder / "images" / "v1.png", Image<uint8_t>(20, 20, 3));
  write_text(folder / "images" / "v2.png", "no image at all");
  fs::remove(folder / "pred_depths" / "v0.npy");
  write_text(folder / "pred_depths" / "v1.npy", "broken");
  const ImageF wrong(kWidth, kWidth, 1, 1.0f);
  write_npy_float32(folder / "pred_depths" / "v2.npy", {kWidth, kWidth}, wrong.data.data());
  const SemanticMap two{2, 4, 3, std::vector<float>(24, 0.5f)};
  replace_semantics(folder, "v1", {2, 3, 4}, two.values);
  const std::vector<SceneProblem> problems = problems_of(folder);
  for (const char* file : {"v0.png", "v1.png", "v2.png", "v0.npy", "v2.npy"}) {
    EXPECT_EQ(of_file(problems, file).size(), 1u) << file;
  }
  EXPECT_EQ(of_file(problems, "v1.npy").size(), 2u) << "one broken depth map, one semantic map of two classes";
  for (const SceneProblem& p : problems) {
    EXPECT_TRUE(p.fatal) << p.path;
    EXPECT_FALSE(p.remedy.empty()) << p.path;
  }
  EXPECT_THROW(open_scene(folder), Error);
}

TEST(CheckScene, ATruncatedImageIsFoundThoughItsHeaderIsGood) {
  const fs::path folder = write_scene();
  const std::string bytes = read_text(folder / "images" / "v2.png");
  write_text(folder / "images" / "v2.png", bytes.substr(0, bytes.size() / 2));
  const auto problems = of_file(problems_of(folder), "v2.png");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_TRUE(problems[0].fatal);
}

TEST(CheckScene, DepthWithoutAnyValueIsFatal) {
  const fs::path folder = write_scene();
  write_depth(folder, "v0", [](float) { return 0.0f; });
  write_depth(folder, "v1", [](float) { return std::nanf(""); });
  const auto problems = problems_of(folder);
  for (const char* file : {"v0.npy", "v1.npy"}) {
    ASSERT_EQ(of_file(problems, file).size(), 1u);
    EXPECT_TRUE(of_file(problems, file)[0].fatal);
  }
}

TEST(CheckScene, DisparityGivenAsDepthIsFatal) {
  const fs::path folder = write_scene();
  write_depth(folder, "v1", [](float z) { return 1 / z; });
  const auto problems = of_file(problems_of(folder), "v1.npy");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_TRUE(problems[0].fatal);
  EXPECT_NE(problems[0].message.find("disparity"), std::string::npos);
}

/// A wall that rises to one side and away, and points on it.
TEST(TurnedMap, IsToldFromOneInOrder) {
  const Camera camera = camera_at(0);
  ImageF depth(camera.width, camera.height, 1);
  PointCloud cloud;
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const Vec3d ray = camera.ray(x + 0.5, y + 0.5);
      const double z = 2 / (1 - 0.3 * ray.x - 0.5 * ray.y);
      depth.at(x, y) = static_cast<float>(z);
      cloud.positions.push_back((camera.world_to_camera.inverse() * (ray * z)).cast<float>());
    }
  }
  const auto turned = [&](bool columns, bool rows) {
    ImageF map = depth;
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x)
        map.at(x, y) = depth.at(columns ? map.width - 1 - x : x, rows ? map.height - 1 - y : y);
    return map;
  };
  EXPECT_EQ(turned_map(cloud, camera, turned(false, true)), "upside down");
  EXPECT_EQ(turned_map(cloud, camera, turned(true, false)), "mirrored");
  EXPECT_EQ(turned_map(cloud, camera, depth), std::nullopt);
}

TEST(CheckScene, ConfidenceOfNothingIsAWarning) {
  const fs::path folder = write_scene();
  fs::create_directories(folder / "pred_confidence");
  const std::vector<float> none(size_t(kWidth) * kHeight, 0.0f);
  write_npy_float32(folder / "pred_confidence" / "v1.npy", {kHeight, kWidth}, none.data());
  const auto problems = of_file(problems_of(folder), "v1.npy");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_FALSE(problems[0].fatal);
  EXPECT_NE(problems[0].message.find("confidence"), std::string::npos);
}

TEST(CheckScene, ConfidenceOfFewViewsIsUsedWithAWarning) {
  const fs::path folder = write_scene();
  write_text(folder / "split.json", R"({"train": ["v0", "v1", "v2"], "test": []})");
  fs::create_directories(folder / "pred_confidence");
  const std::vector<float> sure(size_t(kWidth) * kHeight, 1.0f);
  write_npy_float32(folder / "pred_confidence" / "v1.npy", {kHeight, kWidth}, sure.data());
  const auto problems = of_file(problems_of(folder), "pred_confidence");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_FALSE(problems[0].fatal);
  EXPECT_EQ(problems[0].message, "only 1 of 3 training views have one: all depth of the others is used");
}

TEST(CheckScene, DepthInMillimetresIsAWarning) {
  const fs::path folder = write_scene();
  write_depth(folder, "v1", [](float z) { return 1000 * z; });
  const auto problems = of_file(problems_of(folder), "v1.npy");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_FALSE(problems[0].fatal);
  EXPECT_NE(problems[0].message.find("1e+03 times"), std::string::npos) << problems[0].message;
}

/// Below what one view's points tell, all views together tell it.
TEST(CheckScene, DepthOfAllViewsInAnotherUnitIsOneWarning) {
  const fs::path folder = write_scene();
  for (const char* view : {"v0", "v1", "v2"}) write_depth(folder, view, [](float z) { return 2 * z; });
  const auto problems = problems_of(folder);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_FALSE(problems[0].fatal);
  EXPECT_EQ(problems[0].field, kDepthOfViews);
  EXPECT_NE(problems[0].message.find("2 times the distance of the points"), std::string::npos) << problems[0].message;
}

TEST(CheckScene, DepthOfItsOwnScaleMayHaveAnyUnit) {
  const fs::path folder = write_scene();
  for (const char* view : {"v0", "v1", "v2"}) write_depth(folder, view, [](float z) { return 2 * z; });
  write_file_atomically(folder / "priors.json", R"({"depth": {"model": "m", "scale": "own"}})");
  for (const SceneProblem& p : problems_of(folder)) EXPECT_NE(p.field, kDepthOfViews) << p.message;
}

TEST(CheckScene, ConstantDepthIsAWarning) {
  const fs::path folder = write_scene();
  write_depth(folder, "v0", [](float) { return 2.0f; });
  const auto problems = of_file(problems_of(folder), "v0.npy");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_FALSE(problems[0].fatal);
}

TEST(CheckScene, SemanticsWithoutAFiniteValueAreFatal) {
  const fs::path folder = write_scene();
  const std::vector<float> values(3 * 3 * 4, std::nanf(""));
  replace_semantics(folder, "v0", {3, 3, 4}, values);
  const auto problems = of_file(problems_of(folder), "v0.npy");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_TRUE(problems[0].fatal);
}

TEST(CheckScene, ScoresOfUnstatedKindAreAWarningOncePerScene) {
  const fs::path folder = write_scene();
  fs::remove(folder / "priors.json");
  const auto problems = problems_of(folder);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_FALSE(problems[0].fatal);
  EXPECT_EQ(problems[0].field, "semantics.kind");
}

TEST(CheckScene, RealLogitsOfUnstatedKindAreFine) {
  const fs::path folder = write_scene();
  fs::remove(folder / "priors.json");
  std::vector<float> values(3 * 3 * 4, -5.0f);
  values[0] = 9;
  replace_semantics(folder, "v0", {3, 3, 4}, values);
  EXPECT_TRUE(problems_of(folder).empty());
}

TEST(CheckScene, ATruthMapOfAnotherAspectIsFound) {
  const fs::path folder = write_scene();
  write_png16(folder / "truth" / "depth" / "v2.png", Image<uint16_t>(10, 30, 1, 1000));
  const auto problems = of_file(problems_of(folder), "v2.png");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_TRUE(problems[0].fatal);
}

TEST(CheckScene, BlurredAndDarkViewsAreWarnings) {
  const fs::path folder = fresh_folder("scene");
  SceneWriter writer(folder, false);
  SceneParts parts = scene_parts();
  parts.split = {};
  for (int i = 0; i < 6; ++i) {
    SceneViewParts view = view_parts(i);
    if (i == 0) view.image = Image<uint8_t>(kWidth, kHeight, 3, 128);
    if (i == 1) {
      for (uint8_t& value : view.image.data) value = static_cast<uint8_t>(value / 2 - value / 20);
    }
    writer.add_view(view);
  }
  writer.finish(parts);
  const auto problems = problems_of(folder);
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0].field, "sharpness");
  EXPECT_EQ(problems[0].path.filename(), "v0.png");
  EXPECT_EQ(problems[1].field, "exposure");
  EXPECT_FALSE(problems[1].fatal);
}

TEST(CheckGeometry, AViewThatSeesOtherThingsIsAWarning) {
  Scene scene = open_scene(write_scene());
  Camera& camera = scene.views[1].camera;
  camera.world_to_camera.rotation = {{-1, 0, 0, 0, 1, 0, 0, 0, -1}};  // turned round: no point lies before it
  const auto problems = check_geometry(scene);
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0].field, "overlap");
  EXPECT_EQ(problems[1].field, "points");
}

TEST(CheckGeometry, ASceneFarFromItsOriginIsAWarning) {
  Scene scene = open_scene(write_scene());
  for (View& view : scene.views)
    view.camera.world_to_camera.translation = view.camera.world_to_camera.translation - Vec3d{4e6, 0, 0};
  for (Vec3f& p : scene.cloud.positions) p.x += 4e6f;
  bool said = false;
  for (const SceneProblem& problem : check_geometry(scene))
    said |= !problem.fatal && problem.message.find("from the origin") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(CheckGeometry, ACameraOfAnotherSizeIsAWarning) {
  Scene scene = open_scene(write_scene());
  scene.views[static_cast<size_t>(scene.train[0])].camera.cx = 3.0 * kWidth;
  const std::vector<SceneProblem> problems = check_geometry(scene);
  const auto found = std::find_if(problems.begin(), problems.end(), [](const SceneProblem& p) {
    return p.message.find("principal point") != std::string::npos;
  });
  ASSERT_NE(found, problems.end());
  EXPECT_FALSE(found->fatal);
  EXPECT_EQ(found->path, scene.views[static_cast<size_t>(scene.train[0])].image);
}

TEST(CheckGeometry, APrincipalPointInTheCornerIsAWarning) {
  Scene scene = open_scene(write_scene());
  Camera& camera = scene.views[static_cast<size_t>(scene.train[0])].camera;
  camera.cx = camera.cy = 0.5;  // of the width and height
  bool said = false;
  for (const SceneProblem& problem : check_geometry(scene))
    said |= !problem.fatal && problem.message.find("in the corner") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(CheckGeometry, CamerasInOnePlaceAreAWarning) {
  Scene scene = open_scene(write_scene());
  for (View& view : scene.views) view.camera.world_to_camera.translation = {0, 0, 0};
  const auto problems = check_geometry(scene);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].field, "poses");
}

TEST(CheckGeometry, ASingleTrainingViewIsAWarning) {
  Scene scene = open_scene(write_scene());
  scene.train.resize(1);
  const std::vector<SceneProblem> problems = check_geometry(scene);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].field, "train");
  EXPECT_FALSE(problems[0].fatal);
}

TEST(DisparityEvidence, NeedsEnoughPointsAndAClearSign) {
  const Scene scene = open_scene(write_scene());
  const Camera camera = scene.views[0].camera;
  ImageF depth = surface_depth_map(camera, kWidth, kHeight);
  EXPECT_GT(disparity_evidence(scene.cloud, camera, depth).rank_correlation, 0.9);
  for (float& z : depth.data) z = 1 / z;
  EXPECT_TRUE(disparity_evidence(scene.cloud, camera, depth).is_disparity());
  EXPECT_FALSE(disparity_evidence({}, camera, depth).is_disparity());
  EXPECT_FALSE(disparity_evidence(scene.cloud, camera, ImageF(kWidth, kHeight, 1, 1.0f)).is_disparity());
}

TEST(VisiblePoints, PointsBehindOthersAreHidden) {
  PointCloud cloud;
  cloud.positions = {{0, 0, 2}, {0, 0, 3}, {0.3f, 0.2f, 3}, {0, 0, -1}, {9, 0, 2}};
  cloud.colors.resize(5);
  EXPECT_EQ(visible_points(cloud, camera_at(0)), (std::vector<uint32_t>{0, 2}));
}

TEST(ImageQuality, PhotosOfSeveralSizesCompareAtTheWidthOfTheNarrowest) {
  const Image<uint8_t> small = textured_image(1);
  Image<uint8_t> large(2 * kWidth, 2 * kHeight, 3);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x)
      for (int c = 0; c < 3; ++c) large.at(x, y, c) = small.at(x / 2, y / 2, c);
  EXPECT_LT(sharpness(large, 2 * kWidth), 0.8 * sharpness(small)) << "the same picture";
  EXPECT_NEAR(sharpness(large, kWidth), sharpness(small), 1e-3 * sharpness(small));
}

TEST(ImageQuality, BlurLowersSharpness) {
  Image<uint8_t> sharp = textured_image(1), blurred = sharp;
  for (int y = 1; y < kHeight - 1; ++y)
    for (int x = 1; x < kWidth - 1; ++x)
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i) sum += sharp.at(x + i, y + j, c);
        blurred.at(x, y, c) = static_cast<uint8_t>(sum / 9);
      }
  EXPECT_GT(sharpness(sharp), 4 * sharpness(blurred));
  EXPECT_EQ(sharpness(Image<uint8_t>(2, 2, 3)), 0);
  EXPECT_NEAR(mean_luminance(Image<uint8_t>(4, 4, 3, 51)), 0.2, 1e-6);
}

}  // namespace
}  // namespace aligngs
