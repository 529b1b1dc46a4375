#include "scene/face_neighbours.h"

#include <gmock/gmock.h>

namespace aligngs {
namespace {

using testing::ElementsAre;

TEST(FaceNeighbours, AreAcrossTheEdgesOfAFace) {
  TriangleMesh mesh;
  mesh.vertices.resize(4);
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  const auto next = face_neighbours(mesh, CrowdedEdge::kJoinsNone);
  EXPECT_THAT(next[0], ElementsAre(kNoFace, 1u, kNoFace));
  EXPECT_THAT(next[1], ElementsAre(0u, kNoFace, kNoFace));
}

TEST(FaceNeighbours, AnEdgeOfThreeFacesJoinsTheFirstTwoOrNone) {
  TriangleMesh mesh;
  mesh.vertices.resize(5);
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const auto next = face_neighbours(mesh, CrowdedEdge::kJoinsFirstTwo);
  EXPECT_EQ(next[0][0], 1u);
  EXPECT_EQ(next[1][0], 0u);
  EXPECT_EQ(next[2][0], kNoFace);
  for (const auto& none : face_neighbours(mesh, CrowdedEdge::kJoinsNone)) EXPECT_EQ(none[0], kNoFace);
}

TEST(FaceNeighbours, AnEmptyMeshHasNone) { EXPECT_TRUE(face_neighbours({}, CrowdedEdge::kJoinsNone).empty()); }

}  // namespace
}  // namespace aligngs
