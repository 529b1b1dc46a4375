#include "mesh/fusion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/quaternion.h"
#include "mesh/testing/analytic_scenes.h"
#include "mesh/tsdf_voxel.h"
#include "metrics/surface_points.h"
#include "scene/depth_normals.h"

namespace aligngs {
namespace {

ThreadPool& pool() {
  static ThreadPool instance(2);
  return instance;
}

FusionOptions with_voxel(double voxel) {
  FusionOptions options = test::fusion_options();
  options.metric = true;
  options.voxel = voxel;
  options.depth_quantile = 1;
  return options;
}

double mean_area_weighted_facing(const TriangleMesh& mesh, const Vec3d& inside) {
  double sum = 0, area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    const Vec3d a = mesh.vertices[c[0]].cast<double>();
    const Vec3d n = cross(mesh.vertices[c[1]].cast<double>() - a, mesh.vertices[c[2]].cast<double>() - a);
    sum += dot(n, normalized(a - inside));
    area += norm(n);
  }
  return sum / area;
}

TEST(FuseDepth, ABallIsFoundWithinAFractionOfAVoxel) {
  const FusionResult result = fuse_depth(test::ball_views(0.5), with_voxel(0.02), pool());
  ASSERT_GT(result.mesh.vertices.size(), 1000u);
  double squared = 0, worst = 0;
  for (const Vec3f& v : result.mesh.vertices) {
    const double error = std::abs(norm(v.cast<double>()) - 0.5);
    squared += error * error;
    worst = std::max(worst, error);
  }
  EXPECT_LT(std::sqrt(squared / static_cast<double>(result.mesh.vertices.size())), 0.2 * 0.02);
  EXPECT_LT(worst, 1.0 * 0.02);
  EXPECT_NEAR(sample_surface(result.mesh).area, 3.14159, 0.05);  // 4 pi r^2: closed, no second layer
}

/// A view of 64 x 64 pixels along z, which keeps pointers to both maps.
VoxelView straight_view(const ImageF& depth, const ImageF& weight) {
  VoxelView view;
  view.depth = depth.data.data();
  view.weight = weight.data.data();
  view.width = view.height = 64;
  view.fx = view.fy = 64;
  view.cx = view.cy = 32;
  view.truncation = 0.04f;
  return view;
}

TEST(FuseDepth, TangentDistanceIsTheDistanceFromThePlaneHoweverItIsSeen) {
  // A floor 1 m below the camera, seen at 60 degrees: along the ray a voxel 1 cm above it is 2 cm before it.
  const ImageF depth(64, 64, 1, 2.0f), weight(64, 64, 1, 1.0f), slope(64, 64, 1, 0.5f);
  VoxelView view = straight_view(depth, weight);
  Voxel along_ray, from_plane;
  fuse_voxel(view, {0, 0, 1.98f}, along_ray);
  view.slope = slope.data.data();
  fuse_voxel(view, {0, 0, 1.98f}, from_plane);
  EXPECT_NEAR(along_ray.tsdf * view.truncation, 0.02, 1e-6);
  EXPECT_NEAR(from_plane.tsdf * view.truncation, 0.01, 1e-6);
}

TEST(FuseDepth, SurfaceSeenAtAnAngleReachesNoFartherBehindItselfThanItsBound) {
  // Seen at 84 degrees, 25 cm along the ray are 2.5 cm from the tangent plane.
  const ImageF depth(64, 64, 1, 2.0f), weight(64, 64, 1, 1.0f), slope(64, 64, 1, 0.1f);
  VoxelView view = straight_view(depth, weight);
  view.slope = slope.data.data();
  view.behind = 0.08f;
  Voxel within, beyond;
  fuse_voxel(view, {0, 0, 2.07f}, within);
  fuse_voxel(view, {0, 0, 2.25f}, beyond);
  EXPECT_NEAR(within.tsdf * view.truncation, -0.007, 1e-6);
  EXPECT_EQ(beyond.weight, 0);
}

TEST(FuseDepth, TangentDistanceFindsTheSameRoom) {
  std::vector<FusionFrame> frames = test::room_views({2, 1.3, 2.5}, 12);
  for (FusionFrame& frame : frames) frame.normal = camera_normals(frame.depth, frame.camera);
  FusionOptions options = with_voxel(0.03);
  options.tangent_distance = true;
  const FusionResult result = fuse_depth(frames, options, pool());
  ASSERT_GT(result.mesh.vertices.size(), 1000u);
  double sum = 0;
  for (const Vec3f& v : result.mesh.vertices) {
    sum += std::min({std::abs(std::abs(v.x) - 2.0), std::abs(std::abs(v.y) - 1.3), std::abs(std::abs(v.z) - 2.5)});
  }
  EXPECT_LT(sum / static_cast<double>(result.mesh.vertices.size()), 0.1 * 0.03);
}

TEST(FuseDepth, TrianglesAndNormalsFaceTheCameras) {
  const FusionResult result = fuse_depth(test::ball_views(0.5), with_voxel(0.02), pool());
  EXPECT_GT(mean_area_weighted_facing(result.mesh, {}), 0.97);
  ASSERT_EQ(result.mesh.normals.size(), result.mesh.vertices.size());
  double sum = 0;
  for (size_t i = 0; i < result.mesh.vertices.size(); ++i) {
    sum += dot(result.mesh.normals[i], normalized(result.mesh.vertices[i]));
  }
  EXPECT_GT(sum / static_cast<double>(result.mesh.vertices.size()), 0.98);
}

TEST(FuseDepth, ARoomIsFoundWithinAFractionOfAVoxel) {
  const Vec3d half{2, 1.2, 1.6};
  const FusionResult result = fuse_depth(test::room_views(half, 12), with_voxel(0.03), pool());
  ASSERT_GT(result.mesh.vertices.size(), 5000u);
  double sum = 0;
  for (const Vec3f& v : result.mesh.vertices) {
    double distance = 1e9;
    for (int a = 0; a < 3; ++a) distance = std::min(distance, std::abs(std::abs(double(v[a])) - half[a]));
    sum += distance;
  }
  EXPECT_LT(sum / static_cast<double>(result.mesh.vertices.size()), 0.1 * 0.03);
  EXPECT_LT(mean_area_weighted_facing(result.mesh, {}), -0.5);  // the walls face inwards
}

TEST(FuseDepth, ChoosesLengthsFromTheDataWithinTheBounds) {
  FusionOptions options = test::fusion_options();
  options.metric = true;
  const FusionReport report = fuse_depth(test::room_views({2, 1.2, 1.6}, 6), options, pool()).report;
  // Median depth of about 2 m at a focal length of 112 px: a footprint of 1.8 cm, above the bound of 1.5 cm.
  EXPECT_NEAR(report.median_footprint, report.median_depth / 112, 0.003);
  EXPECT_EQ(report.voxel, 0.015);
  EXPECT_EQ(report.truncation, 0.05);
  EXPECT_EQ(report.metre, 1);
  EXPECT_EQ(report.training_views, 6u);
}

TEST(FuseDepth, ASimilarityOfSceneAndCamerasChangesNothingElse) {
  // Quarter turns and a power of two: the same lattice, up to rounding.
  std::vector<FusionFrame> frames = test::room_views({2, 1.2, 1.6}, 6);
  const FusionReport original = fuse_depth(frames, {}, pool()).report;
  Similarity world;
  world.scale = 0.25;
  world.rotation = rotation_matrix(normalized(Quaterniond{1, 0, 1, 0}));
  for (FusionFrame& f : frames) {
    f.camera.world_to_camera = world.transform_world_to_camera(f.camera.world_to_camera);
    for (float& d : f.depth.data) d *= 0.25f;
  }
  const FusionReport moved = fuse_depth(frames, {}, pool()).report;
  EXPECT_NEAR(moved.voxel, 0.25 * original.voxel, 1e-6);
  EXPECT_NEAR(moved.truncation, 0.25 * original.truncation, 1e-6);
  EXPECT_NEAR(double(moved.triangles), double(original.triangles), 0.02 * double(original.triangles));
}

TEST(FuseDepth, IsTheSameForAnyNumberOfThreads) {
  std::vector<FusionFrame> frames = test::room_views({2, 1.2, 1.6}, 5, 80, 60);
  for (FusionFrame& f : frames) f.color = ImageF(80, 60, 3, 0.5f);
  const TriangleMesh expected = fuse_depth(frames, with_voxel(0.04), pool()).mesh;
  for (const int threads : {1, 3, 5}) {
    ThreadPool other(threads);
    const TriangleMesh mesh = fuse_depth(frames, with_voxel(0.04), other).mesh;
    ASSERT_EQ(mesh.vertices.size(), expected.vertices.size());
    EXPECT_EQ(mesh.triangles, expected.triangles);
    EXPECT_EQ(mesh.colors, expected.colors);
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      ASSERT_EQ(norm(mesh.vertices[i] - expected.vertices[i]), 0);
      ASSERT_EQ(norm(mesh.normals[i] - expected.normals[i]), 0);
    }
  }
}

