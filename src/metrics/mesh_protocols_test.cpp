#include "metrics/mesh_protocols.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/quaternion.h"
#include "core/random.h"
#include "metrics/surface_points.h"
#include "metrics/visibility.h"

namespace aligngs {
namespace {

/// A grid of n x n cells over the rectangle [x0, x1] x [y0, y1] at height z, facing the camera at the origin (-z).
void add_rectangle(TriangleMesh& mesh, float x0, float x1, float y0, float y1, float z, int n = 50) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      mesh.vertices.push_back({x0 + (x1 - x0) * float(i) / float(n), y0 + (y1 - y0) * float(j) / float(n), z});
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const uint32_t a = first + j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  }
}

TriangleMesh wall(float z, float half = 1) {
  TriangleMesh mesh;
  add_rectangle(mesh, -half, half, -half, half, z);
  return mesh;
}

/// A wall that every camera sees as a whole. A small post in front and one beside and behind it make the box around it
/// not flat. `shift` moves everything away from the cameras.
TriangleMesh wall_with_posts(float shift = 0) {
  TriangleMesh mesh = wall(2 + shift, 0.7f);
  add_rectangle(mesh, -0.69f, -0.66f, -0.69f, -0.66f, 1.5f + shift, 4);
  add_rectangle(mesh, 0.95f, 0.98f, 0, 0.03f, 2.5f + shift, 4);
  return mesh;
}

/// Two cameras on the x axis that look along z; a wall at z = 2 fills x in [-1, 1], y in [-1, 1] of each.
std::vector<Camera> two_cameras() {
  Camera camera;
  camera.width = camera.height = 200;
  camera.fx = camera.fy = 200;
  camera.cx = camera.cy = 100;
  std::vector<Camera> cameras(2, camera);
  cameras[0].world_to_camera.translation = {0.1, 0, 0};  // centre at x = -0.1
  cameras[1].world_to_camera.translation = {-0.1, 0, 0};
  return cameras;
}

MeshEvaluationInput make_input(const TriangleMesh& predicted, const TriangleMesh& truth) {
  MeshEvaluationInput input;
  input.predicted = &predicted;
  input.truth = &truth;
  input.run_cameras = input.truth_cameras = two_cameras();
  input.train = {0};
  return input;
}

using Protocol = MeshProtocolResult (*)(const MeshEvaluationInput&, CullingViews, MeshAlignment, ThreadPool&,
                                        const MeshProtocolOptions&);
class BothProtocols : public testing::TestWithParam<Protocol> {
 protected:
  MeshProtocolResult evaluate(const MeshEvaluationInput& input, CullingViews culling = CullingViews::kAll,
                              MeshAlignment alignment = MeshAlignment::kNone) {
    return GetParam()(input, culling, alignment, pool_, {});
  }
  ThreadPool pool_{2};
};
INSTANTIATE_TEST_SUITE_P(Protocols, BothProtocols, testing::Values(&evaluate_neuris_vertices, &evaluate_area_samples));

TEST_P(BothProtocols, ATruthWithoutAreaIsRefused) {
  const TriangleMesh predicted = wall(2);
  TriangleMesh truth = wall(2);
  for (auto& triangle : truth.triangles) triangle = {triangle[0], triangle[0], triangle[0]};
  EXPECT_THROW(evaluate(make_input(predicted, truth)), Error);
}

TEST_P(BothProtocols, AWallShifted3CentimetresIsPerfect) {
  const TriangleMesh truth = wall_with_posts(), predicted = wall_with_posts(-0.03f);
  const MeshProtocolResult result = evaluate(make_input(predicted, truth));
  EXPECT_EQ(result.scores.fscore, 1);
  EXPECT_NEAR(result.scores.accuracy, 0.03, 2e-3);
  EXPECT_NEAR(result.truth_area, 1.96, 0.05);
}

TEST_P(BothProtocols, AWallShifted7CentimetresIsWorthless) {
  const TriangleMesh truth = wall_with_posts(), predicted = wall_with_posts(-0.07f);
  const MeshProtocolResult result = evaluate(make_input(predicted, truth));
  EXPECT_EQ(result.scores.fscore, 0);
  EXPECT_NEAR(result.scores.completeness, 0.07, 5e-3);  // the rim projects off the truth and is dropped
}

TEST_P(BothProtocols, WhatNoCameraSeesIsNotJudged) {
  // Behind the cameras, and outside the frustum.
  TriangleMesh truth = wall(2, 0.7f), predicted = truth;
  add_rectangle(truth, -0.5f, 0.5f, -0.5f, 0.5f, -1);
  add_rectangle(predicted, 4, 5, 0, 1, 2);
  const MeshProtocolResult result = evaluate(make_input(predicted, truth));
  EXPECT_EQ(result.scores.precision, 1);
  EXPECT_EQ(result.scores.recall, 1);
}

