// Prior depth in fusion: taken where it is measured or refined, and rendered depth confirms it.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "io/atomic_file.h"
#include "io/json_text.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing_support::run_aligngs;

class ConfirmedPrior : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) / "confirmed_prior";
    fs::remove_all(root_);
    testing_support::write_small_scene(root_ / "scene");
    ASSERT_EQ(run_aligngs("train " + quoted("scene") + " -o " + quoted("run") + " -n 40 -q", root_).status, 0);
  }
  std::string quoted(const std::string& name) const { return "'" + (root_ / name).string() + "'"; }
  /// The mesh with so much of a difference between prior and rendering.
  std::string mesh(const std::string& agreement) const {
    const auto made = run_aligngs("mesh " + quoted("run") + " -o " + quoted("mesh.ply") +
                                      " -q --set mesh.voxel=0.05 --set mesh.prior_agreement=" + agreement,
                                  root_);
    EXPECT_EQ(made.status, 0) << made.err;
    return read_file(root_ / "mesh.ply");
  }
  void set(const std::string& file, const std::string& key, const nlohmann::json& value) const {
    nlohmann::json json = parse_json(read_file(root_ / "scene" / file));
    json[nlohmann::json::json_pointer(key)] = value;
    write_file_atomically(root_ / "scene" / file, json.dump());
  }

  fs::path root_;
};

TEST_F(ConfirmedPrior, IsFusedWhereItIsMeasuredOrRefined) {
  EXPECT_TRUE(mesh("0.02") == mesh("0")) << "depth as a network gave it";
  set("priors.json", "/depth/model", "sensor");
  EXPECT_FALSE(mesh("0.02") == mesh("0")) << "depth of a sensor";
  set("priors.json", "/depth/model", "a network");
  EXPECT_TRUE(mesh("0.02") == mesh("0"));
  set("scene.json", "/cameras_refined", {{"tracks", 1}});
  EXPECT_FALSE(mesh("0.02") == mesh("0")) << "refined depth";
}

}  // namespace
}  // namespace aligngs
