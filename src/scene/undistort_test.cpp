#include "scene/undistort.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace aligngs {
namespace {

ColmapCamera distorted_camera(const std::string& model, std::vector<double> params) {
  ColmapCamera camera;
  camera.id = 1;
  camera.model = model;
  camera.width = 64;
  camera.height = 48;
  camera.params = std::move(params);
  return camera;
}

LensModel barrel() { return lens_of(distorted_camera("SIMPLE_RADIAL", {60, 32, 24, -0.12}), "cameras.bin"); }

/// A smooth picture of the undistorted plane: its value at a ray is known exactly.
float picture(const Vec2d& p) { return static_cast<float>(0.5 + 0.3 * std::sin(5 * p.x) * std::cos(4 * p.y)); }

/// Ray of a pixel of the distorted image, by fixed-point iteration.
Vec2d undistorted_ray(const LensModel& lens, double u, double v) {
  const Vec2d d{(u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy};
  Vec2d p = d;
  for (int i = 0; i < 50; ++i) {
    const Vec2d q = lens.distort(p);
    p = {p.x + d.x - q.x, p.y + d.y - q.y};
  }
  return p;
}

ImageF distorted_picture(const LensModel& lens) {
  ImageF image(lens.width, lens.height, 1);
  for (int y = 0; y < lens.height; ++y)
    for (int x = 0; x < lens.width; ++x) image.at(x, y) = picture(undistorted_ray(lens, x + 0.5, y + 0.5));
  return image;
}

TEST(Undistort, TheResultIsThePictureSeenByThePinhole) {
  const LensModel lens = barrel();
  const Camera pinhole = undistorted_camera(lens, "c");
  const ImageF image = undistort_image(distorted_picture(lens), lens, pinhole);
  ASSERT_EQ(image.width, 64);
  ASSERT_EQ(image.height, 48);
  double worst = 0;
  for (int y = 1; y < 47; ++y) {
    for (int x = 1; x < 63; ++x) {
      const Vec3d ray = pinhole.ray(x + 0.5, y + 0.5);
      worst = std::max<double>(worst, std::abs(image.at(x, y) - picture({ray.x, ray.y})));
    }
  }
  EXPECT_LT(worst, 2e-3);  // bilinear interpolation of a wave of about 70 pixels
}

TEST(Undistort, EveryPixelHasASourceForBarrelAndPincushion) {
  for (double k : {-0.12, 0.15}) {
    const LensModel lens = lens_of(distorted_camera("SIMPLE_RADIAL", {60, 32, 24, k}), "c");
    const Camera pinhole = undistorted_camera(lens, "c");
    const ImageF image = undistort_image(ImageF(64, 48, 1, 1.0f), lens, pinhole);
    for (float value : image.data) ASSERT_EQ(value, 1);
    EXPECT_LT(std::abs(pinhole.fx / 60 - 1), 0.15);
    EXPECT_NEAR(pinhole.fx / pinhole.fy, 1, 1e-9);
  }
}

TEST(Undistort, AFisheyeBecomesThePinholesPicture) {
  // 110 degrees across
  const LensModel lens = lens_of(distorted_camera("OPENCV_FISHEYE", {30, 30, 32, 24, 0.02, 0, 0, 0}), "c");
  const Camera pinhole = undistorted_camera(lens, "c");
  ImageF seen(64, 48, 1);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {  // Newton's method along the radius, for which theta (1 + 0.02 theta^2) is known
      const double dx = (x + 0.5 - 32) / 30, dy = (y + 0.5 - 24) / 30, s = std::hypot(dx, dy);
      double theta = s;
      for (int i = 0; i < 20; ++i) theta -= (theta + 0.02 * theta * theta * theta - s) / (1 + 0.06 * theta * theta);
      seen.at(x, y) = static_cast<float>(0.5 + 0.3 * std::sin(2 * std::tan(theta) * dx / s));
    }
  }
  const ImageF image = undistort_image(seen, lens, pinhole);
  double worst = 0;
  for (int y = 1; y < 47; ++y) {
    for (int x = 1; x < 63; ++x)
      worst = std::max(worst, std::abs(image.at(x, y) - (0.5 + 0.3 * std::sin(2 * pinhole.ray(x + 0.5, y + 0.5).x))));
  }
  EXPECT_LT(worst, 0.02);  // bilinear, up to 0.1 radians of the wave per pixel
}

TEST(Undistort, AMapOfHalfTheSizeSeesTheSameRays) {
  const LensModel lens = barrel();
  const Camera pinhole = undistorted_camera(lens, "c");
  const ImageF image = undistort_image(distorted_picture(lens.resized(32, 24)), lens, pinhole);
  const Vec3d ray = pinhole.resized(32, 24).ray(4.5, 6.5);
  EXPECT_NEAR(image.at(4, 6), picture({ray.x, ray.y}), 5e-3);
}

TEST(Undistort, DepthIsNotBlendedAcrossAStep) {
  const LensModel lens = barrel();
  ImageF depth(64, 48, 1, 2.0f);
  for (int y = 0; y < 48; ++y)
    for (int x = 32; x < 64; ++x) depth.at(x, y) = x < 40 ? 4.0f : 0.0f;
  for (float z : undistort_depth(depth, lens, undistorted_camera(lens, "c")).data) {
    ASSERT_TRUE(z == 0 || std::abs(z - 2) < 1e-5 || std::abs(z - 4) < 1e-5) << z;
  }
}

TEST(Undistort, LabelsAreNeverMixed) {
  const LensModel lens = barrel();
  Image<uint16_t> labels(64, 48, 1, 3);
  labels.at(32, 24) = 9;
  for (uint16_t label : undistort_labels(labels, lens, undistorted_camera(lens, "c"), 65535).data) {
    ASSERT_TRUE(label == 3 || label == 9);
  }
}

TEST(Undistort, ADistortionThatFoldsOverIsRefused) {
  const LensModel lens = lens_of(distorted_camera("SIMPLE_RADIAL", {20, 32, 24, -3}), "c");
  EXPECT_THROW(undistorted_camera(lens, "c"), Error);
}

}  // namespace
}  // namespace aligngs
