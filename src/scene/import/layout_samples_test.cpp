// The same five real frames in two published layouts must give the same cameras and the same surface.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "scene/import/capture.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

TEST(LayoutSamples, ScanNetAndNeuralRgbdAgreeOnCamerasAndDepth) {
  const fs::path samples = fs::path(ALIGNGS_SOURCE_DIR) / ".." / "shared" / "data" / "layout_samples";
  if (!fs::exists(samples)) GTEST_SKIP() << "the sample captures are not beside this checkout";
  const Capture scannet = read_capture(samples / "scannet_like" / "scene9999_00");
  const Capture neural = read_capture(samples / "nrgbd_like" / "red_kitchen");
  CaptureOptions tracked;
  tracked.neural_rgbd_trajectory = true;
  const Capture relative = read_capture(samples / "nrgbd_like" / "red_kitchen", tracked);
  EXPECT_EQ(scannet.left_out.size(), 1u);   // pose 2 is -inf
  EXPECT_EQ(relative.left_out.size(), 1u);  // matrix 3 is nan
  ASSERT_EQ(scannet.frames.size(), 4u);

  std::map<std::string, const CapturedFrame*> by_name;
  for (const CapturedFrame& frame : neural.frames) by_name[frame.name] = &frame;
  int compared = 0;
  for (const CapturedFrame& frame : scannet.frames) {
    const auto found = by_name.find("img" + frame.name);
    if (found == by_name.end()) continue;
    ++compared;
    const CapturedFrame& other = *found->second;
    EXPECT_LT(norm(frame.world_to_camera.inverse().translation - other.world_to_camera.inverse().translation), 1e-5);
    EXPECT_LT(rotation_angle_between_degrees(frame.world_to_camera.rotation, other.world_to_camera.rotation), 1e-3);
    // Median depth of the shared middle of the image, seen through both sets of intrinsics.
    const ImageF a = read_capture_depth(scannet, frame), b = read_capture_depth(neural, other);
    const int size = 40;
    double sum_a = 0, sum_b = 0;
    int count_a = 0, count_b = 0;
    for (int y = -size; y <= size; ++y) {
      for (int x = -size; x <= size; ++x) {
        const float za = a.at(a.width / 2 + x, a.height / 2 + y), zb = b.at(b.width / 2 + x, b.height / 2 + y);
        if (za > 0) sum_a += za, ++count_a;
        if (zb > 0) sum_b += zb, ++count_b;
      }
    }
    if (count_a > size * size && count_b > size * size) {
      EXPECT_NEAR(sum_a / count_a, sum_b / count_b, 0.06 * sum_a / count_a) << frame.name;
    }
  }
  EXPECT_EQ(compared, 4);
}

}  // namespace
}  // namespace aligngs
