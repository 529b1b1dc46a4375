#include "mesh/mesh_labels.h"

#include <gtest/gtest.h>

#include "mesh/testing/analytic_scenes.h"

namespace aligngs {
namespace {

/// A camera at x that looks along z at a wall at z = 2, and says that everything is of class `label`.
FusionFrame wall_view(double x, uint16_t label, float probability) {
  FusionFrame frame = test::render(test::look_at({x, 0, 0}, {x, 0, 2}, 100, 100, 100), test::room({9, 9, 2}));
  frame.label = Image<uint16_t>(100, 100, 1, label);
  frame.label_probability = ImageF(100, 100, 1, probability);
  return frame;
}

TriangleMesh three_points() {
  TriangleMesh mesh;
  mesh.vertices = {{0.01f, 0.01f, 2}, {0.01f, 0.01f, 2.3f}, {5, 0, 2}};  // on the wall, behind it, out of every image
  return mesh;
}

TEST(LabelMesh, TheMostProbableClassWins) {
  ThreadPool pool(2);
  TriangleMesh mesh = three_points();
  const std::vector<FusionFrame> frames = {wall_view(0, 7, 0.9f), wall_view(0.1, 3, 0.4f), wall_view(-0.1, 3, 0.4f)};
  const MeshLabelingReport report = label_mesh(mesh, frames, pool);
  EXPECT_EQ(mesh.labels, (std::vector<uint16_t>{7, kNoLabel, kNoLabel}));  // 0.9 against 0.8
  EXPECT_EQ(report.labelled, 1u);
  EXPECT_EQ(report.unseen, 2u);
}

TEST(LabelMesh, ObliqueViewsCountLess) {
  ThreadPool pool(1);
  TriangleMesh mesh = three_points();
  mesh.normals.assign(3, {0, 0, -1});
  FusionFrame oblique =
      test::render(test::look_at({2, 0, 0}, {0, 0, 2}, 100, 100, 100), test::room({9, 9, 2}));  // 45 degrees: 0.71
  oblique.label = Image<uint16_t>(100, 100, 1, 3);
  const std::vector<FusionFrame> frames = {wall_view(0, 7, 0.8f), oblique};
  label_mesh(mesh, frames, pool);
  EXPECT_EQ(mesh.labels[0], 7);
  mesh.normals.clear();  // without normals, the probabilities alone decide: 0.8 against 1
  label_mesh(mesh, frames, pool);
  EXPECT_EQ(mesh.labels[0], 3);
}

TEST(LabelMesh, EqualVotesGoToTheSmallerClass) {
  ThreadPool pool(1);
  TriangleMesh mesh = three_points();
  label_mesh(mesh, {wall_view(0.1, 9, 0.5f), wall_view(-0.1, 2, 0.5f)}, pool);
  EXPECT_EQ(mesh.labels[0], 2);
}

TEST(LabelMesh, PixelsWithoutLabelAndTransparentOnesHaveNoVote) {
  ThreadPool pool(1);
  TriangleMesh mesh = three_points();
  FusionFrame transparent = wall_view(0, 5, 1);
  transparent.alpha = ImageF(100, 100, 1, 0.2f);
  label_mesh(mesh, {wall_view(0, kNoLabel, 1), transparent}, pool);
  EXPECT_EQ(mesh.labels[0], kNoLabel);
  EXPECT_EQ(label_mesh(mesh, {}, pool).unseen, 3u);
}

}  // namespace
}  // namespace aligngs
