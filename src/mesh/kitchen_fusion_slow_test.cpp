// The real kitchen: sensor depth of the 24 training views, fused, against the reference from 1000 frames.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "io/image_file.h"
#include "mesh/fusion.h"
#include "mesh/testing/analytic_scenes.h"
#include "metrics/mesh_distance.h"
#include "metrics/mesh_protocols.h"
#include "metrics/run_metrics.h"
#include "metrics/surface_points.h"
#include "scene/mesh_ply.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

const fs::path kKitchen = fs::path(ALIGNGS_SOURCE_DIR) / "../shared/data/kitchen_rgbd";

std::vector<std::string> read_words(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> words;
  for (std::string word; file >> word;) words.push_back(word);
  return words;
}

Camera read_camera(const std::string& name) {
  const std::vector<std::string> k = read_words(kKitchen / "intrinsics.txt");
  const std::vector<std::string> m = read_words(kKitchen / "poses" / (name + ".txt"));
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = std::stod(k.at(0));
  camera.cx = std::stod(k.at(2));
  camera.fy = std::stod(k.at(4));
  camera.cy = std::stod(k.at(5));
  Rigidd camera_to_world;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) camera_to_world.rotation(r, c) = std::stod(m.at(4 * r + c));
    camera_to_world.translation[r] = std::stod(m.at(4 * r + 3));
  }
  camera.world_to_camera = camera_to_world.inverse();
  return camera;
}

class KitchenFusion : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kKitchen / "reference_mesh.ply")) GTEST_SKIP() << "kitchen_rgbd is not here";
    for (const std::string& name : read_words(kKitchen / "train.txt")) {
      FusionFrame frame;
      frame.name = name;
      frame.camera = read_camera(name);
      const Image<uint16_t> depth = read_gray_png(kKitchen / "depth" / (name + ".png"));
      frame.depth = ImageF(depth.width, depth.height, 1);
      for (size_t i = 0; i < depth.data.size(); ++i) {
        frame.depth.data[i] = depth.data[i] == 65535 ? 0.0f : 0.001f * static_cast<float>(depth.data[i]);
      }
      frame.color = to_float(read_image(kKitchen / "images" / (name + ".jpg")));
      frames_.push_back(std::move(frame));
    }
    reference_ = read_mesh_ply(kKitchen / "reference_mesh.ply");
    options_.metric = true;
  }

  MeshScores score(const TriangleMesh& mesh) {
    return compare_points({thin_to_voxels(mesh.vertices, 0.02), {}}, {thin_to_voxels(reference_.vertices, 0.02), {}},
                          pool_);
  }

  ThreadPool pool_{2};
  std::vector<FusionFrame> frames_;
  TriangleMesh reference_;
  FusionOptions options_ = test::fusion_options();
};

void print(const char* what, const MeshScores& s) {
  std::printf("  %s: Acc %.4f Comp %.4f Prec %.3f Recall %.3f F %.3f (%zu, %zu points)\n", what, s.accuracy,
              s.completeness, s.precision, s.recall, s.fscore, s.predicted_points, s.truth_points);
}

TEST_F(KitchenFusion, PlainFusionReproducesTheYardstick) {
  // As measured for the capture's README: 2 cm voxels, depth up to 3 m, no selection of pixels.
  options_.voxel = 0.02;
  options_.truncation = 0.06;
  options_.max_depth = 3;
  options_.single_view_weight = options_.contradicted_weight = 1;
  options_.min_component_area = options_.min_component_extent = -1;
  const FusionResult result = fuse_depth(frames_, options_, pool_);
  std::printf("  %s\n", result.report.text().c_str());
  const MeshScores scores = score(result.mesh);
  print("plain", scores);
  EXPECT_NEAR(scores.fscore, 0.914, 0.02);
  EXPECT_NEAR(scores.precision, 0.964, 0.02);
  EXPECT_NEAR(scores.recall, 0.869, 0.02);
}

TEST_F(KitchenFusion, DefaultsAreAsGoodAndFast) {
  const FusionResult result = fuse_depth(frames_, options_, pool_);
  std::printf("  %s\n", result.report.text().c_str());
  const MeshScores scores = score(result.mesh);
  print("default", scores);
  EXPECT_GT(scores.precision, 0.97);
  EXPECT_GT(scores.recall, 0.91);
  EXPECT_LT(result.report.seconds, 60);  // about 3 s on two free cores
}

TEST_F(KitchenFusion, ProtocolsAgreeOnAGoodMesh) {
  const TriangleMesh mesh = fuse_depth(frames_, options_, pool_).mesh;
  MeshEvaluationInput input;
  input.predicted = &mesh;
  input.truth = &reference_;
  for (const FusionFrame& f : frames_) {
    input.train.push_back(static_cast<int>(input.run_cameras.size()));
    input.run_cameras.push_back(f.camera);
  }
  for (const std::string& name : read_words(kKitchen / "test.txt")) input.run_cameras.push_back(read_camera(name));
  input.truth_cameras = input.run_cameras;
  const MeshEvaluation evaluation = evaluate_mesh(input, true, true, pool_);
  std::vector<MeshProtocolResult> all = evaluation.variants;
  all.insert(all.begin(), evaluation.headline);
  for (const MeshProtocolResult& r : all) {
    print(protocol_text(r).c_str(), r.scores);
    EXPECT_GT(r.scores.precision, 0.93);
    EXPECT_GT(r.scores.fscore, 0.85);
  }
}

}  // namespace
}  // namespace aligngs
