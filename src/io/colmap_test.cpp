#include "io/colmap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

namespace fs = std::filesystem;

fs::path fresh_folder(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / "colmap_test" / name;
  fs::remove_all(folder);
  return folder;
}

ColmapModel small_model() {
  ColmapModel model;
  model.cameras.push_back({7, "PINHOLE", 640, 480, {500, 501, 320, 240}});
  model.cameras.push_back({2, "OPENCV", 100, 80, {90, 91, 50, 40, 0.1, -0.2, 0.001, 0.002}});
  ColmapImage image;
  image.id = 3;
  image.rotation = {0.5, -0.5, 0.5, 0.5};
  image.translation = {1, 2, -3};
  image.camera_id = 7;
  image.name = "a photo.jpg";
  image.points = {{10.5, 20.25}, {1, 2}};
  image.point_ids = {42, -1};
  model.images.push_back(image);
  image = {};
  image.id = 9;
  image.camera_id = 2;
  image.name = "b.jpg";
  model.images.push_back(image);
  ColmapPoint point;
  point.id = 42;
  point.position = {0.1, 0.2, 0.3};
  point.color = {255, 0, 7};
  point.error = 0.65;
  point.track = {{3, 0}};
  model.points.push_back(point);
  return model;
}

void expect_small_model(const ColmapModel& model) {
  ASSERT_EQ(model.cameras.size(), 2u);
  EXPECT_EQ(model.cameras[0].id, 7u);
  EXPECT_EQ(model.cameras[0].model, "PINHOLE");
  EXPECT_EQ(model.cameras[0].height, 480u);
  EXPECT_THAT(model.cameras[1].params, ElementsAre(90, 91, 50, 40, 0.1, -0.2, 0.001, 0.002));
  ASSERT_EQ(model.images.size(), 2u);
  EXPECT_EQ(model.images[0].name, "a photo.jpg");
  EXPECT_EQ(model.images[0].rotation.x, -0.5);
  EXPECT_EQ(model.images[0].translation.z, -3);
  EXPECT_EQ(model.images[0].points.at(0).y, 20.25);
  EXPECT_THAT(model.images[0].point_ids, ElementsAre(42, -1));
  EXPECT_EQ(model.images[1].camera_id, 2u);
  EXPECT_TRUE(model.images[1].points.empty());
  ASSERT_EQ(model.points.size(), 1u);
  EXPECT_EQ(model.points[0].id, 42u);
  EXPECT_EQ(model.points[0].position.y, 0.2);
  EXPECT_THAT(model.points[0].color, ElementsAre(255, 0, 7));
  EXPECT_THAT(model.points[0].track, ElementsAre(Pair(3, 0)));
}

const std::string kCamerasText =
    "# Camera list\r\n7 PINHOLE 640 480 500 501 320 240\r\n2 OPENCV 100 80 90 91 50 40 0.1 -0.2 "
    "0.001 0.002\r\n";
const std::string kImagesText =
    "# Image list\n3 0.5 -0.5 0.5 0.5 1 2 -3 7 a photo.jpg\n10.5 20.25 42 1 2 -1\n\n9 1 0 0 0 0 0 "
    "0 2 b.jpg\n";
const std::string kPointsText = "# 3D point list\n42 0.1 0.2 0.3 255 0 7 0.65 3 0\n";

fs::path text_model(const std::string& name, const std::string& cameras,
                    const std::string& images) {
  const fs::path folder = fresh_folder(name);
  write_file_atomically(folder / "cameras.txt", cameras);
  write_file_atomically(folder / "images.txt", images);
  return folder;
}

void expect_bad(const fs::path& folder, const std::string& file, const std::string& field,
                const std::string& message) {
  try {
    read_colmap_model(folder);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, file.empty() ? folder : folder / file);
    EXPECT_THAT(error.details().field, HasSubstr(field));
    EXPECT_THAT(error.details().message, HasSubstr(message));
  }
}

TEST(Colmap, BinaryRoundTrip) {
  const fs::path folder = fresh_folder("binary");
  write_colmap_binary(folder, small_model());
  expect_small_model(read_colmap_model(folder));
}

TEST(Colmap, TextMeansTheSame) {
  const fs::path folder = text_model("text", kCamerasText, kImagesText);
  write_file_atomically(folder / "points3D.txt", kPointsText);
  expect_small_model(read_colmap_model(folder));
}

TEST(Colmap, EmptyKeypointLinesKeepTheImagesApart) {
  const fs::path folder =
      text_model("empty_lines", kCamerasText,
                 "1 1 0 0 0 0 0 0 7 a.jpg\n\n2 1 0 0 0 0 0 0 7 b.jpg\n\n3 1 0 0 0 0 0 0 7 c.jpg\n");
  EXPECT_EQ(read_colmap_model(folder).images.size(), 3u);
}

TEST(Colmap, BinaryIsPreferredFileByFile) {
  const fs::path folder = text_model("mixed", kCamerasText, "this text is not read\n");
  const fs::path binary = fresh_folder("mixed_binary");
  write_colmap_binary(binary, small_model());
  fs::copy_file(binary / "images.bin", folder / "images.bin");
  EXPECT_EQ(read_colmap_model(folder).images.size(), 2u);
}

TEST(Colmap, PointsMayBeAbsent) {
  const fs::path folder = fresh_folder("no_points");
  write_colmap_binary(folder, small_model());
  fs::remove(folder / "points3D.bin");
  EXPECT_TRUE(read_colmap_model(folder).points.empty());
}

