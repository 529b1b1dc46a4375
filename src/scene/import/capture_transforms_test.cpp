// transforms.json of nerfstudio, instant-ngp and Blender.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "core/error.h"
#include "scene/import/capture_split.h"
#include "scene/import/testing/capture_folder.h"
#include "scene/photo_lookup.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(CaptureTest, ReadsTransformsJsonWithOverridesAndDistortion) {
  image("images/a.png");
  image("images/b.png");
  const std::string matrix = "[[0,1,0,1],[1,0,0,2],[0,0,-1,3],[0,0,0,1]]";
  write("transforms.json",
        fmt::format(
            R"({{"fl_x": 30, "fl_y": 31, "cx": 16, "cy": 12, "w": 32, "h": 24, "test_filenames": ["images/b.png"],
          "frames": [{{"file_path": "images/a.png", "transform_matrix": {0}}},
                     {{"file_path": "images/b.png", "fl_x": 40, "k1": 0.1, "transform_matrix": {0}}}]}})",
            matrix));
  const Capture capture = read_capture(folder_);
  EXPECT_EQ(capture.layout, "nerfstudio");
  ASSERT_EQ(capture.frames.size(), 2u);
  EXPECT_EQ(capture.frames[0].camera.model, "PINHOLE");
  EXPECT_EQ(capture.frames[1].camera.model, "OPENCV");
  EXPECT_THAT(capture.frames[1].camera.params, ElementsAre(40, 31, 16, 12, 0.1, 0, 0, 0));
  EXPECT_NEAR(norm(capture.frames[0].world_to_camera * Vec3d{1, 2, 5} - Vec3d{0, 0, 2}), 0, 1e-12);
  EXPECT_THAT(capture.test, ElementsAre("b"));
}

TEST_F(CaptureTest, AMatrixMayBeOneListOfNumbers) {
  image("images/a.png");
  write("transforms.json",
        R"({"fl_x": 30, "cx": 16, "cy": 12, "w": 32, "h": 24, "frames": [{"file_path": "images/a.png",
            "transform_matrix": [0,1,0,1, 1,0,0,2, 0,0,-1,3, 0,0,0,1]}]})");
  expect_one_known_camera(read_capture(folder_));
}

TEST_F(CaptureTest, AMatrixOfIntrinsicsIsRead) {
  image("images/a.png");
  const auto params = [&](const std::string& intrinsics) {
    write("transforms.json", "{" + intrinsics + R"(, "frames": [{"file_path": "images/a.png",
            "transform_matrix": [[0,1,0,1], [1,0,0,2], [0,0,-1,3], [0,0,0,1]]}]})");
    return read_capture(folder_).frames.at(0).camera.params;
  };
  for (const char* field : {R"("camera_intrinsics": [[30,0,16],[0,31,12],[0,0,1]])", R"("K": [30,0,16,0,31,12,0,0,1])",
                            R"("intrinsic_matrix": [[30,0,16,0],[0,31,12,0],[0,0,1,0],[0,0,0,1]])"})
    EXPECT_THAT(params(field), ElementsAre(30, 31, 16, 12)) << field;
  EXPECT_THAT(params(R"("fl_x": 30, "fl_y": 31, "K": [40,0,16,0,40,12,0,0,1])"), ElementsAre(30, 31, 16, 12));
  for (const char* field : {R"("K": [30,0.5,16,0,31,12,0,0,1])", R"("K": [30,0,0,0,31,0,16,12,1])",
                            R"("K": [30,31,16,12])", R"("K": [[30,0,16],[0,"x",12],[0,0,1]])"})
    EXPECT_THROW(params(field), Error) << field;
}

TEST_F(CaptureTest, CommentsAndLastCommasOfTransformsJsonAreLeftOut) {
  image("images/a.png");
  write("transforms.json", R"({"fl_x": 30, // pixels
            "cx": 16, "cy": 12, "w": 32, "h": 24, /* of the photos */ "frames": [{"file_path": "images/a.png",
            "transform_matrix": [[0,1,0,1], [1,0,0,2], [0,0,-1,3], [0,0,0,1],],},]})");
  expect_one_known_camera(read_capture(folder_));
}

