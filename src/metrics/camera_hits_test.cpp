#include "metrics/camera_hits.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

/// A wall in front of a wider one, each of two triangles.
TriangleMesh two_walls() {
  TriangleMesh mesh;
  for (const float depth : {2.0f, 3.0f}) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    const float half = depth - 1.5f;
    mesh.vertices.insert(mesh.vertices.end(),
                         {{-half, -half, depth}, {half, -half, depth}, {half, half, depth}, {-half, half, depth}});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

/// Without a cache: per triangle 1 when the ray of some pixel of some camera hits it first.
std::vector<uint8_t> first_hit_triangles(const RayScene& scene, const std::vector<uint8_t>& there,
                                         const std::vector<Camera>& cameras, ThreadPool& pool) {
  std::vector<uint8_t> hit(there.size(), 0);
  for (const Camera& camera : cameras) {
    for (const uint32_t t : scene.cast(camera, pool, &there).triangle.data) {
      if (t != kNoTriangle) hit[t] = 1;
    }
  }
  return hit;
}

class HitCacheTest : public testing::Test {
 protected:
  static Camera camera_at(double x) {
    Camera camera;
    camera.width = 64;
    camera.height = 48;
    camera.fx = camera.fy = 60;
    camera.cx = 32;
    camera.cy = 24;
    camera.world_to_camera.translation = {-x, 0, 0};
    return camera;
  }

  TriangleMesh mesh_ = two_walls();
  RayScene rays_{mesh_};
  std::vector<Camera> cameras_ = {camera_at(0), camera_at(0.4), camera_at(9)};
  ThreadPool pool_{2};
  HitCache hits_{rays_, mesh_.triangles.size(), cameras_, pool_};
  const std::vector<uint8_t> all_ = {1, 1, 1, 1}, back_ = {0, 0, 1, 1};
};

TEST_F(HitCacheTest, SeesWhatTheRaysMeet) {
  for (const auto& there : {all_, back_}) {
    for (size_t c = 0; c < cameras_.size(); ++c) {
      const FirstHits expected = rays_.cast(cameras_[c], pool_, &there);
      for (size_t i = 0; i < expected.triangle.data.size(); ++i)
        EXPECT_EQ(hits_.of(c, there).hit.data[i] != 0, expected.triangle.data[i] != kNoTriangle);
    }
    EXPECT_EQ(hits_.seen({0, 1, 2}, there), first_hit_triangles(rays_, there, cameras_, pool_));
    EXPECT_EQ(hits_.seen({1}, there), first_hit_triangles(rays_, there, {cameras_[1]}, pool_));
  }
}

TEST_F(HitCacheTest, KeepsItsAnswers) {
  const CameraHits* const first = &hits_.of(0, all_);
  const CameraHits* const behind = &hits_.of(0, back_);
  EXPECT_NE(first, behind);
  EXPECT_EQ(&hits_.of(0, all_), first);
  EXPECT_EQ(&hits_.of(0, back_), behind);
}

}  // namespace
}  // namespace aligngs
