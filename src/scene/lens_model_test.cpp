#include "scene/lens_model.h"

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

TEST(LensOf, IntrinsicsInPartsOfTheWidthAreRefused) {
  EXPECT_THROW(lens_of(colmap_camera("PINHOLE", {0.8, 1.1, 0.5, 0.5}), "c"), Error);
  EXPECT_THROW(lens_of(colmap_camera("PINHOLE", {50, 1e9, 32, 24}), "c"), Error);
  EXPECT_NO_THROW(lens_of(colmap_camera("OPENCV_FISHEYE", {10, 10, 32, 24, 0, 0, 0, 0}), "c"));
}

TEST(LensOf, APrincipalPointIsNearThePhoto) {
  EXPECT_THROW(lens_of(colmap_camera("PINHOLE", {50, 50, 0.52, 0.47}), "c"), Error) << "parts of the width";
  EXPECT_THROW(lens_of(colmap_camera("PINHOLE", {50, 50, 1e9, 24}), "c"), Error);
  EXPECT_THROW(lens_of(colmap_camera("PINHOLE", {50, 50, 32, -49}), "c"), Error);
  EXPECT_NO_THROW(lens_of(colmap_camera("PINHOLE", {50, 50, 127, -47}), "c")) << "a part of a larger photo";
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

/// Checks the pixel of the ray (0.5, -0.25, 1). The expected values were computed apart from this program, from the
/// angles of the ray (theta = atan 0.559017). The division model's follow from bisection of its inverse.
void expect_pixel(const std::string& model, std::vector<double> params, double u, double v) {
  const Vec2d pixel = lens_of(colmap_camera(model, std::move(params)), "c").project({0.5, -0.25});
  EXPECT_NEAR(pixel.x, u, 1e-8) << model;
  EXPECT_NEAR(pixel.y, v, 1e-8) << model;
}

TEST(LensModel, EveryModelPutsARayWhereItsFormulaSays) {
  expect_pixel("SIMPLE_PINHOLE", {60, 32, 24}, 62, 9);
  expect_pixel("SIMPLE_FISHEYE", {60, 32, 24}, 59.355501745, 10.322249128);
  expect_pixel("FISHEYE", {60, 50, 32, 24}, 59.355501745, 12.601874273);
  expect_pixel("SIMPLE_RADIAL_FISHEYE", {60, 32, 24, 0.1}, 60.066292166, 9.966853917);
  expect_pixel("RADIAL_FISHEYE", {60, 32, 24, 0.1, -0.05}, 59.973948215, 10.013025892);
  expect_pixel("OPENCV_FISHEYE", {60, 50, 32, 24, 0.1, -0.05, 0.02, -0.01}, 59.982298973, 12.340708761);
  expect_pixel("THIN_PRISM_FISHEYE", {60, 50, 32, 24, 0.1, -0.05, 0.01, -0.02, 0.02, -0.01, 0.03, -0.04}, 59.514596800,
               12.210791491);
  expect_pixel("RAD_TAN_THIN_PRISM_FISHEYE",
               {60, 50, 32, 24, 0.1, -0.05, 0.02, -0.01, 0.005, -0.002, 0.01, -0.02, 0.03, -0.01, 0.02, -0.04},
               61.112618344, 11.975304989);
  expect_pixel("SIMPLE_DIVISION", {60, 32, 24, -0.2}, 60.328157300, 9.835921350);
  expect_pixel("DIVISION", {60, 50, 32, 24, -0.2}, 60.328157300, 12.196601125);
  expect_pixel("FOV", {60, 50, 32, 24, 0.9}, 61.527366639, 11.696930567);
  expect_pixel("EUCM", {60, 50, 32, 24, 0.6, 1.1}, 59.384221204, 12.589907832);
}

TEST(LensModel, TheAxisMeetsThePrincipalPoint) {
  for (const char* model : {"FISHEYE", "DIVISION", "FOV", "EUCM"}) {
    std::vector<double> params = {60, 50, 31, 23, 0.5, 1};
    params.resize(model == std::string("FISHEYE") ? 4 : model == std::string("EUCM") ? 6 : 5);
    const Vec2d pixel = lens_of(colmap_camera(model, params), "c").project({0, 0});
    EXPECT_NEAR(pixel.x, 31, 1e-12) << model;
    EXPECT_NEAR(pixel.y, 23, 1e-12) << model;
  }
}

TEST(LensModel, OnlyTheseAreNoPinhole) {
  EXPECT_TRUE(lens_of(colmap_camera("SIMPLE_FISHEYE", {60, 32, 24}), "c").distorted());
  EXPECT_TRUE(lens_of(colmap_camera("EUCM", {60, 60, 32, 24, 0.5, 1}), "c").distorted());
  EXPECT_FALSE(lens_of(colmap_camera("EUCM", {60, 60, 32, 24, 0, 1}), "c").distorted());
  EXPECT_FALSE(lens_of(colmap_camera("SIMPLE_DIVISION", {60, 32, 24, 0}), "c").distorted());
  EXPECT_FALSE(lens_of(colmap_camera("FOV", {60, 60, 32, 24, 0}), "c").distorted());
}

TEST(LensModel, ARayBeyondTheLensHasNoPixel) {
  EXPECT_TRUE(std::isnan(lens_of(colmap_camera("SIMPLE_DIVISION", {60, 32, 24, 0.4}), "c").project({1, 0}).x));
}

TEST(LensModel, APanoramaIsRefusedWithAWayOut) {
  try {
    lens_of(colmap_camera("EQUIRECTANGULAR", {64, 48}), "c");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.details().remedy.find("panorama"), std::string::npos);
  }
}

TEST(ResizedCamera, SeesTheSameRays) {
  const ColmapCamera camera = colmap_camera("RADIAL_FISHEYE", {60, 30, 25, 0.1, -0.05});
  const Vec2d whole = lens_of(camera, "c").project({0.2, 0.1}),
              half = lens_of(resized_camera(camera, 32, 24), "c").project({0.2, 0.1});
  EXPECT_NEAR(half.x, whole.x / 2, 1e-12);
  EXPECT_NEAR(half.y, whole.y / 2, 1e-12);
}

}  // namespace
}  // namespace aligngs
