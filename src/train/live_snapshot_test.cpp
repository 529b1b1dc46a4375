#include "train/live_snapshot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gaussians/gaussian_ply.h"
#include "io/ply.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class LiveSnapshot : public testing::Test {
 protected:
  void SetUp() override {
    run_ = fs::path(testing::TempDir()) / "aligngs_live_snapshot" /
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(run_);
    model_.semantic_channels = 150;
    model_.resize(3);
    for (size_t i = 0; i < 3; ++i) {
      model_.positions[3 * i] = static_cast<float>(i);
      model_.rotations[4 * i] = 1;
      model_.semantics[150 * i + 7 + i] = 6;
    }
  }
  fs::path file() const { return run_ / "live" / "scene.ply"; }

  fs::path run_;
  GaussianModel model_;
  ThreadPool pool_{1};
};

TEST_F(LiveSnapshot, HoldsPositionsAndClasses) {
  write_live_snapshot(RunFolder(run_), model_, ade20k_labels(), pool_);
  const PlyFile ply = read_ply(file());
  const PlyElement* vertices = ply.find("vertex");
  ASSERT_NE(vertices, nullptr);
  EXPECT_EQ(vertices->find("label")->values, (std::vector<double>{7, 8, 9}));
  EXPECT_EQ(read_gaussian_ply(file()).positions, model_.positions);
}

TEST_F(LiveSnapshot, LeavesOutWhatIsNotFinite) {
  model_.positions[3] = std::numeric_limits<float>::quiet_NaN();
  write_live_snapshot(RunFolder(run_), model_, ade20k_labels(), pool_);
  EXPECT_EQ(read_gaussian_ply(file()).size(), 2u);
}

TEST_F(LiveSnapshot, WithoutSemanticsThereAreNoLabels) {
  model_.semantic_channels = 0;
  model_.semantics.clear();
  write_live_snapshot(RunFolder(run_), model_, ade20k_labels(), pool_);
  EXPECT_EQ(read_ply(file()).find("vertex")->find("label"), nullptr);
}

TEST_F(LiveSnapshot, GoesWhenItsTimeIsOver) {
  write_live_snapshot(RunFolder(run_), model_, ade20k_labels(), pool_);
  remove_live_snapshot(RunFolder(run_));
  EXPECT_FALSE(fs::exists(run_ / "live"));
  remove_live_snapshot(RunFolder(run_));
}

}  // namespace
}  // namespace aligngs
