#include "scene/depth_agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scene/look_at.h"

namespace aligngs {
namespace {

/// Views of a box of 4 x 4 x 4 from a circle in its middle; depth times `unit`.
struct BoxViews {
  std::vector<Camera> cameras;
  std::vector<ImageF> depths;

  explicit BoxViews(double unit, double radius = 0.6, double focal = 30) {
    constexpr int kViews = 8, kWidth = 48, kHeight = 36;
    for (int i = 0; i < kViews; ++i) {
      const double angle = 2 * M_PI * i / kViews;
      const Vec3d eye{radius * std::cos(angle), radius * std::sin(angle), 0.1 * (i % 3)};
      Camera camera{kWidth, kHeight, focal, focal, 24, 18, {}};
      camera.world_to_camera = look_at(eye, eye + Vec3d{std::cos(angle), std::sin(angle), -0.1}, {0, 0, 1});
      ImageF depth(kWidth, kHeight, 1, 0.f);
      const Mat3d to_world = transpose(camera.world_to_camera.rotation);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Vec3d ray = to_world * camera.ray(x + 0.5, y + 0.5);
          double z = 1e9;
          for (int k = 0; k < 3; ++k)
            if (ray[k] != 0) z = std::fmin(z, ((ray[k] > 0 ? 2.0 : -2.0) - eye[k]) / ray[k]);
          depth.at(x, y) = static_cast<float>(z * unit);
        }
      }
      cameras.push_back(camera);
      depths.push_back(std::move(depth));
    }
  }
};

TEST(DepthAgreement, DepthInTheCamerasUnitAgrees) {
  const BoxViews box(1);
  const DepthAgreement agreement = depth_agreement(box.cameras, box.depths);
  EXPECT_GT(agreement.samples, 300u);
  EXPECT_LT(agreement.difference, 0.05);
  EXPECT_FALSE(agreement.has_other_unit());
}

TEST(DepthAgreement, DepthInAnotherUnitIsNoticedAndItsFactorFound) {
  for (const double unit : {0.001, 0.1, 0.2, 1 / 3.28, 4.0, 6.5535, 1000.0}) {
    const BoxViews box(unit);
    const DepthAgreement agreement = depth_agreement(box.cameras, box.depths);
    EXPECT_TRUE(agreement.has_other_unit()) << unit << ' ' << agreement.difference;
    EXPECT_NEAR(agreement.factor * unit, 1, 0.2) << unit;
  }
}

/// Few views share little, so that each needs more samples.
TEST(DepthAgreement, ThreeViewsSufficeForAnotherUnit) {
  for (const double unit : {4.0, 5.0}) {
    const BoxViews box(unit, 1.2, 20);
    const DepthAgreement agreement = depth_agreement({box.cameras.data(), 3}, {box.depths.data(), 3});
    EXPECT_TRUE(agreement.has_other_unit()) << unit << ": " << agreement.scaled_samples;
    EXPECT_NEAR(agreement.factor * unit, 1, 0.05) << unit;
  }
}

TEST(DepthAgreement, MatricesOfAnotherConventionAreTold) {
  const Rigidd turn{Mat3d{{1, 0, 0, 0, -1, 0, 0, 0, -1}}, {}};
  const BoxViews box(1);
  const auto told = [&](auto misread) {
    std::vector<Camera> cameras = box.cameras;
    for (Camera& camera : cameras) camera.world_to_camera = misread(camera.world_to_camera);
    return depth_agreement(cameras, box.depths).misreading;
  };
  EXPECT_EQ(told([](const Rigidd& pose) { return pose; }), Misreading::kNone);
  EXPECT_EQ(told([&](const Rigidd& pose) { return turn * pose; }), Misreading::kAxes);
  EXPECT_EQ(told([](const Rigidd& pose) { return pose.inverse(); }), Misreading::kInverted);
  EXPECT_EQ(told([&](const Rigidd& pose) { return (turn * pose).inverse(); }), Misreading::kInverted);
}