/// A transforms.json of one frame with these further fields.
class TransformsTest : public CaptureTest {
 protected:
  Capture read(const std::string& fields, const std::string& frame_fields = "", const std::string& matrix = kMatrix) {
    if (!fs::exists(folder_ / "images" / "a.png")) image("images/a.png");
    write(
        "transforms.json",
        fmt::format(
            R"({{"fl_x": 30, "fl_y": 31, "cx": 16, "cy": 12{}, "frames": [{{"file_path": "images/a.png", "transform_matrix": {}{}}}]}})",
            fields, matrix, frame_fields));
    return read_capture(folder_);
  }
  std::string error_of(const std::string& fields, const std::string& frame = "") {
    try {
      read(fields, frame);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  static constexpr const char* kMatrix = "[[0,1,0,1],[1,0,0,2],[0,0,-1,3],[0,0,0,1]]";
};

TEST_F(TransformsTest, AFisheyeIsOneAlsoWithoutCoefficients) {
  for (const char* fields : {R"(, "camera_model": "OPENCV_FISHEYE")", R"(, "is_fisheye": true)"}) {
    const Capture capture = read(fields);
    EXPECT_EQ(capture.frames[0].camera.model, "THIN_PRISM_FISHEYE") << fields;
  }
  const Capture bent = read(R"(, "camera_model": "OPENCV_FISHEYE", "k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4)");
  EXPECT_THAT(bent.frames[0].camera.params, ElementsAre(30, 31, 16, 12, 0.1, 0.2, 0, 0, 0.3, 0.4, 0, 0));
}

TEST_F(TransformsTest, TheThirdRadialTermOfAPerspectiveLensIsUsed) {
  const Capture capture =
      read(R"(, "camera_model": "OPENCV", "k1": 0.1, "k2": 0.2, "k3": 0.3, "p1": 0.01, "p2": 0.02)");
  EXPECT_EQ(capture.frames[0].camera.model, "FULL_OPENCV");
  EXPECT_THAT(capture.frames[0].camera.params, ElementsAre(30, 31, 16, 12, 0.1, 0.2, 0.01, 0.02, 0.3, 0, 0, 0));
  const Capture list = read(R"(, "distortion_params": [0.1, 0.2, 0, 0, 0.01, 0.02])");
  EXPECT_THAT(list.frames[0].camera.params, ElementsAre(30, 31, 16, 12, 0.1, 0.2, 0.01, 0.02));
}

TEST_F(TransformsTest, LensesThatAreNotUndoneAreRefusedByName) {
  EXPECT_THAT(error_of(R"(, "camera_model": "EQUIRECTANGULAR")"), HasSubstr("EQUIRECTANGULAR"));
  EXPECT_THAT(error_of(R"(, "k4": 0.1)"), HasSubstr("k4"));
  EXPECT_THAT(error_of(R"(, "latlong": true)"), HasSubstr("latlong"));
}

TEST_F(TransformsTest, AnAngleThatContradictsTheFocalLengthIsNamed) {
  EXPECT_THAT(read(R"(, "camera_angle_x": 0.3)").notes,
              ElementsAre(AllOf(HasSubstr("camera_angle_x is not used"), HasSubstr("fl_x says 30"))));
  EXPECT_TRUE(read(R"(, "camera_angle_x": 0.98)").notes.empty());  // 2 atan(16 / 30)
}

TEST_F(TransformsTest, NumbersThatNoLensHasAreRefusedByName) {
  EXPECT_THAT(error_of(R"(, "fl_x": -30)"), HasSubstr("fl_x: a negative focal length"));
  EXPECT_THAT(error_of(R"(, "fl_x": 0)"), HasSubstr("fl_x: a focal length of 0")) << "fl_y is 31";
  EXPECT_THAT(error_of(R"(, "k1": NaN)"), HasSubstr("k1: expected a finite number"));
  EXPECT_THAT(error_of(R"(, "cx": 64)"), HasSubstr("w and h are absent"));
  EXPECT_THAT(error_of(R"(, "depth_unit_scale_factor": -1)"), HasSubstr("depth_unit_scale_factor"));
  EXPECT_THAT(error_of(R"(, "ply_file_path": "points.ply")"), HasSubstr("ply_file_path: the points are missing"));
  EXPECT_EQ(read(R"(, "cx": 64, "w": 32, "h": 24)").frames.size(), 1u) << "a part of a larger photo";
}

TEST_F(TransformsTest, AnUnknownObjectIsListed) {
  EXPECT_THAT(read(R"(, "lens": {"k1": 0.2})").notes, ElementsAre(HasSubstr("lens")));
}

TEST_F(TransformsTest, ShrunkPhotosStandForMissingOnes) {
  image("images_4/a.png");
  fs::create_directories(folder_ / "images_8");
  write(
      "transforms.json",
      fmt::format(
          R"({{"fl_x": 120, "w": 128, "h": 96, "frames": [{{"file_path": "images/a.png", "transform_matrix": {}}}]}})",
          kMatrix));
  const Capture capture = read_capture(folder_);
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_EQ(capture.frames[0].image, folder_ / "images_4" / "a.png");
  EXPECT_NEAR(capture.frames[0].camera.params[0], 30, 1e-9);
}

TEST_F(TransformsTest, DepthHasTheUnitThatTheFileStates) {
  depth("depth/a.png", 2000);
  const std::string frame = R"(, "depth_path": "depth\\a.png")";
  EXPECT_FLOAT_EQ(read_capture_depth(read("", frame), read("", frame).frames[0]).at(5, 5), 2.0f);
  for (const char* key : {"integer_depth_scale", "depth_unit_scale_factor"}) {
    const Capture capture = read(fmt::format(R"(, "{}": 0.0002)", key), frame);
    EXPECT_FLOAT_EQ(read_capture_depth(capture, capture.frames[0]).at(5, 5), 0.4f) << key;
    EXPECT_THAT(error_of(fmt::format(R"(, "{}": 0)", key), frame), HasSubstr(key));
    EXPECT_EQ(read(fmt::format(R"(, "{}": 0)", key)).frames.size(), 1u) << "without depth";
  }
}

TEST_F(TransformsTest, AFrameMayStateTheUnitOfItsDepth) {
  depth("depth/a.png", 2000);
  const Capture capture = read(R"(, "depth_unit_scale_factor": 0.01)",
                               R"(, "depth_file_path": "depth/a.png", "depth_unit_scale_factor": 0.00025)");
  EXPECT_FLOAT_EQ(read_capture_depth(capture, capture.frames[0]).at(5, 5), 0.5f);
}

TEST_F(TransformsTest, AllRadialTermsOfTheFullModelAreUsed) {
  const std::string terms = R"(, "k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4, "k5": 0.5, "k6": 0.6)";
  const Capture capture = read(R"(, "camera_model": "FULL_OPENCV")" + terms);
  EXPECT_THAT(capture.frames[0].camera.params, ElementsAre(30, 31, 16, 12, 0.1, 0.2, 0, 0, 0.3, 0.4, 0.5, 0.6));
}

TEST_F(TransformsTest, RadialTermsThatALensHasNotAreRefused) {
  for (const char* key : {"k4", "k5", "k6"})
    EXPECT_THAT(error_of(fmt::format(R"(, "camera_model": "OPENCV", "{}": 0.1)", key)), HasSubstr(key));
  EXPECT_THAT(error_of(R"(, "camera_model": "OPENCV_FISHEYE", "k5": 0.1)"), HasSubstr("k5"));
}

TEST_F(TransformsTest, FramesThatAreHeldOutTest) {
  image("images/b.png");
  const Capture capture =
      read(fmt::format(R"(, "test_frames": [{{"file_path": "images/b.png", "transform_matrix": {}}}])", kMatrix));
  EXPECT_THAT(capture.train, ElementsAre("a"));
  EXPECT_THAT(capture.test, ElementsAre("b"));
  EXPECT_EQ(capture.frames.size(), 2u);
}

TEST_F(TransformsTest, AFrameOfBothTestListsTestsOnce) {
  for (const char* name : {"images/b.png", "images/c.png"}) image(name);
  const auto frame = [&](const char* name) {
    return fmt::format(R"({{"file_path": "images/{}.png", "transform_matrix": {}}})", name, kMatrix);
  };
  write("transforms.json", fmt::format(R"({{"fl_x": 30, "frames": [{}, {}, {}], "train_filenames": ["images/a.png",
          "images/b.png", "images/a.png"], "val_filenames": ["images/c.png"], "test_filenames": ["images/c.png"]}})",
                                       frame("a"), frame("b"), frame("c")));
  image("images/a.png");
  const Capture capture = read_capture(folder_);
  EXPECT_THAT(reasons(capture), testing::IsEmpty());
  ThreadPool pool(1);
  const CaptureSplit split = split_capture(capture, {}, pool);
  EXPECT_THAT(split.train, ElementsAre(0, 1));
  EXPECT_THAT(split.test, ElementsAre(2));
}

