#include "priors/given_poses.h"

#include <gmock/gmock.h>

#include <fstream>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/jpeg_codec.h"
#include "io/testing/turned_jpeg.h"
#include "priors/scene_from_photos.h"
#include "scene/scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Four photos of 80 x 40 in capture/images.
class GivenPosesTest : public testing::Test {
 protected:
  void SetUp() override {
    capture = fs::path(testing::TempDir()) /
              ("given_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name())) / "capture";
    fs::remove_all(capture.parent_path());
    fs::create_directories(capture / "images");
    for (int i = 0; i < 4; ++i)
      write_png(capture / "images" / (name_of(i) + ".png"), Image<uint8_t>(80, 40, 3, uint8_t(60 + i)));
  }
  static std::string name_of(int i) { return std::string(1, char('a' + i)); }

  /// A model whose camera is for width x height, with some photos in it, in capture/sparse/0.
  void write_model(int width, int height, int photos, const std::string& before = "") const {
    ColmapModel model;
    const double w = width, h = height;
    model.cameras = {{1, "SIMPLE_RADIAL", uint64_t(width), uint64_t(height), {w, w / 2, h / 2, 0.01}}};
    for (int i = 0; i < photos; ++i) {
      ColmapImage image;
      image.id = uint32_t(i + 1);
      image.camera_id = 1;
      image.name = before + name_of(i) + ".png";
      image.rotation = {1, 0, 0, 0};
      image.translation = {0.1 * i, 0, 0};
      model.images.push_back(image);
    }
    for (int i = 0; i < 10; ++i) {
      ColmapPoint point;
      point.id = uint64_t(i);
      point.position = {0.1 * i, 0, 3};
      point.error = i == 0 ? 9 : 0.5;
      model.points.push_back(point);
    }
    fs::create_directories(capture / "sparse" / "0");
    write_colmap_binary(capture / "sparse" / "0", model);
  }
  void write_transforms() const {
    std::ofstream out(capture / "transforms.json");
    out << R"({"fl_x": 70, "w": 80, "h": 40, "test_filenames": ["images/d.png"], "frames": [)";
    for (int i = 0; i < 4; ++i) {
      out << (i ? "," : "") << R"({"file_path": "images/)" << name_of(i) << R"(.png", "transform_matrix": [[1,0,0,)"
          << i << "],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}";
    }
    out << "]}";
  }
  ScenePhotosReport make(ScenePhotosOptions options = {}) const {
    options.method = PosesMethod::kGiven;
    options.threads = 1;
    options.progress.enabled = false;
    return make_scene_from_photos(capture / "images", scene(), ModelStore({}), options);
  }
  std::string error_of_make() const {
    try {
      make();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      return error.what();
    }
    return "";
  }
  fs::path scene() const { return capture.parent_path() / "scene"; }

  fs::path capture;
};

TEST_F(GivenPosesTest, CamerasChooseAmongPhotosOfOneName) {
  write_model(80, 40, 4);
  for (int i = 0; i < 4; ++i)
    write_jpeg(capture / "images" / (name_of(i) + ".jpg"), Image<uint8_t>(80, 40, 3, 250), 90);
  const ScenePhotosReport report = make();
  EXPECT_EQ(report.placed, 4u);
  EXPECT_EQ(report.photos, 4u);
  EXPECT_NEAR(read_image(scene() / "images" / "a.png").data[0], 60, 1);
}

TEST_F(GivenPosesTest, CamerasMayNameHiddenPhotos) {
  for (int i = 0; i < 4; ++i)
    fs::rename(capture / "images" / (name_of(i) + ".png"), capture / "images" / ("." + name_of(i) + ".png"));
  write_model(80, 40, 4, ".");
  EXPECT_EQ(make().placed, 4u);
}

TEST_F(GivenPosesTest, HiddenPhotosWithoutACameraAreNamed) {
  for (int i = 0; i < 4; ++i)
    fs::rename(capture / "images" / (name_of(i) + ".png"), capture / "images" / ("." + name_of(i) + ".png"));
  write_model(80, 40, 4, "x");
  EXPECT_THAT(error_of_make(), HasSubstr("a hidden file is no photo"));
}

TEST_F(GivenPosesTest, AModelBesideThePhotosIsFoundAndItsLensUndone) {
  write_model(80, 40, 4);
  const ScenePhotosReport report = make();
  EXPECT_EQ(report.placed, 4u);
  EXPECT_EQ(report.points, 9u);  // the one with an error of 9 pixels is left out
  const Scene made = open_scene(scene());
  EXPECT_EQ(made.train.size(), 4u);
  EXPECT_NEAR(made.views[2].camera.world_to_camera.translation.x, 0.2, 1e-12);
  EXPECT_NEAR(made.views[2].camera.fx, 80, 4);
}

TEST_F(GivenPosesTest, CamerasFollowPhotosThatAreShrunk) {
  write_model(160, 80, 4);  // found for photos of twice the size
  ScenePhotosOptions options;
  options.max_side = 64;
  make(options);
  const Camera camera = open_scene(scene()).views[0].camera;
  EXPECT_EQ(camera.width, 64);
  EXPECT_NEAR(camera.fx, 64, 3);
}

TEST_F(GivenPosesTest, PhotosHeldUpsideDownKeepTheirStoredPixels) {
  write_model(80, 40, 4);  // its names end in .png
  for (int i = 0; i < 4; ++i) {
    Image<uint8_t> picture(80, 40, 3, 60);
    for (int y = 0; y < 20; ++y) std::fill_n(picture.pixel(0, y), 3 * 80, uint8_t(200));
    fs::remove(capture / "images" / (name_of(i) + ".png"));
    write_file_atomically(capture / "images" / (name_of(i) + ".JPG"), turned_jpeg(encode_jpeg_bytes(picture, 95), 3));
  }
  EXPECT_EQ(make().placed, 4u);
  const Image<uint8_t> upper = read_image(open_scene(scene()).views[0].image);
  EXPECT_GT(upper.at(40, 5), 180);
  EXPECT_LT(upper.at(40, 35), 80);
}

TEST_F(GivenPosesTest, TransformsAreReadWithTheirSplit) {
  write_transforms();
  const ScenePhotosReport report = make();
  EXPECT_EQ(report.train, 3u);
  EXPECT_EQ(report.test, 1u);
  EXPECT_NEAR(open_scene(scene()).views[0].camera.fx, 70, 1e-9);
}

TEST_F(GivenPosesTest, APhotoWithoutACameraIsNamed) {
  write_model(80, 40, 3);
  const ScenePhotosReport report = make();
  ASSERT_EQ(report.unplaced.size(), 1u);
  EXPECT_EQ(report.unplaced[0].name, "d");
}

TEST_F(GivenPosesTest, TooFewCamerasAreRefusedPhotoByPhoto) {
  write_model(80, 40, 1);
  EXPECT_THAT(error_of_make(), testing::AllOf(HasSubstr("1 of 4 photos"), HasSubstr("d: the given cameras hold none")));
}

TEST_F(GivenPosesTest, ACameraForAnotherShapeIsRefused) {
  write_model(80, 60, 4);
  EXPECT_THAT(error_of_make(), HasSubstr("80 x 60"));
}

TEST_F(GivenPosesTest, ACameraForTheTurnedPictureIsExplained) {
  write_model(40, 80, 4);
  EXPECT_THAT(error_of_make(), HasSubstr("turned by a quarter"));
}

TEST_F(GivenPosesTest, AFileOfAModelStandsForIt) {
  write_model(80, 40, 4);
  ScenePhotosOptions options;
  options.cameras = capture / "sparse" / "0" / "cameras.bin";
  EXPECT_EQ(make(options).placed, 4u);
}

TEST_F(GivenPosesTest, WithoutCamerasThePlacesAreNamed) {
  EXPECT_THAT(error_of_make(), testing::AllOf(HasSubstr(capture.string()), HasSubstr("--cameras")));
  EXPECT_THROW(find_given_cameras(capture / "images", capture / "images"), Error);
}

}  // namespace
}  // namespace aligngs
