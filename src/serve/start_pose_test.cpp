#include "serve/start_pose.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace aligngs {
namespace {

using Json = nlohmann::json;

/// A camera that looks along a level direction; y points down.
Json camera(Vec3d place, double x, double z) {
  return {{"position", {place.x, place.y, place.z}}, {"rotation", {{z, 0, x}, {0, 1, 0}, {-x, 0, z}}}};
}

TEST(StartPose, LooksFromTheFarthestPhotoAtWhatAllLookAt) {
  const Json cameras = {camera({-1, 0, 0}, 1, 0), camera({3, 0, 0}, -1, 0), camera({0, 0, -2}, 0, 1)};
  const auto pose = start_pose(cameras, nullptr);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(norm(pose->target - Vec3d{0, 0, 0}), 0, 1e-9);
  EXPECT_NEAR(norm(pose->eye - Vec3d{3, 0, 0}), 0, 1e-9);
  EXPECT_NEAR(norm(pose->up - Vec3d{0, -1, 0}), 0, 1e-9);  // the mean up of the photos
}

TEST(StartPose, TakesTheStatedUp) {
  const Json cameras = {camera({-1, 0, 0}, 1, 0), camera({0, 0, -2}, 0, 1)};
  const auto pose = start_pose(cameras, Json{0, -2, 0.5});
  ASSERT_TRUE(pose);
  EXPECT_NEAR(norm(pose->up - normalized(Vec3d{0, -2, 0.5})), 0, 1e-12);
}

TEST(StartPose, IsAbsentWherePhotosLookInOneDirection) {
  EXPECT_FALSE(start_pose({camera({0, 0, 0}, 0, 1), camera({1, 0, 0}, 0, 1)}, nullptr));
  EXPECT_FALSE(start_pose(Json::array({camera({0, 0, 0}, 0, 1)}), nullptr));
}

TEST(StartPose, IsAbsentWhereTheFileIsNoListOfCameras) {
  const Json good = camera({-1, 0, 0}, 1, 0);
  EXPECT_FALSE(start_pose(nullptr, nullptr));
  EXPECT_FALSE(start_pose(Json::array(), nullptr));
  for (const Json& damaged : {Json(3), Json::object(), Json{{"position", {0, 0}}, {"rotation", good["rotation"]}},
                              Json{{"position", {0, 0, "a"}}, {"rotation", good["rotation"]}},
                              Json{{"position", {0, 0, 0}}, {"rotation", {{1, 0, 0}, {0, 1, 0}}}}}) {
    EXPECT_FALSE(start_pose({camera({0, 0, -2}, 0, 1), good, damaged}, nullptr)) << damaged;
  }
}

TEST(StartPose, IsWrittenAsTheStateHasIt) {
  EXPECT_TRUE(start_pose_json({}).is_null());
  const Json written = start_pose_json(StartPose{{1, 2, 3}, {4, 5, 6}, {0, 1, 0}});
  EXPECT_EQ(written, Json({{"eye", {1, 2, 3}}, {"target", {4, 5, 6}}}));
}

}  // namespace
}  // namespace aligngs
