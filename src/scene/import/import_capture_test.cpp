#include "scene/import/import_capture.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>

#include "core/error.h"
#include "core/log.h"
#include "core/random.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/testing/turned_jpeg.h"
#include "scene/import/capture_text.h"
#include "scene/scene_json.h"
#include "scene/view_data.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kWidth = 48, kHeight = 32;

/// A COLMAP model in sparse/ and photos in images/, both as a test wants them.
class ImportCaptureTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("import_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    source = folder / "source";
    fs::create_directories(source / "images");
    set_log_level(LogLevel::kSilent);
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  /// Red in the upper left corner and blue in the lower right one, grey elsewhere.
  static Image<uint8_t> picture(int width = kWidth, int height = kHeight) {
    Image<uint8_t> image(width, height, 3, 120);
    Random random(5);
    for (uint8_t& value : image.data) value = static_cast<uint8_t>(100 + random.below(50));
    for (int y = 0; y < height / 2; ++y) {
      for (int x = 0; x < width / 2; ++x) {
        std::copy_n(std::array<uint8_t, 3>{250, 0, 0}.data(), 3, image.pixel(x, y));
        std::copy_n(std::array<uint8_t, 3>{0, 0, 250}.data(), 3, image.pixel(width - 1 - x, height - 1 - y));
      }
    }
    return image;
  }
  void photo(const std::string& name, int orientation = 1, int width = kWidth, int height = kHeight) const {
    const std::vector<uint8_t> jpeg = encode_jpeg(picture(width, height), 95);
    const std::string bytes(jpeg.begin(), jpeg.end());
    write_file_atomically(source / "images" / name, orientation == 1 ? bytes : turned_jpeg(jpeg, orientation));
  }
  /// Cameras along x that look along z, `offset` from the origin, and points before them.
  void model(const std::vector<std::string>& names, int width = kWidth, int height = kHeight, const Vec3d& offset = {},
             double scale = 1) const {
    ColmapModel model;
    model.cameras = {{1,
                      "PINHOLE",
                      uint64_t(width),
                      uint64_t(height),
                      {40.0 * width / kWidth, 40.0 * width / kWidth, width / 2.0, height / 2.0}}};
    for (size_t i = 0; i < names.size(); ++i) {
      ColmapImage image;
      image.id = uint32_t(i + 1);
      image.camera_id = 1;
      image.name = names[i];
      image.rotation = {1, 0, 0, 0};
      image.translation = -(Vec3d{0.3 * double(i), 0, 0} * scale + offset);
      model.images.push_back(image);
    }
    Random random(1);
    for (uint64_t i = 0; i < 200; ++i) {
      ColmapPoint point;
      point.id = i + 1;
      point.position = Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(2, 4)} * scale + offset;
      model.points.push_back(point);
    }
    write_colmap_binary(source / "sparse" / "0", model);
  }
  ImportReport import(ImportOptions options = {}) const {
    options.progress.enabled = false;
    ThreadPool pool(1);
    return import_capture(read_capture(source), folder / "scene", options, pool);
  }
  Scene scene() const { return open_scene(folder / "scene"); }
  static std::vector<std::string> reasons(const ImportReport& report) {
    std::vector<std::string> lines;
    for (const LeftOut& frame : report.left_out) lines.push_back(frame.name + ": " + frame.reason);
    return lines;
  }

  fs::path folder, source;
};

/// The upper left corner of what is stored is red: the pixels that COLMAP saw.
void expect_stored_pixels(const Scene& scene) {
  for (size_t i = 0; i < scene.views.size(); ++i) {
    const ViewData data = load_view(scene, static_cast<int>(i), {});
    EXPECT_GT(data.color.at(2, 2, 0), 0.8f) << data.name;
    EXPECT_GT(data.color.at(data.color.width - 3, data.color.height - 3, 2), 0.8f) << data.name;
  }
}

TEST_F(ImportCaptureTest, TheStoredPixelsAreUsedWhereTheyHaveTheCamerasSize) {
  std::vector<std::string> names;
  for (int orientation = 1; orientation <= 8; ++orientation) {
    names.push_back(fmt::format("{}.jpg", orientation));
    photo(names.back(), orientation);
  }
  model(names);
  EXPECT_EQ(import().left_out.size(), 0u);
  expect_stored_pixels(scene());
  expect_stored_pixels(open_scene(source));  // training on the folder itself gives the same
  for (const View& view : scene().views)
    EXPECT_EQ(read_image_info(view.image).orientation, 1) << "other programs see the same";
}