TEST(FuseDepth, ColoursFollowTheViews) {
  std::vector<FusionFrame> frames = test::ball_views(0.5);
  for (FusionFrame& f : frames) {
    f.color = ImageF(160, 160, 3);
    for (size_t i = 0; i < f.color.pixels(); ++i) f.color.data[3 * i] = 0.8f;
  }
  const TriangleMesh mesh = fuse_depth(frames, with_voxel(0.02), pool()).mesh;
  for (const auto& c : mesh.colors) {
    EXPECT_NEAR(c[0], 204, 1);
    EXPECT_EQ(c[1], 0);
  }
  frames = test::ball_views(0.5);
  EXPECT_EQ(fuse_depth(frames, with_voxel(0.02), pool()).mesh.colors[0][0], 128);
}

TEST(FuseDepth, SurfaceThatAnotherViewLooksThroughIsDropped) {
  // Three views of a wall; one of them also reports a floater half way.
  std::vector<FusionFrame> frames;
  for (const double x : {-0.1, 0.0, 0.1}) {
    frames.push_back(test::render(test::look_at({x, 0, 0}, {x, 0, 2}, 100, 100, 100), test::room({9, 9, 2})));
  }
  for (int y = 30; y < 60; ++y)
    for (int x = 30; x < 60; ++x) frames[1].depth.at(x, y) = 1;
  const FusionResult result = fuse_depth(frames, with_voxel(0.02), pool());
  for (const Vec3f& v : result.mesh.vertices) ASSERT_GT(v.z, 1.8f);
  EXPECT_NEAR(result.report.contradicted, 900.0 / 30000, 0.004);
  EXPECT_GT(result.report.confirmed, 0.9);
}

