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

fs::path model_folder(const std::string& name) {
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

fs::path text_model(const std::string& name, const std::string& cameras, const std::string& images) {
  const fs::path folder = model_folder(name);
  write_file_atomically(folder / "cameras.txt", cameras);
  write_file_atomically(folder / "images.txt", images);
  return folder;
}

void expect_bad_model(const fs::path& folder, const std::string& file, const std::string& field,
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
  const fs::path folder = model_folder("binary");
  write_colmap_binary(folder, small_model());
  expect_small_model(read_colmap_model(folder));
}

TEST(Colmap, TextMeansTheSame) {
  const fs::path folder = text_model("text", kCamerasText, kImagesText);
  write_file_atomically(folder / "points3D.txt", kPointsText);
  expect_small_model(read_colmap_model(folder));
}

TEST(Colmap, EmptyKeypointLinesKeepTheImagesApart) {
  const fs::path folder = text_model("empty_lines", kCamerasText,
                                     "1 1 0 0 0 0 0 0 7 a.jpg\n\n2 1 0 0 0 0 0 0 7 b.jpg\n\n3 1 0 0 0 0 0 0 7 c.jpg\n");
  EXPECT_EQ(read_colmap_model(folder).images.size(), 3u);
}

TEST(Colmap, BinaryIsPreferredWhereItIsWhole) {
  const fs::path folder = text_model("whole_binary", kCamerasText, "this text is not read\n");
  write_colmap_binary(folder, small_model());
  EXPECT_EQ(read_colmap_model(folder).images.size(), 2u);
}

TEST(Colmap, AFileThatAnotherModelLeftIsNotMixedWithAWholeText) {
  const fs::path folder = text_model("left_binary", kCamerasText, kImagesText);
  const fs::path other = model_folder("left_binary_other");
  ColmapModel small = small_model();
  small.cameras[0].params[0] = 1;
  small.images.pop_back();
  write_colmap_binary(other, small);
  for (const char* file : {"cameras.bin", "images.bin"}) {
    fs::copy_file(other / file, folder / file);
    const ColmapModel model = read_colmap_model(folder);
    EXPECT_EQ(model.cameras[0].params[0], 500) << file;
    EXPECT_EQ(model.images.size(), 2u) << file;
    fs::remove(folder / file);
  }
}

TEST(Colmap, TheOnlyModelBesideThePhotosIsFoundUnderAnyName) {
  const fs::path scene = model_folder("any_name");
  write_colmap_binary(scene / "dslr_calibration_undistorted", small_model());
  EXPECT_FALSE(may_hold_colmap_model(scene)) << "a folder with models and no photos";
  fs::create_directories(scene / "images" / "dslr_images_undistorted");
  EXPECT_TRUE(may_hold_colmap_model(scene));
  EXPECT_EQ(find_colmap_folder(scene), scene / "dslr_calibration_undistorted");
  EXPECT_THAT(choice_of_model(scene), HasSubstr("dslr_calibration_undistorted is used"));
  write_colmap_binary(scene / "dslr_calibration_jpg", small_model());
  EXPECT_FALSE(may_hold_colmap_model(scene)) << "two models, of which neither is meant more";
}

TEST(Colmap, TwoKindsOfOneModelThatDifferAreTold) {
  const fs::path folder = text_model("two_kinds", kCamerasText, kImagesText);
  EXPECT_EQ(choice_of_model(folder), "");
  ColmapModel one_image = small_model();
  one_image.images.pop_back();
  write_colmap_binary(folder, one_image);
  EXPECT_THAT(choice_of_model(folder), HasSubstr("images.bin is used, with 1 images; images.txt beside it has"));
  write_file_atomically(folder / "images.txt", "notes\n");
  EXPECT_EQ(choice_of_model(folder), "");
}

TEST(Colmap, OnePanoramaIsNoDamagedFile) {
  std::string cameras;
  append_little(cameras, uint64_t(1));
  append_little(cameras, uint32_t(1));
  append_little(cameras, int32_t(17));
  for (const uint64_t side : {96, 72}) append_little(cameras, side);
  for (const double side : {96, 72}) append_little(cameras, side);
  EXPECT_EQ(decode_colmap_binary(cameras, std::string(8, '\0'), "", "").cameras.at(0).model, "EQUIRECTANGULAR");
}

TEST(Colmap, PointsMayBeAbsent) {
  const fs::path folder = model_folder("no_points");
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
                                                              {"THIN_PRISM_FISHEYE", 12},
                                                              {"RAD_TAN_THIN_PRISM_FISHEYE", 16},
                                                              {"SIMPLE_DIVISION", 4},
                                                              {"DIVISION", 5},
                                                              {"SIMPLE_FISHEYE", 3},
                                                              {"FISHEYE", 4},
                                                              {"EUCM", 6},
                                                              {"EQUIRECTANGULAR", 2}};
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

/// The reason for which one image beside a good one is left out.
std::string why_left_out(const std::string& name, const std::string& cameras, const std::string& image) {
  const ColmapModel model = read_colmap_model(text_model(name, cameras, image + "\n\n8 1 0 0 0 0 0 0 7 good.jpg\n\n"));
  EXPECT_EQ(model.images.size(), 1u);
  EXPECT_EQ(model.images.at(0).name, "good.jpg");
  return model.left_out.size() == 1 ? model.left_out[0].name + ": " + model.left_out[0].reason : "";
}

TEST(Colmap, AnImageThatCannotBeUsedIsLeftOutWithItsReason) {
  const std::string end = " 7 a.jpg";
  EXPECT_THAT(why_left_out("nan", kCamerasText, "3 1 0 0 0 nan 0 0" + end),
              HasSubstr("/images.txt, image 3 (a.jpg): the pose is not finite"));
  EXPECT_THAT(why_left_out("inf", kCamerasText, "3 1 inf 0 0 0 0 0" + end), HasSubstr("not finite"));
  EXPECT_THAT(why_left_out("zero", kCamerasText, "3 0 0 0 0 0 0 0" + end), HasSubstr("zero"));
  EXPECT_THAT(why_left_out("camera", kCamerasText, "3 1 0 0 0 0 0 0 5 a.jpg"), HasSubstr("camera 5"));
  EXPECT_THAT(why_left_out("name", kCamerasText, "3 1 0 0 0 0 0 0 7"), HasSubstr("name is missing"));
  EXPECT_THAT(why_left_out("twice", kCamerasText, "3 1 0 0 0 0 0 0 7 good.jpg"), HasSubstr("listed twice"));
  EXPECT_THAT(why_left_out("size", kCamerasText + "1 PINHOLE 64 0 1 2 3 4\n", "3 1 0 0 0 0 0 0 1 a.jpg"),
              HasSubstr("64x0"));
}

TEST(Colmap, PointsThatAreNotFiniteAreCounted) {
  const fs::path folder = text_model("points", kCamerasText, kImagesText);
  write_file_atomically(folder / "points3D.txt", "1 nan 0 0 1 2 3 0.5\n2 0 0 1 1 2 3 0.5\n");
  const ColmapModel model = read_colmap_model(folder);
  EXPECT_EQ(model.points.size(), 1u);
  EXPECT_EQ(model.points_left_out, 1u);
}

TEST(Colmap, CamerasAndPointsBeyondAllOthersAreLeftOut) {
  std::string images, points;
  for (int i = 1; i <= 6; ++i) {
    images += std::to_string(i) + " 1 0 0 0 " + (i == 2 ? "1e8" : "0." + std::to_string(i)) + " 0 0 7 " +
              std::to_string(i) + ".jpg\n";
    points += std::to_string(i) + " 0 " + (i == 5 ? "-1e9" : "0." + std::to_string(i)) + " 0 1 2 3 0.5\n";
  }
  const fs::path folder = text_model("far", kCamerasText, images);
  write_file_atomically(folder / "points3D.txt", points);
  const ColmapModel model = read_colmap_model(folder);
  ASSERT_EQ(model.left_out.size(), 1u);
  EXPECT_EQ(model.left_out[0].name, "2.jpg");
  EXPECT_EQ(model.images.size(), 5u);
  EXPECT_EQ(model.points_left_out, 1u);
}

TEST(Colmap, SecondLinesMayBeMissing) {
  const ColmapModel model =
      read_colmap_model(text_model("second", kCamerasText,
                                   "1 1 0 0 0 0 0 0 7 a 1.jpg\n2 1 0 0 0 0 0 0 7 b.jpg\n# the last\n3 1 0 0 0 0 0 0 7 "
                                   "000012\n4 1 0 0 0 0 0 0 7 d.jpg\n1 2 -1 3 4 -1 5 6 -1 7 8 9\n"));
  ASSERT_EQ(model.images.size(), 4u);
  EXPECT_EQ(model.images[0].name, "a 1.jpg");
  EXPECT_EQ(model.images[2].name, "000012");
  EXPECT_EQ(model.images[3].points.size(), 4u);
}

TEST(Colmap, CommentsMayStandBeforeASecondLine) {
  const ColmapModel model = read_colmap_model(
      text_model("comment", kCamerasText, "1 1 0 0 0 0 0 0 7 a.jpg\n# its keypoints\n10 20 -1 30 40 5\n"));
  ASSERT_EQ(model.images.size(), 1u);
  EXPECT_THAT(model.images[0].point_ids, ElementsAre(-1, 5));
}

TEST(Colmap, TextMayHaveAByteOrderMarkAndUnsignedIds) {
  const std::string mark = "\xef\xbb\xbf";
  const fs::path folder =
      text_model("mark", mark + kCamerasText, mark + "3 1 0 0 0 0 0 0 7 a.jpg\n1 2 18446744073709551615 3 4 42\n");
  write_file_atomically(folder / "points3D.txt", mark + "18446744073709551615 0 0 1 1 2 3 0.5\n");
  const ColmapModel model = read_colmap_model(folder);
  EXPECT_THAT(model.images.at(0).point_ids, ElementsAre(-1, 42));
  EXPECT_EQ(model.points.at(0).id, ~uint64_t(0));
}

TEST(Colmap, APlyCountsWhereThereAreNoOtherPoints) {
  const fs::path folder = text_model("ply", kCamerasText, kImagesText);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\nproperty "
      "uchar red\n"
      "property uchar green\nproperty uchar blue\nend_header\n1000000.25 2 3 9 8 7\n";
  write_file_atomically(folder / "points3D.ply", ply);
  const ColmapModel model = read_colmap_model(folder);
  ASSERT_EQ(model.points.size(), 1u);
  EXPECT_EQ(model.points[0].position.x, 1000000.25);
  EXPECT_THAT(model.points[0].color, ElementsAre(9, 8, 7));
}

TEST(Colmap, APlyMayHaveColoursOfOtherKinds) {
  const auto color_of = [](const std::string& properties, const std::string& values) {
    const fs::path folder = text_model("ply_colors", kCamerasText, kImagesText);
    write_file_atomically(folder / "points3D.ply",
                          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                          "float y\nproperty float z\n" +
                              properties + "end_header\n1 2 3 " + values + "\n");
    return read_colmap_model(folder).points.at(0).color;
  };
  EXPECT_THAT(color_of("property float red\nproperty float green\nproperty float blue\n", "1 0.2 0"),
              ElementsAre(255, 51, 0));
  EXPECT_THAT(color_of("property uchar r\nproperty uchar g\nproperty uchar b\n", "9 8 7"), ElementsAre(9, 8, 7));
  EXPECT_THAT(color_of("property ushort red\nproperty ushort green\nproperty ushort blue\n", "65535 0 257"),
              ElementsAre(255, 0, 1));
  EXPECT_THAT(color_of("", ""), ElementsAre(128, 128, 128)) << "unknown";
}

TEST(Colmap, APlyAloneIsNamedForWhatItIs) {
  const fs::path scene = model_folder("ply_alone");
  write_file_atomically(scene / "sparse" / "0" / "points3D.ply", "ply\n");
  try {
    find_colmap_folder(scene);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("cloud of points without cameras"));
  }
}