TEST_F(ImportCaptureTest, ACameraForTheUprightPictureGetsIt) {
  for (const char* name : {"a.jpg", "b.jpg"}) photo(name, 6);
  model({"a.jpg", "b.jpg"}, kHeight, kWidth);
  import();
  const ViewData data = load_view(scene(), 0, {});
  EXPECT_EQ(data.color.height, kWidth);
  EXPECT_GT(data.color.at(kHeight - 3, 2, 0), 0.8f);  // turned clockwise, the red corner comes to the upper right
}

TEST_F(ImportCaptureTest, OneBadFrameIsLeftOutWithItsReason) {
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg", "cut.jpg", "._a.jpg"}) photo(name);
  const std::string whole = read_file(source / "images" / "cut.jpg");
  write_file_atomically(source / "images" / "cut.jpg", whole.substr(0, whole.size() / 2));
  write_file_atomically(source / "images" / "empty.jpg", "");
  model({"a.jpg", "b.jpg", "c.jpg", "cut.jpg", "empty.jpg", "gone.jpg"});
  const ImportReport report = import();
  EXPECT_EQ(report.train + report.test, 3u);
  EXPECT_THAT(reasons(report), AllOf(Contains(HasSubstr("cut: ")), Contains(HasSubstr("empty.jpg: ")),
                                     Contains(HasSubstr("gone.jpg: the photo is missing"))));
  EXPECT_THAT(summary_of(3, report.left_out), HasSubstr("3 of 6 frames"));
  const Scene raw = open_scene(source);  // the same rule where training opens the folder itself
  EXPECT_EQ(raw.train.size(), 3u);
  EXPECT_EQ(raw.left_out.size(), 3u);
}

TEST_F(ImportCaptureTest, StrictAndTooFewAreErrors) {
  photo("a.jpg");
  photo("b.jpg");
  model({"a.jpg", "b.jpg", "gone.jpg"});
  ImportOptions strict;
  strict.strict = true;
  EXPECT_THROW(import(strict), Error);
  EXPECT_FALSE(fs::exists(folder / "scene"));
  fs::remove(source / "images" / "b.jpg");
  EXPECT_THROW(import(), Error);
  EXPECT_FALSE(fs::exists(folder / "scene"));
}

TEST_F(ImportCaptureTest, EqualNamesInSubfoldersAndResizedPhotosAreOneFolderWithOneAnswer) {
  for (const char* name : {"left/1.JPG", "right/1.JPG", "right/2.jpg"}) photo(name, 1, kWidth / 2, kHeight / 2);
  model({"left/1.jpg", "right/1.jpg", "right\\2.png"});
  import();
  for (const Scene& opened : {scene(), open_scene(source)}) {
    ASSERT_EQ(opened.views.size(), 3u);
    EXPECT_EQ(opened.views[0].name, "left/1");
    EXPECT_EQ(opened.views[2].name, "right/2");
    EXPECT_EQ(opened.views[0].camera.width, kWidth / 2);
    EXPECT_NEAR(opened.views[0].camera.fx, 20, 1e-9);
  }
}

TEST_F(ImportCaptureTest, ListsAreSplitAtLineEndsAndCommas) {
  write_file_atomically(folder / "list.txt", "a b.jpg, \"c\"\r\n# a comment\n'd',\n\n  e  \n");
  EXPECT_THAT(read_name_list(folder / "list.txt"), ElementsAre("a b.jpg", "c", "d", "e"));
}

/// A photo of such a name is one.
TEST_F(ImportCaptureTest, TheHeaderOfAListIsNoFrame) {
  for (const char* name : {"a.jpg", "b.jpg", "image.jpg"}) photo(name);
  model({"a.jpg", "b.jpg", "image.jpg"});
  ImportOptions options;
  options.overwrite = true;
  options.train_names = {"Filename", "a.jpg", "b.jpg"};
  import(options);
  EXPECT_EQ(scene().train.size(), 2u);
  options.train_names = {"image", "a.jpg", "b.jpg"};
  import(options);
  EXPECT_EQ(scene().train.size(), 3u);
  options.train_names = {"a.jpg", "filename", "b.jpg"};
  EXPECT_THROW(import(options), Error);
}

TEST_F(ImportCaptureTest, AListWithoutNamesIsRefused) {
  for (const char* text : {"", "# nothing\n", " , ,\r\n"}) {
    write_file_atomically(folder / "list.txt", text);
    EXPECT_THROW(read_name_list(folder / "list.txt"), Error) << text;
  }
}