TEST_P(BothProtocols, WhatIsHiddenBehindTheWallIsNotJudged) {
  const TriangleMesh truth = wall_with_posts();
  TriangleMesh predicted = truth;
  add_rectangle(predicted, -0.3f, 0.3f, -0.3f, 0.3f, 2.15f);  // a second layer, inside the truth's box x 1.1
  const MeshProtocolResult result = evaluate(make_input(predicted, truth));
  EXPECT_GT(result.scores.precision, 0.99);
}

TEST_P(BothProtocols, AFloaterInFrontOfTheWallIsWrong) {
  const TriangleMesh truth = wall_with_posts();
  TriangleMesh predicted = truth;
  add_rectangle(predicted, -0.2f, 0.2f, -0.2f, 0.2f, 1.9f);
  const MeshProtocolResult result = evaluate(make_input(predicted, truth));
  EXPECT_LT(result.scores.precision, 0.97);
}

TEST_P(BothProtocols, SurfaceWhereTheTruthHasAHoleIsNotPunished) {
  TriangleMesh truth;
  add_rectangle(truth, -0.7f, 0, -0.7f, 0.7f, 2);  // the right half is a hole
  const TriangleMesh predicted = wall(2, 0.7f);
  const MeshProtocolResult result = evaluate(make_input(predicted, truth));
  EXPECT_EQ(result.scores.precision, 1);
}

TEST_P(BothProtocols, TrainingPosesJudgeLess) {
  // Seen by the second camera alone: x beyond the right edge of the first.
  TriangleMesh truth = wall(2, 0.7f);
  add_rectangle(truth, 0.93f, 1.05f, -0.7f, 0.7f, 2);
  const TriangleMesh predicted = wall(2, 0.7f);
  EXPECT_EQ(evaluate(make_input(predicted, truth), CullingViews::kTraining).scores.recall, 1);
  EXPECT_LT(evaluate(make_input(predicted, truth), CullingViews::kAll).scores.recall, 0.97);
}

TEST_P(BothProtocols, AlignmentOnCamerasUndoesTheWorldOfTheRun) {
  const TriangleMesh truth = wall_with_posts();
  Similarity to_run;
  to_run.scale = 0.37;
  to_run.rotation = rotation_matrix(normalized(Quaterniond{0.9, 0.1, -0.3, 0.2}));
  to_run.translation = {3, -1, 2};
  const TriangleMesh predicted = transformed(truth, to_run);
  MeshEvaluationInput input = make_input(predicted, truth);
  input.train = {0, 1};
  for (Camera& c : input.run_cameras) c.world_to_camera = to_run.transform_world_to_camera(c.world_to_camera);
  const MeshProtocolResult result = evaluate(input, CullingViews::kAll, MeshAlignment::kCameras);
  EXPECT_EQ(result.alignment, MeshAlignment::kCameras);
  EXPECT_EQ(result.scores.fscore, 1);
  EXPECT_LT(result.scores.accuracy, 0.012);
  EXPECT_NEAR(result.alignment_report.similarity.scale, 1 / 0.37, 1e-6);
  EXPECT_LT(result.alignment_report.camera_rmse, 1e-9);
}

TEST_P(BothProtocols, IcpUndoesAShift) {
  const TriangleMesh truth = wall(2, 0.7f), predicted = wall(1.93f, 0.7f);
  const MeshProtocolResult result = evaluate(make_input(predicted, truth), CullingViews::kAll, MeshAlignment::kIcp);
  EXPECT_EQ(result.scores.fscore, 1);
  ASSERT_TRUE(result.alignment_report.icp.has_value());
  EXPECT_LT(result.alignment_report.icp->rmse_after, 1e-4);
}

TEST_P(BothProtocols, AnEmptyPredictionScoresZero) {
  const TriangleMesh truth = wall(2), nothing;
  const MeshProtocolResult result = evaluate(make_input(nothing, truth));
  EXPECT_EQ(result.scores.fscore, 0);
  EXPECT_EQ(result.scores.predicted_points, 0u);
}

TEST_P(BothProtocols, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh truth = wall_with_posts(), predicted = wall_with_posts(-0.04f);
  const MeshProtocolResult expected = evaluate(make_input(predicted, truth));
  for (const int threads : {1, 3}) {
    ThreadPool pool(threads);
    const MeshProtocolResult result =
        GetParam()(make_input(predicted, truth), CullingViews::kAll, MeshAlignment::kNone, pool, {});
    EXPECT_EQ(result.scores.accuracy, expected.scores.accuracy);
    EXPECT_EQ(result.scores.recall, expected.scores.recall);
  }
}

TEST_P(BothProtocols, WrongInputIsRefused) {
  const TriangleMesh truth = wall(2), nothing;
  EXPECT_THROW(evaluate(make_input(truth, nothing)), Error);
  MeshEvaluationInput input = make_input(truth, truth);
  input.run_cameras.pop_back();
  EXPECT_THROW(evaluate(input), Error);
}

