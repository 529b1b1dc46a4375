#include "scene/undistort.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace aligngs {
namespace {

ColmapCamera colmap_camera(const std::string& model, std::vector<double> params) {
  ColmapCamera camera;
  camera.id = 1;
  camera.model = model;
  camera.width = 64;
  camera.height = 48;
  camera.params = std::move(params);
  return camera;
}

LensModel barrel() { return lens_of(colmap_camera("SIMPLE_RADIAL", {60, 32, 24, -0.12}), "cameras.bin"); }

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

TEST(LensOf, ReadsTheParametersOfEachModel) {
  const LensModel simple = lens_of(colmap_camera("SIMPLE_PINHOLE", {50, 31, 23}), "c");
  EXPECT_EQ(simple.fy, 50);
  EXPECT_EQ(simple.cx, 31);
  EXPECT_FALSE(simple.distorted());
  const LensModel radial = lens_of(colmap_camera("RADIAL", {50, 31, 23, 0.1, 0.2}), "c");
  EXPECT_EQ(radial.radial[1], 0.2);
  const LensModel opencv = lens_of(colmap_camera("OPENCV", {50, 51, 31, 23, 0.1, 0.2, 0.3, 0.4}), "c");
  EXPECT_EQ(opencv.fy, 51);
  EXPECT_EQ(opencv.p1, 0.3);
  EXPECT_EQ(opencv.p2, 0.4);
  const LensModel full = lens_of(colmap_camera("FULL_OPENCV", {50, 51, 31, 23, 1, 2, 3, 4, 5, 6, 7, 8}), "c");
  EXPECT_EQ(full.radial[2], 5);
  EXPECT_EQ(full.radial[5], 8);
}

TEST(LensOf, ZeroDistortionIsAPinhole) {
  EXPECT_FALSE(lens_of(colmap_camera("RADIAL", {50, 31, 23, 0, 0}), "c").distorted());
}

TEST(LensOf, BadCamerasAreNamed) {
  EXPECT_THROW(lens_of(colmap_camera("FISHEYE_X", {50, 31, 23}), "c"), Error);
  EXPECT_THROW(lens_of(colmap_camera("PINHOLE", {50, 31, 23}), "c"), Error);
  EXPECT_THROW(lens_of(colmap_camera("SIMPLE_PINHOLE", {-50, 31, 23}), "c"), Error);
  EXPECT_THROW(lens_of(colmap_camera("SIMPLE_PINHOLE", {std::nan(""), 31, 23}), "c"), Error);
  ColmapCamera huge = colmap_camera("SIMPLE_PINHOLE", {50, 31, 23});
  huge.width = uint64_t(1) << 40;
  EXPECT_THROW(lens_of(huge, "c"), Error);
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
    const LensModel lens = lens_of(colmap_camera("SIMPLE_RADIAL", {60, 32, 24, k}), "c");
    const Camera pinhole = undistorted_camera(lens, "c");
    const ImageF image = undistort_image(ImageF(64, 48, 1, 1.0f), lens, pinhole);
    for (float value : image.data) ASSERT_EQ(value, 1);
    EXPECT_LT(std::abs(pinhole.fx / 60 - 1), 0.15);
    EXPECT_NEAR(pinhole.fx / pinhole.fy, 1, 1e-9);
  }
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
  const LensModel lens = lens_of(colmap_camera("SIMPLE_RADIAL", {20, 32, 24, -3}), "c");
  EXPECT_THROW(undistorted_camera(lens, "c"), Error);
}

}  // namespace
}  // namespace aligngs
