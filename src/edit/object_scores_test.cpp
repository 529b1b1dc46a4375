#include "edit/object_scores.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/testing/small_room.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

/// Vertices of the small room's own mesh as its truth, an object for each run of one label.
std::vector<TrueObject> objects_of(const TriangleMesh& mesh) {
  std::vector<TrueObject> out;
  uint32_t begin = 0;
  for (uint32_t v = 1; v <= mesh.vertices.size(); ++v) {
    if (v < mesh.vertices.size() && mesh.labels[v] == mesh.labels[begin]) continue;
    out.push_back({"label " + std::to_string(mesh.labels[begin]), begin, v});
    begin = v;
  }
  return out;
}

double iou_of(const std::vector<ObjectScore>& scores, int label) {
  for (const ObjectScore& s : scores) {
    if (s.object == "label " + std::to_string(label)) return s.iou;
  }
  return -1;
}

class ObjectScores : public testing::Test {
 protected:
  ThreadPool pool_{2};
  EditableRoom room_ = small_room::make(pool_);
};

TEST_F(ObjectScores, TrueLabelsScoreHigh) {
  const auto scores = score_objects(room_, room_.mesh, objects_of(room_.mesh), pool_);
  EXPECT_GT(iou_of(scores, small_room::kBox), 0.9);
  EXPECT_GT(iou_of(scores, small_room::kFloor), 0.9);
}

TEST_F(ObjectScores, HalfOfABoxScoresHalf) {
  for (size_t i = 0; i < room_.gaussians.labels.label.size(); ++i) {
    if (room_.gaussians.labels.label[i] == small_room::kBox && room_.gaussians.model.positions[3 * i] < 0)
      room_.gaussians.labels.label[i] = small_room::kFloor;
  }
  const auto scores = score_objects(room_, room_.mesh, objects_of(room_.mesh), pool_);
  EXPECT_NEAR(iou_of(scores, small_room::kBox), 0.5, 0.1);
}

TEST_F(ObjectScores, ThingsAreCountedOneByOne) {
  ObjectDetection detection;
  std::vector<TrueObject> objects = objects_of(room_.mesh);
  score_objects(room_, room_.mesh, objects, pool_, {}, &detection);
  EXPECT_EQ(detection.truths, objects.size());  // their names are those of no wall
  EXPECT_GT(detection.right, 0u);
  EXPECT_LE(detection.right, detection.found);
  EXPECT_GT(detection.fscore(), 0.5);
}

TEST_F(ObjectScores, TwoThingsInOneObjectAreNotFound) {
  ObjectDetection apart, together;
  const std::vector<TrueObject> objects = objects_of(room_.mesh);
  score_objects(room_, room_.mesh, objects, pool_, {}, &apart);
  for (size_t i = 0; i < room_.gaussians.labels.label.size(); ++i) {
    if (room_.gaussians.labels.label[i] == small_room::kPillow) room_.gaussians.labels.instance[i] = 1;
  }
  score_objects(room_, room_.mesh, objects, pool_, {}, &together);
  EXPECT_LT(together.found, apart.found);
}

TEST_F(ObjectScores, AFloorUnderARugIsNotTheRug) {
  Camera above;
  above.width = above.height = 200;
  above.fx = above.fy = 50;
  above.cx = above.cy = 100;
  above.world_to_camera.rotation = Mat3d{{1, 0, 0, 0, 0, -1, 0, 1, 0}};
  above.world_to_camera.translation = {0, 0, 2};
  TriangleMesh truth = room_.mesh;  // the whole floor again 1 cm above the run's, as a rug
  const uint32_t first = static_cast<uint32_t>(truth.vertices.size());
  for (const Vec3f& corner :
       {Vec3f{-1.2f, -0.01f, -0.8f}, Vec3f{1.2f, -0.01f, -0.8f}, Vec3f{-1.2f, -0.01f, 0.8f}, Vec3f{1.2f, -0.01f, 0.8f}})
    truth.vertices.push_back(corner);
  truth.triangles.push_back({first, first + 1, first + 2});
  truth.triangles.push_back({first + 1, first + 3, first + 2});
  std::vector<TrueObject> objects = objects_of(room_.mesh);
  objects.push_back({"rug", first, first + 4});
  const auto rug = [&](const std::vector<ObjectScore>& scores) {
    double iou = -1;
    for (const ObjectScore& s : scores) iou = s.object == "rug" ? s.iou : iou;
    return iou;
  };
  EXPECT_LT(rug(score_objects(room_, truth, objects, pool_)), 0.1);  // the hidden floor is nearer
  room_.cameras = {above};
  EXPECT_GT(rug(score_objects(room_, truth, objects, pool_)), 0.8);
}

TEST_F(ObjectScores, ARunWithoutAMeshIsBadInput) {
  const TriangleMesh truth = room_.mesh;
  room_.mesh = {};
  EXPECT_THROW(score_objects(room_, truth, objects_of(truth), pool_), Error);
}

TEST_F(ObjectScores, VerticesThatTheMeshHasNotAreBadInput) {
  const std::filesystem::path file = testing::TempDir() + "/objects_of_test.json";
  write_file_atomically(file, R"({"schema": 1, "objects": [{"object": "box#1", "vertices": [0, 99]}]})");
  EXPECT_EQ(read_true_objects(file, 99).size(), 1u);
  EXPECT_THROW(read_true_objects(file, 98), Error);
  write_file_atomically(file, R"({"schema": 1, "objects": [{"object": "box#1", "vertices": [0, 1e308]}]})");
  EXPECT_THROW(read_true_objects(file, 99), Error);
}

}  // namespace
}  // namespace aligngs