TEST_F(TransformsTest, DepthFilesThatAreMissingAreReported) {
  EXPECT_THAT(read("", R"(, "depth_file_path": "depth/a.png")").notes,
              ElementsAre(HasSubstr("depth_file_path: none of its files is there")));
}

TEST_F(TransformsTest, AnAngleInDegreesIsNamed) {
  EXPECT_THAT(error_of(R"(, "fl_x": 0, "fl_y": 0, "camera_angle_x": 60)"), HasSubstr("radians"));
}

TEST_F(TransformsTest, AUniformScaleOfTheMatrixAppliesToDepth) {
  depth("depth/a.png", 2000);
  const Capture capture =
      read("", R"(, "depth_file_path": "depth/a.png")", "[[0,3,0,1],[3,0,0,2],[0,0,-3,3],[0,0,0,1]]");
  EXPECT_NEAR(norm(capture.frames[0].world_to_camera * Vec3d{1, 2, 5} - Vec3d{0, 0, 2}), 0, 1e-12);
  EXPECT_FLOAT_EQ(read_capture_depth(capture, capture.frames[0]).at(5, 5), 6.0f);
}

TEST_F(TransformsTest, MasksAreFoundAndUnknownParametersListedOnce) {
  image("masks/a.png");
  const Capture capture = read(R"(, "applied_scale": 0.5, "rolling_shutter": [0, 0, 0.1], "tilt_angle": 3)",
                               R"(, "mask_path": "masks/a.png", "gain": 2)");
  EXPECT_EQ(capture.frames[0].mask.filename(), "a.png");
  EXPECT_THAT(capture.notes,
              ElementsAre(HasSubstr("rolling_shutter"), testing::AllOf(HasSubstr("frames.gain, tilt_angle"),
                                                                       testing::Not(HasSubstr("applied_scale")))));
}