TEST(Colmap, EveryModelHasItsParameterCount) {
  const std::vector<std::pair<std::string, size_t>> models = {{"SIMPLE_PINHOLE", 3},
                                                              {"PINHOLE", 4},
                                                              {"SIMPLE_RADIAL", 4},
                                                              {"RADIAL", 5},
                                                              {"OPENCV", 8},
                                                              {"OPENCV_FISHEYE", 8},
                                                              {"FULL_OPENCV", 12},
                                                              {"FOV", 5},
                                                              {"SIMPLE_RADIAL_FISHEYE", 4},
                                                              {"RADIAL_FISHEYE", 5},
                                                              {"THIN_PRISM_FISHEYE", 12}};
  std::string cameras;
  append_little(cameras, uint64_t(models.size()));
  for (size_t id = 0; id < models.size(); ++id) {
    append_little(cameras, uint32_t(id));
    append_little(cameras, int32_t(id));
    append_little(cameras, uint64_t(64));
    append_little(cameras, uint64_t(48));
    for (size_t i = 0; i < models[id].second; ++i) append_little(cameras, double(id));
  }
  const ColmapModel model = decode_colmap_binary(cameras, std::string(8, '\0'), "", "");
  ASSERT_EQ(model.cameras.size(), models.size());
  for (size_t id = 0; id < models.size(); ++id) {
    EXPECT_EQ(model.cameras[id].model, models[id].first);
    EXPECT_EQ(model.cameras[id].params.size(), models[id].second);
  }
}

TEST(Colmap, NamesWhatIsWrongWithAPose) {
  const std::string end = " 7 a.jpg\n\n";
  expect_bad(text_model("nan", kCamerasText, "3 1 0 0 0 nan 0 0" + end), "images.txt",
             "image 3 (a.jpg)", "not finite");
  expect_bad(text_model("inf", kCamerasText, "3 1 inf 0 0 0 0 0" + end), "images.txt",
             "image 3 (a.jpg)", "not finite");
  expect_bad(text_model("zero", kCamerasText, "3 0 0 0 0 0 0 0" + end), "images.txt",
             "image 3 (a.jpg)", "zero");
  expect_bad(text_model("camera", kCamerasText, "3 1 0 0 0 0 0 0 5 a.jpg\n\n"), "images.txt",
             "image 3 (a.jpg)", "camera 5");
  expect_bad(text_model("name", kCamerasText, "3 1 0 0 0 0 0 0 7\n\n"), "images.txt", "image 3",
             "name is missing");
}

TEST(Colmap, NamesWhatIsWrongInText) {
  expect_bad(text_model("model", "1 CUBE 64 48 1 2 3\n", ""), "cameras.txt", "line 1, MODEL",
             "CUBE");
  expect_bad(text_model("few", "1 PINHOLE 64 48 1 2 3\n", ""), "cameras.txt", "line 1, PARAMS",
             "missing");
  expect_bad(text_model("many", "1 PINHOLE 64 48 1 2 3 4 5\n", ""), "cameras.txt", "line 1, PARAMS",
             "too many");
  expect_bad(text_model("size", "1 PINHOLE 64 0 1 2 3 4\n", ""), "cameras.txt", "camera 1", "64x0");
  expect_bad(text_model("word", kCamerasText, "\n3 1 0 zero 0 0 0 0 7 a.jpg\n\n"), "images.txt",
             "line 2, QY", "zero");
  expect_bad(text_model("twice", kCamerasText, "3 1 0 0 0 0 0 0 7 a\n\n3 1 0 0 0 0 0 0 7 b\n\n"),
             "images.txt", "image 3", "twice");
}

TEST(Colmap, RefusesUnknownBinaryModelsAndHugeCounts) {
  std::string cameras;
  append_little(cameras, uint64_t(1));
  append_little(cameras, uint32_t(1));
  append_little(cameras, int32_t(99));
  cameras += std::string(40, '\0');
  EXPECT_THROW(decode_colmap_binary(cameras, std::string(8, '\0'), "", ""), Error);
  const std::string many(8, '\xff');
  EXPECT_THROW(decode_colmap_binary(many, std::string(8, '\0'), "", ""), Error);
  EXPECT_THROW(decode_colmap_binary(std::string(8, '\0'), many, "", ""), Error);
  EXPECT_THROW(decode_colmap_binary(std::string(8, '\0'), std::string(8, '\0'), many, ""), Error);
}

TEST(Colmap, FindsTheModelOfAScene) {
  const fs::path scene = fresh_folder("scene");
  EXPECT_THROW(find_colmap_folder(scene), Error);
  write_colmap_binary(scene, small_model());
  EXPECT_EQ(find_colmap_folder(scene), scene);
  write_colmap_binary(scene / "sparse", small_model());
  EXPECT_EQ(find_colmap_folder(scene), scene / "sparse");
  ColmapModel one_image = small_model();
  one_image.images.pop_back();
  write_colmap_binary(scene / "sparse" / "0", one_image);
  EXPECT_EQ(find_colmap_folder(scene), scene / "sparse" / "0");
  write_colmap_binary(scene / "sparse" / "1", small_model());
  EXPECT_EQ(find_colmap_folder(scene), scene / "sparse" / "1");
  EXPECT_EQ(find_colmap_folder(scene / "sparse"), scene / "sparse" / "1");
}

TEST(Colmap, MissingFilesAreNamed) {
  expect_bad(fresh_folder("nothing"), "", "cameras", "cameras.bin");
}

TEST(Colmap, ReadsARealModel) {
  const fs::path folder = fs::path(ALIGNGS_SOURCE_DIR) / "../shared/data/kitchen_rgbd";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not here";
  size_t models = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().filename() != "cameras.bin" && entry.path().filename() != "cameras.txt")
      continue;
    const ColmapModel model = read_colmap_model(entry.path().parent_path());
    EXPECT_FALSE(model.images.empty()) << entry.path();
    ++models;
  }
  EXPECT_GT(models, 0u);
}

}  // namespace
}  // namespace aligngs