TEST(FuseDepth, SurfaceOfASingleViewIsKept) {
  std::vector<FusionFrame> frames;
  frames.push_back(test::render(test::look_at({0, 0, 0}, {0, 0, 2}, 100, 100, 100), test::room({9, 9, 2})));
  FusionOptions options = with_voxel(0.02);
  const FusionResult result = fuse_depth(frames, options, pool());
  EXPECT_EQ(result.report.single_view, 1);
  EXPECT_NEAR(sample_surface(result.mesh).area, 4, 0.2);
  options.single_view_weight = 0;
  EXPECT_TRUE(fuse_depth(frames, options, pool()).mesh.empty());
}

TEST(FuseDepth, InterpolatedViewsNeverCreateNorCarveWhatNoTrainingViewSaw) {
  std::vector<FusionFrame> frames;
  frames.push_back(test::render(test::look_at({0, 0, 0}, {0, 0, 2}, 100, 100, 100), test::room({9, 9, 2})));
  const TriangleMesh alone = fuse_depth(frames, with_voxel(0.02), pool()).mesh;
  // A view of twice the field, half of it nothing that the training view saw.
  frames.push_back(test::render(test::look_at({0, 0, 0}, {0, 0, 2}, 100, 100, 50), test::room({9, 9, 2})));
  frames.back().interpolated = true;
  const FusionResult result = fuse_depth(frames, with_voxel(0.02), pool());
  EXPECT_EQ(result.report.interpolated_views, 1u);
  EXPECT_NEAR(sample_surface(result.mesh).area, sample_surface(alone).area, 0.01);
}