/// A wrong unit moves a surface by little where the cameras are close together. It explains nearly all of that.
TEST(DepthAgreement, CamerasCloseTogetherTellAnotherUnit) {
  for (const double unit : {1.5, 2.0}) {
    const BoxViews box(unit, 0.5, 20);
    const DepthAgreement agreement = depth_agreement(box.cameras, box.depths);
    EXPECT_LT(agreement.difference, 0.06) << unit;
    EXPECT_TRUE(agreement.has_other_unit()) << unit << ' ' << agreement.scaled_difference;
    EXPECT_NEAR(agreement.factor * unit, 1, 0.1) << unit;
  }
}

/// Noise of 3 % stays at every factor.
TEST(DepthAgreement, NoiseIsNoUnit) {
  BoxViews box(1, 0.25, 20);
  uint32_t state = 1;
  for (ImageF& depth : box.depths) {
    for (float& z : depth.data) {
      state = state * 1664525u + 1013904223u;
      z *= 1 + 0.16f * (float(state >> 8) / float(1 << 24) - 0.5f);
    }
  }
  const DepthAgreement agreement = depth_agreement(box.cameras, box.depths);
  EXPECT_GT(agreement.difference, 0.02);
  EXPECT_FALSE(agreement.has_other_unit());
  EXPECT_EQ(agreement.misreading, Misreading::kNone);
}

TEST(DepthAgreement, DistancesAlongTheRaysAreTold) {
  BoxViews box(1, 0.6, 20);
  for (size_t i = 0; i < box.depths.size(); ++i) {
    ImageF& depth = box.depths[i];
    for (int y = 0; y < depth.height; ++y) {
      for (int x = 0; x < depth.width; ++x)
        depth.at(x, y) *= static_cast<float>(norm(box.cameras[i].ray(x + 0.5, y + 0.5)));
    }
  }
  EXPECT_EQ(depth_agreement(box.cameras, box.depths).misreading, Misreading::kAlongRays);
}

TEST(DepthAgreement, MapsThatAreUpsideDownAreTold) {
  BoxViews box(1, 0.6, 20);
  for (ImageF& depth : box.depths) {
    const ImageF upright = depth;
    for (int y = 0; y < depth.height; ++y)
      for (int x = 0; x < depth.width; ++x) depth.at(x, y) = upright.at(x, depth.height - 1 - y);
  }
  EXPECT_EQ(depth_agreement(box.cameras, box.depths).misreading, Misreading::kUpsideDown);
}

/// No factor and no reading explains depth of other views.
TEST(DepthAgreement, DepthOfOtherViewsIsContradicted) {
  BoxViews box(1);
  EXPECT_FALSE(depth_agreement(box.cameras, box.depths).is_contradicted());
  for (ImageF& depth : box.depths) {
    for (size_t i = 0; i < depth.data.size(); ++i) depth.data[i] = i % 48 < 24 ? 1.f : 3.f;
  }
  const DepthAgreement agreement = depth_agreement(box.cameras, box.depths);
  EXPECT_TRUE(agreement.is_contradicted()) << agreement.difference << ' ' << agreement.samples;
}

/// Some factor always fits by chance where hardly any place is seen twice.
TEST(DepthAgreement, ViewsThatShareHardlyAnythingTellNothing) {
  const BoxViews box(1, 0.6, 60);
  EXPECT_FALSE(depth_agreement(box.cameras, box.depths).has_other_unit());
}

TEST(DepthAgreement, CamerasInOnePlaceTellNothing) {
  const BoxViews box(5, 0);
  EXPECT_FALSE(depth_agreement(box.cameras, box.depths).has_other_unit());
}

TEST(DepthAgreement, OneViewTellsNothing) {
  const BoxViews box(5);
  const DepthAgreement agreement = depth_agreement({box.cameras.data(), 1}, {box.depths.data(), 1});
  EXPECT_EQ(agreement.samples, 0u);
  EXPECT_FALSE(agreement.has_other_unit());
  EXPECT_FALSE(depth_agreement({}, {}).has_other_unit());
}

}  // namespace
}  // namespace aligngs