TEST(Colmap, ModelsInFoldersOfTheFolderAreNamed) {
  const fs::path folder = model_folder("several_models");
  for (const char* name : {"unknown_lens", "known_lens"}) write_colmap_binary(folder / name, small_model());
  try {
    find_colmap_folder(folder);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.details().remedy, "name one of the folders that hold one: " + (folder / "known_lens").string() +
                                          ", " + (folder / "unknown_lens").string());
  }
}

TEST(Colmap, NamesWhatIsWrongInText) {
  expect_bad_model(text_model("model", "1 CUBE 64 48 1 2 3\n", ""), "cameras.txt", "line 1, MODEL", "CUBE");
  expect_bad_model(text_model("few", "1 PINHOLE 64 48 1 2 3\n", ""), "cameras.txt", "line 1, PARAMS", "missing");
  expect_bad_model(text_model("many", "1 PINHOLE 64 48 1 2 3 4 5\n", ""), "cameras.txt", "line 1, PARAMS", "too many");
  expect_bad_model(text_model("camera_twice", kCamerasText + "7 PINHOLE 64 48 1 2 3 4\n", ""), "cameras.txt",
                   "camera 7", "twice");
  expect_bad_model(text_model("word", kCamerasText, "\n3 1 0 zero 0 0 0 0 7 a.jpg\n\n"), "images.txt", "line 2, QY",
                   "zero");
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
  const fs::path scene = model_folder("scene");
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
  EXPECT_THAT(choice_of_model(scene), HasSubstr("model 1 of"));
  EXPECT_THAT(choice_of_model(scene), HasSubstr("with 2 images (0 has 1)"));
}

TEST(Colmap, FindsTheModelWhereNerfstudioPutsIt) {
  const fs::path scene = model_folder("nerfstudio");
  write_colmap_binary(scene / "colmap" / "sparse" / "0", small_model());
  EXPECT_TRUE(may_hold_colmap_model(scene));
  EXPECT_EQ(find_colmap_folder(scene), scene / "colmap" / "sparse" / "0");
  EXPECT_EQ(choice_of_model(scene), "");
}

TEST(Colmap, MissingFilesAreNamed) { expect_bad_model(model_folder("nothing"), "", "cameras", "cameras.bin"); }

TEST(Colmap, ReadsARealModel) {
  const fs::path folder = fs::path(ALIGNGS_SOURCE_DIR) / "../shared/data/kitchen_rgbd";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not here";
  size_t models = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().filename() != "cameras.bin" && entry.path().filename() != "cameras.txt") continue;
    const ColmapModel model = read_colmap_model(entry.path().parent_path());
    EXPECT_FALSE(model.images.empty()) << entry.path();
    ++models;
  }
  EXPECT_GT(models, 0u);
}

}  // namespace
}  // namespace aligngs
