#include "refine/photo_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"

namespace aligngs {
namespace {

/// Two textured walls that meet in a fold, and a step in depth on the left.
struct Scene {
  double contrast = 1;

  SceneLook operator()(const Camera& camera) const {
    SceneLook look{ImageF(camera.width, camera.height, 3), ImageF(camera.width, camera.height, 1)};
    const Rigidd to_world = camera.world_to_camera.inverse();
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const Vec3d ray = to_world.rotation * camera.ray(x + 0.5, y + 0.5), origin = to_world.translation;
        double nearest = 1e9;
        for (const double side : {-0.5, 0.5}) {
          const Vec3d wall = normalized(Vec3d{side, 0.1, -1});
          const double t = -(3.0 + dot(wall, origin)) / dot(wall, ray);
          if (t > 0) nearest = std::min(nearest, t);
        }
        const Vec3d p = origin + ray * nearest;
        look.depth.at(x, y) = static_cast<float>((camera.world_to_camera * p).z);
        for (int c = 0; c < 3; ++c) {
          look.color.at(x, y, c) = static_cast<float>(
              0.5 + contrast * (0.15 * std::sin(5 * p.x + c) * std::cos(4 * p.y) + 0.1 * std::sin(11 * p.y + 3 * p.x)));
        }
      }
    }
    return look;
  }
};

Camera aligned_camera() {
  Camera c;
  c.width = 96;
  c.height = 72;
  c.fx = c.fy = 90;
  c.cx = 47;
  c.cy = 37;
  return c;
}

Camera moved(double degrees, const Vec3d& shift) {
  Camera c = aligned_camera();
  const double half = degrees * 3.14159265 / 360;
  c.world_to_camera.rotation = rotation_matrix(normalized(Quaterniond{1, 0.6 * half, -0.7 * half, 0.4 * half}));
  c.world_to_camera.translation = shift;
  return c;
}

double turn_of(const Camera& c) {
  return rotation_angle_between_degrees(c.world_to_camera.rotation, aligned_camera().world_to_camera.rotation);
}

TEST(PhotoAlignment, FindsTheCameraThatTookThePhoto) {
  const Scene scene;
  const ImageF photo = scene(aligned_camera()).color;
  const PhotoAlignment a = align_to_photo({moved(1.5, {0.05, -0.03, 0.04}), photo, {}}, scene);
  EXPECT_LT(norm(a.camera.centre()), 0.002) << "of 7 cm";
  EXPECT_LT(turn_of(a.camera), 0.05);
  EXPECT_LT(a.after, 0.02 * a.before);
}

TEST(PhotoAlignment, BrightnessIsNotMistakenForMotion) {
  const Scene scene;
  ImageF photo = scene(aligned_camera()).color;
  for (float& v : photo.data) v = 0.8f * v + 0.07f;
  const PhotoAlignment a = align_to_photo({moved(1, {0.03, 0.02, -0.02}), photo, {}}, scene);
  EXPECT_LT(norm(a.camera.centre()), 0.002);
  EXPECT_LT(turn_of(a.camera), 0.05);
}

TEST(PhotoAlignment, WhatTheSceneDoesNotHaveIsLeftOut) {
  const Scene scene;
  ImageF photo = scene(aligned_camera()).color, mask(96, 72, 1, 1.0f);
  for (int y = 10; y < 60; ++y) {  // a person hides part of the photo
    for (int x = 20; x < 50; ++x) {
      for (int c = 0; c < 3; ++c) photo.at(x, y, c) = 0.05f;
    }
  }
  const Camera start = moved(1, {0.03, 0.02, -0.02});
  EXPECT_LT(norm(align_to_photo({start, photo, {}}, scene).camera.centre()), 0.02) << "by the norm";
  for (int y = 8; y < 62; ++y) {
    for (int x = 18; x < 52; ++x) mask.at(x, y) = 0;
  }
  EXPECT_LT(norm(align_to_photo({start, photo, mask}, scene).camera.centre()), 0.003) << "by the mask";
}

TEST(PhotoAlignment, GivesTheStartBackWhereThePhotoSaysNothing) {
  const Camera start = moved(1, {0.03, 0.02, -0.02});
  const auto expect_start = [&](const PhotoAlignment& a) {
    EXPECT_EQ(a.camera.world_to_camera.translation.x, start.world_to_camera.translation.x);
    EXPECT_EQ(a.camera.world_to_camera.rotation(0, 1), start.world_to_camera.rotation(0, 1));
  };
  Scene bare;
  bare.contrast = 0;
  expect_start(align_to_photo({start, ImageF(96, 72, 3, 0.5f), {}}, bare));
  const auto nothing = [](const Camera& c) {
    return SceneLook{ImageF(c.width, c.height, 3), ImageF(c.width, c.height, 1)};
  };
  expect_start(align_to_photo({start, ImageF(96, 72, 3, 0.5f), {}}, nothing));
  const auto not_numbers = [](const Camera& c) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    return SceneLook{ImageF(c.width, c.height, 3, nan), ImageF(c.width, c.height, 1, nan)};
  };
  expect_start(align_to_photo({start, ImageF(96, 72, 3, 0.5f), {}}, not_numbers));
}

TEST(PhotoAlignment, ATruePoseStaysWhereItIs) {
  const Scene scene;
  const PhotoAlignment a = align_to_photo({aligned_camera(), scene(aligned_camera()).color, {}}, scene);
  EXPECT_LT(norm(a.camera.centre()), 1e-4);
}

TEST(PhotoAlignment, NoCameraIsAskedTwiceAndTheLastSceneIsHandedOut) {
  const Scene scene;
  std::vector<Camera> asked;
  const LookAtScene look = [&](const Camera& camera) {
    for (const Camera& c : asked) {
      const Rigidd &a = c.world_to_camera, &b = camera.world_to_camera;
      EXPECT_FALSE(c.width == camera.width && norm(a.translation - b.translation) == 0 &&
                   rotation_angle_between_degrees(a.rotation, b.rotation) == 0);
    }
    asked.push_back(camera);
    return scene(camera);
  };
  const Camera start = moved(1, {0.03, 0.02, -0.02});
  const PhotoAlignment a = align_to_photo({start, scene(aligned_camera()).color, {}}, look);
  EXPECT_EQ(a.renderings, static_cast<int>(asked.size()));
  EXPECT_EQ(asked[0].width, start.width);
  EXPECT_EQ(asked[0].world_to_camera.translation.x, start.world_to_camera.translation.x);
  EXPECT_EQ(a.seen.color.data, scene(a.camera).color.data);
  EXPECT_EQ(a.seen.depth.data, scene(a.camera).depth.data);
}

TEST(PhotoAlignment, AStartThatIsRenderedAlreadyIsNotRenderedAgain) {
  const Scene scene;
  const Camera start = moved(1, {0.03, 0.02, -0.02});
  const ImageF photo = scene(aligned_camera()).color;
  const PhotoAlignment all = align_to_photo({start, photo, {}}, scene),
                       given = align_to_photo({start, photo, {}, scene(start)}, scene);
  EXPECT_EQ(given.renderings, all.renderings - 1);
  EXPECT_EQ(given.after, all.after);
}

TEST(PhotoAlignment, APhotoOfAnotherSizeIsAnError) {
  EXPECT_THROW(align_to_photo({aligned_camera(), ImageF(10, 10, 3), {}}, Scene()), Error);
  EXPECT_THROW(align_to_photo({aligned_camera(), ImageF(96, 72, 3), ImageF(3, 3, 1)}, Scene()), Error);
}

}  // namespace
}  // namespace aligngs
