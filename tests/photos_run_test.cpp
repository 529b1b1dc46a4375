// `aligngs run` on photos to the end, with networks of random weights and tiny sizes.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "priors/testing/tiny_networks.h"
#include "scene/scene.h"
#include "support/no_weights.h"
#include "support/process.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

class PhotosRun : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) / "photos_run";
    fs::remove_all(root_);
    no_weights_.emplace(root_);
    fs::create_directories(root_ / "photos");
    for (const char* name : {"a.png", "b.png", "c.png", "d.png"}) write_photo(name);
  }
  /// Colours that change over the photo, in another way for each.
  void write_photo(const std::string& name) const {
    Image<uint8_t> image(112, 84, 3);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        image.at(x, y, 0) = static_cast<uint8_t>(2 * x + name[0]);
        image.at(x, y, 1) = static_cast<uint8_t>(3 * y);
        image.at(x, y, 2) = static_cast<uint8_t>((x / 8 + y / 8) % 2 * 200);
      }
    }
    write_png(root_ / "photos" / name, image);
  }
  ProcessResult run(const std::string& options) const {
    return run_aligngs("run '" + (root_ / "photos").string() + "' -o '" + run_folder().string() + "' " + options,
                       root_ / "scratch");
  }
  fs::path run_folder() const { return root_ / "run"; }

  fs::path root_;
  std::optional<testing_support::NoWeights> no_weights_;
};

TEST_F(PhotosRun, NetworksOfRandomWeightsLeadToAReport) {
  const ModelStore store(ModelStoreOptions::from_environment(true));
  tiny_networks::install_vggt(store);
  tiny_networks::install_linear(store);
  const ProcessResult result = run("--method vggt -n 2 -q --test-every 4");
  ASSERT_EQ(result.status, 0) << result.err;
  const Scene scene = open_scene(run_folder() / "scene");
  EXPECT_EQ(scene.views.size(), 4u);
  EXPECT_TRUE(scene.has_prior_depth());
  EXPECT_EQ(scene.semantic_source, "ade20k-linear-s");
  const nlohmann::json record = parse_json(read_file(run_folder() / "run.json"));
  EXPECT_EQ(record["status"], "done");
  EXPECT_EQ(record["stage"], "done");
  const nlohmann::json metrics = parse_json(read_file(run_folder() / "metrics.json"));
  EXPECT_TRUE(metrics["nvs"]["psnr"].is_number()) << metrics["nvs"];
  for (const char* file : {"scene.ply", "mesh/mesh.ply", "overview.jpg", "report.html"})
    EXPECT_TRUE(fs::exists(run_folder() / file)) << file;
}

}  // namespace
}  // namespace aligngs