TEST_F(TransformsTest, FilesOfAnotherMachineAreFoundByTheEndOfTheirPath) {
  image("my masks/a.png");
  for (const char* name :
       {"my%20masks/a.png", "/home/somebody/capture/my masks/a.png", "C:\\\\x\\\\my masks\\\\a.png"}) {
    const Capture capture = read("", fmt::format(R"(, "mask_path": "{}")", name));
    EXPECT_EQ(capture.frames[0].mask.lexically_normal(), folder_ / "my masks" / "a.png") << name;
  }
}

TEST_F(TransformsTest, OneBadFrameIsLeftOut) {
  image("images/b.png");
  write(
      "transforms.json",
      fmt::format(
          R"({{"fl_x": 30, "frames": [{{"file_path": "images/a.png", "transform_matrix": {0}}}, {{"file_path": "./images/b", "transform_matrix": {0}}},
          {{"file_path": "images/b.png", "transform_matrix": [[null,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}, {{"file_path": "c.png"}}]}})",
          kMatrix));
  const Capture capture = read_capture(folder_);
  ASSERT_EQ(capture.frames.size(), 1u);
  EXPECT_EQ(capture.frames[0].name, "b");
  EXPECT_THAT(reasons(capture),
              ElementsAre(HasSubstr("a.png: the photo is missing"), HasSubstr("found null"), HasSubstr("frame needs")));
}

TEST_F(TransformsTest, AnEntryOfAMatrixThatIsNoNumberIsNamed) {
  const std::string rows = "[[0,1,0,1],[1,0,{},2],[0,0,-1,3],[0,0,0,1]]";
  for (const char* entry : {"\"abc\"", "null", "true"}) {
    const std::string matrix = fmt::format(fmt::runtime(rows), entry);
    try {
      read("", "", matrix);
      ADD_FAILURE() << entry;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(),
                  HasSubstr(std::string("frames[0].transform_matrix[1][2]: expected a number, found ") + entry));
    }
  }
}

TEST_F(TransformsTest, AMatrixWithNaNIsNotFinite) {
  try {
    read("", "", "[[0,1,0,1],[1,0,NaN,2],[0,0,-1,3],[0,0,0,1]]");
    ADD_FAILURE() << "read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the pose is not finite"));
  }
}

TEST_F(TransformsTest, AnEntryOfIntrinsicsThatIsNoNumberIsNamed) {
  EXPECT_THAT(error_of(R"(, "K": [[30,0,16],[0,"x",12],[0,0,1]])"), HasSubstr("K: expected a number, found \"x\""));
}

TEST_F(TransformsTest, NumbersMayBeTexts) {
  image("images/a.png");
  write("transforms.json",
        R"({"fl_x": "30", "cx": "16", "cy": "12", "w": "32", "h": "24", "frames": [{"file_path": "images/a.png",
            "transform_matrix": [["0","1","0","1"],["1","0","0","2"],["0","0","-1","3"],["0","0","0","1"]]}]})");
  expect_one_known_camera(read_capture(folder_));
  write("transforms.json",
        R"({"fl_x": "30 px", "frames": [{"file_path": "images/a.png", "transform_matrix": [[1]]}]})");
  EXPECT_THROW(read_capture(folder_), Error);
}

