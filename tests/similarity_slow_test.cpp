// Nothing in the method may depend on the unit or the axes of the world. A scene scaled by 0.37 and turned must give
// the same PSNR and the same F-score within noise.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "io/colmap.h"
#include "io/json_text.h"
#include "io/npy.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

/// Moves cameras, points and prior depth of a scene folder; truth/ stays in metres.
void transform_scene(const fs::path& folder, const Similarity& similarity) {
  ColmapModel model = read_colmap_model(folder / "sparse");
  for (ColmapImage& image : model.images) {
    const Rigidd moved =
        similarity.transform_world_to_camera({rotation_matrix(normalized(image.rotation)), image.translation});
    image.rotation = quaternion_of(moved.rotation);
    image.translation = moved.translation;
  }
  for (ColmapPoint& point : model.points) point.position = similarity * point.position;
  fs::remove(folder / "sparse" / "points3D.ply");
  write_colmap_binary(folder / "sparse", model);
  for (const auto& entry : fs::directory_iterator(folder / "pred_depths")) {
    FloatArray depth = read_npy(entry.path());
    for (float& z : depth.data) z *= static_cast<float>(similarity.scale);
    write_npy_float32(entry.path(), depth.shape, depth.data.data());
  }
}

void forget_units(const fs::path& scene) {
  std::ofstream(scene / "scene.json") << R"({"units": "arbitrary", "up": null, "source": "test"})";
}

TEST(SimilarityInvariance, ScaledAndTurnedSceneGivesTheSameScores) {
  const fs::path base = fs::path(testing::TempDir()) / "similarity_test";
  fs::remove_all(base);
  fs::create_directories(base);
  testing_support::SmallSceneOptions options;
  options.width = 96;
  options.height = 72;
  options.views = 14;
  options.test_views = 4;
  testing_support::write_small_scene(base / "scene", options);
  forget_units(base / "scene");
  fs::copy(base / "scene", base / "moved", fs::copy_options::recursive);
  Similarity similarity;
  similarity.scale = 0.37;
  similarity.rotation = rotation_matrix(normalized(Quaterniond{0.6, -0.3, 0.5, 0.55}));
  similarity.translation = {5, -2, 1};
  transform_scene(base / "moved", similarity);

  nlohmann::json metrics[2];
  const char* names[2] = {"scene", "moved"};
  for (int i = 0; i < 2; ++i) {
    const ProcessResult result = run_aligngs(
        "run '" + (base / names[i]).string() + "' -o '" + (base / names[i]).string() + "_run' -q --json -n 150", base);
    ASSERT_EQ(result.status, 0) << result.err;
    metrics[i] = parse_json(result.out);
  }
  // Noise: voxels of the start and of the TSDF lie otherwise in a turned world.
  EXPECT_NEAR(metrics[0]["nvs"]["psnr"].get<double>(), metrics[1]["nvs"]["psnr"].get<double>(), 0.4);
  EXPECT_NEAR(metrics[0]["geometry"]["fscore"].get<double>(), metrics[1]["geometry"]["fscore"].get<double>(), 0.03);
  EXPECT_GT(metrics[0]["geometry"]["fscore"].get<double>(), 0.5);
  EXPECT_NEAR(metrics[0]["semantics"]["miou"].get<double>(), metrics[1]["semantics"]["miou"].get<double>(), 0.05);
  fs::remove_all(base);
}

}  // namespace
}  // namespace aligngs