TEST(FuseDepth, TheFaceFilterMovesVerticesByAVoxelAtMost) {
  const std::vector<FusionFrame> frames = test::ball_views(0.5);
  FusionOptions options = with_voxel(0.02);
  const FusionResult before = fuse_depth(frames, options, pool());
  options.face_filter = 10;
  const FusionResult after = fuse_depth(frames, options, pool());
  ASSERT_EQ(after.mesh.vertices.size(), before.mesh.vertices.size());
  EXPECT_EQ(after.mesh.triangles, before.mesh.triangles);
  float most = 0;
  for (size_t v = 0; v < after.mesh.vertices.size(); ++v)
    most = std::max(most, norm(after.mesh.vertices[v] - before.mesh.vertices[v]));
  EXPECT_GT(most, 0);
  EXPECT_LE(most, 0.02f * 1.0001f);
}

TEST(FuseDepth, TransparentAndFarPixelsAreLeftOut) {
  std::vector<FusionFrame> frames;
  frames.push_back(test::render(test::look_at({0, 0, 0}, {0, 0, 2}, 100, 100, 100), test::room({9, 9, 2})));
  frames[0].alpha = ImageF(100, 100, 1, 1.0f);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 50; ++x) frames[0].alpha.at(x, y) = 0.5f;
  EXPECT_NEAR(sample_surface(fuse_depth(frames, with_voxel(0.02), pool()).mesh).area, 2, 0.15);
  FusionOptions near = with_voxel(0.02);
  near.max_depth = 1.5;
  EXPECT_TRUE(fuse_depth(frames, near, pool()).mesh.empty());
}

TEST(FuseDepth, NothingToFuseGivesAnEmptyMesh) {
  EXPECT_TRUE(fuse_depth({}, {}, pool()).mesh.empty());
  FusionFrame frame;
  frame.camera = test::look_at({0, 0, 0}, {0, 0, 1}, 20, 20, 20);
  frame.depth = ImageF(20, 20, 1, NAN);
  frame.depth.at(3, 3) = -1;
  frame.depth.at(4, 4) = INFINITY;
  const FusionResult result = fuse_depth({frame}, {}, pool());
  EXPECT_TRUE(result.mesh.empty());
  EXPECT_EQ(result.report.pixels, 0u);
}

TEST(FuseDepth, TheMemoryBudgetIsHeld) {
  FusionOptions options = with_voxel(0.02);
  options.max_bytes = 1 << 20;
  try {
    fuse_depth(test::room_views({2, 1.2, 1.6}, 4), options, pool());
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources);
    EXPECT_NE(e.details().remedy.find("larger voxel"), std::string::npos);
  }
}

TEST(FuseDepth, BadInputIsNamed) {
  std::vector<FusionFrame> frames = test::ball_views(0.5, 40);
  frames[2].name = "view2";
  frames[2].color = ImageF(20, 20, 3);
  try {
    fuse_depth(frames, with_voxel(0.05), pool());
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(e.details().path, "view2");
    EXPECT_EQ(e.details().field, "color");
  }
  frames[2].color = {};
  frames[2].camera.world_to_camera.translation.x = NAN;
  EXPECT_THROW(fuse_depth(frames, with_voxel(0.05), pool()), Error);
}

TEST(FuseDepth, SettingsThatCannotBeAreRefused) {
  const auto frames = test::ball_views(0.5, 40);
  FusionOptions options = with_voxel(1e-6);  // a truncation of 3 cm would be 30000 voxels
  EXPECT_THROW(fuse_depth(frames, options, pool()), Error);
  options = with_voxel(0.05);
  options.interpolated_weight = 0.5;
  EXPECT_THROW(fuse_depth(frames, options, pool()), Error);
}

TEST(TwoViewResidual, IsTheDisagreementOfTheViews) {
  std::vector<FusionFrame> frames;
  for (const double x : {-0.1, 0.1}) {
    frames.push_back(test::render(test::look_at({x, 0, 0}, {x, 0, 2}, 100, 100, 100), test::room({9, 9, 2})));
  }
  for (float& d : frames[1].depth.data) d += 0.02f;
  EXPECT_NEAR(two_view_residual(frames, {frames[0].depth, frames[1].depth}, pool()), 0.02, 1e-4);
  EXPECT_EQ(two_view_residual({frames[0]}, {frames[0].depth}, pool()), 0);
}

}  // namespace
}  // namespace aligngs
