// A small folder of photos that a test fills in one of the layouts.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "io/image_file.h"
#include "scene/import/capture.h"

namespace aligngs {

inline constexpr int kWidth = 32, kHeight = 24;

/// A small folder for one test; the layouts differ, the two cameras do not.
class CaptureTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("capture_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }

  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  void image(const std::string& name, int width = kWidth, int height = kHeight) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    const Image<uint8_t> picture(width, height, 3, 90);
    name.find(".jpg") != std::string::npos ? write_jpeg(folder_ / name, picture) : write_png(folder_ / name, picture);
  }
  void depth(const std::string& name, uint16_t value, int width = kWidth, int height = kHeight) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    Image<uint16_t> map(width, height, 1, value);
    map.at(0, 0) = 0;
    map.at(1, 0) = 65535;
    write_png16(folder_ / name, map);
  }
  /// Camera-to-world of camera 0: at (1, 2, 3), turned a quarter about z; OpenCV axes.
  static std::string pose_opencv() { return "0 -1 0 1\n1 0 0 2\n0 0 1 3\n0 0 0 1\n"; }
  static std::string pose_opengl() { return "0 1 0 1\n1 0 0 2\n0 0 -1 3\n0 0 0 1\n"; }
  static std::string pose_lost(const char* word) {
    std::string row = fmt::format("{0} {0} {0} {0}\n", word);
    return row + row + row + row;
  }
  void expect_one_known_camera(const Capture& capture) {
    ASSERT_EQ(capture.frames.size(), 1u);
    const Rigidd& pose = capture.frames[0].world_to_camera;
    EXPECT_NEAR(norm(pose.inverse().translation - Vec3d{1, 2, 3}), 0, 1e-12);
    EXPECT_NEAR(norm(pose * Vec3d{1, 2, 5} - Vec3d{0, 0, 2}), 0, 1e-12);  // straight ahead
    EXPECT_NEAR(norm(pose * Vec3d{1, 3, 3} - Vec3d{1, 0, 0}), 0, 1e-12);  // to the right
    EXPECT_EQ(capture.frames[0].camera.width, uint64_t(kWidth));
  }

  /// "name: reason" of each frame that is left out.
  static std::vector<std::string> reasons(const Capture& capture) {
    std::vector<std::string> lines;
    for (const LeftOut& frame : capture.left_out) lines.push_back(frame.name + ": " + frame.reason);
    return lines;
  }

  std::filesystem::path folder_;
};

}  // namespace aligngs