TEST(EvaluateMesh, NamesTheHeadlineAndTheVariants) {
  const TriangleMesh truth = wall(2, 0.7f);
  ThreadPool pool(2);
  const MeshEvaluation metric = evaluate_mesh(make_input(truth, truth), true, true, pool);
  EXPECT_EQ(metric.headline.protocol, MeshProtocol::kNeurisVertices);
  EXPECT_EQ(metric.headline.culling, CullingViews::kAll);
  EXPECT_EQ(metric.headline.alignment, MeshAlignment::kNone);
  ASSERT_EQ(metric.variants.size(), 6u);
  EXPECT_EQ(metric.variants[3].alignment, MeshAlignment::kCameras);
  EXPECT_EQ(evaluate_mesh(make_input(truth, truth), false, false, pool).headline.alignment, MeshAlignment::kCameras);
}

TEST(Icp, RecoversASmallSimilarity) {
  // The six faces of a box: three that meet in a corner would leave the scale open.
  TriangleMesh room;
  add_rectangle(room, -1, 1, -1, 1, 1, 30);
  add_rectangle(room, -1, 1, -1, 1, -1, 30);
  const TriangleMesh pair = room;
  for (uint32_t turn = 1; turn <= 2; ++turn) {
    const auto first = static_cast<uint32_t>(room.vertices.size());
    for (const Vec3f& v : pair.vertices) {
      room.vertices.push_back(turn == 1 ? Vec3f{v.y, v.z, v.x} : Vec3f{v.z, v.x, v.y});
    }
    for (const auto& t : pair.triangles) room.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  Similarity moved;
  moved.scale = 1.02;
  moved.rotation = rotation_matrix(normalized(Quaterniond{1, 0.008, -0.006, 0.01}));
  moved.translation = {0.02, -0.01, 0.03};
  const SurfaceSamples target = sample_surface(transformed(room, moved));
  ThreadPool pool(2);
  const IcpReport report = align_by_icp(room.vertices, {target.positions, target.normals}, pool);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.rmse_after, 1e-4);
  EXPECT_GT(report.rmse_before, 0.01);
  EXPECT_NEAR(report.similarity.scale, 1.02, 1e-4);
  EXPECT_LT(rotation_angle_between_degrees(report.similarity.rotation, moved.rotation), 0.01);
  EXPECT_LT(norm(report.similarity.translation - moved.translation), 1e-3);
}

TEST(Icp, OutOfReachLeavesEverythingInPlace) {
  ThreadPool pool(1);
  const PointSet target{{{10, 0, 0}}, {{1, 0, 0}}};
  const IcpReport report = align_by_icp({{0, 0, 0}, {0, 1, 0}}, target, pool);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.similarity.scale, 1);
  EXPECT_EQ(report.inliers, 0);
  EXPECT_TRUE(std::isnan(report.rmse_after));
}

TEST(RayScene, FirstHitsHaveTheDepthOfTheWall) {
  const TriangleMesh mesh = wall(2);
  ThreadPool pool(2);
  const FirstHits hits = RayScene(mesh).cast(two_cameras()[0], pool);
  EXPECT_NEAR(hits.depth.at(100, 100), 2, 1e-5);
  EXPECT_NE(hits.triangle.at(100, 100), kNoTriangle);
  EXPECT_EQ(RayScene({}).cast(two_cameras()[0], pool).depth.at(100, 100), 0);
}

TEST(RayScene, RaysPassThroughTrianglesThatAreNotThere) {
  TriangleMesh mesh = wall(2);
  const size_t near_triangles = mesh.triangles.size();
  const TriangleMesh far = wall(3);
  for (const auto& t : far.triangles) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  mesh.vertices.insert(mesh.vertices.end(), far.vertices.begin(), far.vertices.end());
  std::vector<uint8_t> there(mesh.triangles.size(), 1);
  std::fill_n(there.begin(), near_triangles, uint8_t{0});
  ThreadPool pool(2);
  const FirstHits hits = RayScene(mesh).cast(two_cameras()[0], pool, &there);
  EXPECT_NEAR(hits.depth.at(100, 100), 3, 1e-5);
  EXPECT_GE(hits.triangle.at(100, 100), near_triangles);
}

TEST(RayScene, SeesUpToTheSurfaceAndNotThroughIt) {
  const RayScene rays(wall(2));
  EXPECT_TRUE(rays.sees({0, 0, 0}, {0.01, 0.01, 2}, 0.02));
  EXPECT_TRUE(rays.sees({0, 0, 0}, {0.01, 0.01, 2.015}, 0.02));
  EXPECT_FALSE(rays.sees({0, 0, 0}, {0.01, 0.01, 2.5}, 0.02));
}

}  // namespace
}  // namespace aligngs