/// ScanNet++ keeps the file beside the folders of photos, and says which are bad.
class ScanNetppTest : public TransformsTest {
 protected:
  void write_dslr(const std::string& photos, const std::string& masks, const std::string& file) {
    for (const char* name : {"a.png", "b.png", "c.png"}) image("dslr/" + photos + "/" + name);
    for (const char* name : {"a.png", "c.png"}) image("dslr/" + masks + "/" + name);
    write("dslr/nerfstudio/" + file,
          fmt::format(R"({{"fl_x": 30, "w": 32, "h": 24, "camera_model": "OPENCV", "has_mask": true, "frames": [
          {{"file_path": "a.png", "mask_path": "a.png", "is_bad": false, "transform_matrix": {0}}},
          {{"file_path": "b.png", "is_bad": true, "transform_matrix": {0}}}], "test_frames": [
          {{"file_path": "c.png", "mask_path": "c.png", "transform_matrix": {0}}}]}})",
                      kMatrix));
  }
};

TEST_F(ScanNetppTest, ItsPhotosAndMasksAreFound) {
  write_dslr("resized_images", "resized_anon_masks", "transforms.json");
  write_dslr("resized_undistorted_images", "resized_undistorted_masks", "transforms_undistorted.json");
  for (const fs::path& place :
       {folder_ / "dslr", folder_ / "dslr" / "nerfstudio", folder_ / "dslr" / "nerfstudio" / ""}) {
    const Capture capture = read_capture(place);
    ASSERT_EQ(capture.frames.size(), 2u) << place;
    EXPECT_EQ(capture.frames[0].image.lexically_normal(), folder_ / "dslr" / "resized_images" / "a.png");
    EXPECT_EQ(capture.frames[0].mask.lexically_normal(), folder_ / "dslr" / "resized_anon_masks" / "a.png");
    EXPECT_THAT(capture.test, ElementsAre("c"));
    EXPECT_THAT(reasons(capture), ElementsAre(HasSubstr("is_bad")));
    EXPECT_TRUE(capture.notes.empty());
  }
}

TEST_F(ScanNetppTest, GivenPhotosChooseTheirCameras) {
  write_dslr("resized_images", "resized_anon_masks", "transforms.json");
  write_dslr("resized_undistorted_images", "resized_undistorted_masks", "transforms_undistorted.json");
  const fs::path dslr = folder_ / "dslr";
  for (const char* kind : {"resized", "resized_undistorted"}) {
    const fs::path photos = dslr / (std::string(kind) + "_images");
    const Capture capture = read_transforms(dslr, PhotoLookup(photos, dslr));
    EXPECT_EQ(capture.frames[0].image.parent_path(), photos);
    EXPECT_EQ(capture.frames[0].mask.parent_path().filename().string().rfind(kind, 0), 0u) << capture.frames[0].mask;
  }
}

TEST_F(ScanNetppTest, UndistortedPhotosAloneAreReadWithTheirCameras) {
  write_dslr("resized_undistorted_images", "resized_undistorted_masks", "transforms_undistorted.json");
  const Capture capture = read_capture(folder_ / "dslr");
  ASSERT_EQ(capture.frames.size(), 2u);
  EXPECT_EQ(capture.frames[0].mask.lexically_normal(), folder_ / "dslr" / "resized_undistorted_masks" / "a.png");
}

TEST_F(TransformsTest, BlendersFilesAreReadWithTheirSplit) {
  for (const char* name : {"train/r_0.png", "train/r_1.PNG", "test/r_0.png"}) image(name);
  for (const std::string split : {"train", "test"}) {
    std::string frames;
    for (int i = 0; i < (split == "train" ? 2 : 1); ++i)
      frames += fmt::format(R"({}{{"file_path": "./{}/r_{}", "rotation": 0.1, "transform_matrix": {}}})", i ? "," : "",
                            split, i, kMatrix);
    write("transforms_" + split + ".json", fmt::format(R"({{"camera_angle_x": 0.6911112, "frames": [{}]}})", frames));
  }
  const Capture capture = read_capture(folder_);
  ASSERT_EQ(capture.frames.size(), 3u);
  EXPECT_NEAR(capture.frames[0].camera.params[0], 0.5 * kWidth / std::tan(0.5 * 0.6911112), 1e-9);
  EXPECT_THAT(capture.train, ElementsAre("train/r_0", "train/r_1"));
  EXPECT_THAT(capture.test, ElementsAre("test/r_0"));
  EXPECT_TRUE(capture.notes.empty());
}

}  // namespace
}  // namespace aligngs