TEST_F(ImportCaptureTest, AWorldFarFromItsOriginIsMovedInDoublePrecision) {
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) photo(name);
  const Vec3d map{4.5e6, 5.6e6, 300};
  model({"a.jpg", "b.jpg", "c.jpg"}, kWidth, kHeight, map);
  import();
  const Scene moved = scene();
  EXPECT_LT(norm(moved.views[0].camera.centre()), 10);
  const SceneJson description = read_scene_json(folder / "scene" / "scene.json");
  ASSERT_TRUE(description.to_original);
  const Vec3d original = *description.to_original * moved.views[1].camera.centre();
  EXPECT_LT(norm(original - (map + Vec3d{0.3, 0, 0})), 1e-6);
  // A point and the camera that sees it keep their distance to a hundredth of a millimetre.
  Random random(1);
  const Vec3d first{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(2, 4)};
  const Vec3d back = *description.to_original * moved.cloud.positions[0].cast<double>();
  EXPECT_LT(norm(back - map - first), 1e-5);
}

TEST_F(ImportCaptureTest, AWorldInMillimetresIsScaled) {
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) photo(name);
  model({"a.jpg", "b.jpg", "c.jpg"}, kWidth, kHeight, {}, 4000);
  import();
  EXPECT_LT(robust_extent(scene()), 10);
  const SceneJson description = read_scene_json(folder / "scene" / "scene.json");
  ASSERT_TRUE(description.to_original);
  EXPECT_NEAR(
      description.to_original->scale * norm(scene().views[1].camera.centre() - scene().views[0].camera.centre()), 1200,
      1e-6);
}

TEST_F(ImportCaptureTest, WhatTrainingWarnsOfIsReported) {
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) photo(name);
  model({"a.jpg", "b.jpg", "c.jpg"}, kWidth, kHeight, {}, 1);
  EXPECT_THAT(import().warnings, testing::IsEmpty());
  fs::remove_all(folder / "scene");
  fs::remove(source / "sparse" / "0" / "points3D.bin");
  EXPECT_THAT(import().warnings, ElementsAre("sparse: there are no points to start from"));
}

TEST_F(ImportCaptureTest, ARefusalNamesTheSourceAndNoFolderThatIsGone) {
  for (const char* name : {"a.jpg", "b.jpg"}) photo(name);
  model({"a.jpg", "b.jpg"});
  fs::create_directories(source / "masks");
  for (const char* name : {"a.jpg.png", "b.jpg.png"})
    write_png(source / "masks" / name, Image<uint8_t>(kWidth, kHeight, 1, 0));
  try {
    import();
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the mask hides the whole image"));
    EXPECT_THAT(error.what(), testing::Not(HasSubstr(".tmp-")));
    EXPECT_THAT(error.what(), HasSubstr(source.string()));
  }
}

TEST_F(ImportCaptureTest, PhotosWithoutACameraAreNamed) {
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg", "d.jpg"}) photo(name);
  model({"a.jpg", "b.jpg"});
  EXPECT_THAT(read_capture(source).notes, Contains("2 photos are without a camera in the model: c.jpg, d.jpg"));
}

TEST_F(ImportCaptureTest, AModelWithAllPhotosHasNoSuchNote) {
  for (const char* name : {"a.jpg", "b.jpg"}) photo(name);
  model({"a.jpg", "b.jpg"});
  EXPECT_THAT(read_capture(source).notes, testing::IsEmpty());
}

TEST_F(ImportCaptureTest, MasksThatFitNoPhotoAreCounted) {
  for (const char* name : {"a.jpg", "b.jpg"}) photo(name);
  model({"a.jpg", "b.jpg"});
  write_png(source / "masks" / "IMG_1.png", Image<uint8_t>(kWidth, kHeight, 1, 255));
  set_log_level(LogLevel::kWarning);
  testing::internal::CaptureStderr();
  import();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("a mask in masks/ fits no photo: IMG_1.png"));
}

TEST_F(ImportCaptureTest, AMaskOfThePhotoBecomesItsAlpha) {
  for (const char* name : {"a.jpg", "b.jpg"}) photo(name);
  model({"a.jpg", "b.jpg"});
  Image<uint8_t> mask(kWidth, kHeight, 1, 255);
  mask.at(3, 3) = 0;
  write_png(source / "masks" / "a.png", mask);
  import();
  EXPECT_EQ(read_image(scene().views[0].image).at(3, 3, 3), 0);
}

TEST_F(ImportCaptureTest, UpIsRecordedWithItsSource) {
  for (const char* name : {"a.jpg", "b.jpg"}) photo(name);
  model({"a.jpg", "b.jpg"});
  import();
  const SceneJson description = read_scene_json(folder / "scene" / "scene.json");
  ASSERT_TRUE(description.up);
  EXPECT_EQ(description.up->y, -1);
  EXPECT_EQ(description.up_source, "mean up of the cameras");
}

}  // namespace
}  // namespace aligngs
