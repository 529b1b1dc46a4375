#include "gaussians/restructure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random.h"

namespace aligngs {
namespace {

constexpr RowOrigin::Kind kKeep = RowOrigin::Kind::kKeep, kClone = RowOrigin::Kind::kClone,
                          kSplit = RowOrigin::Kind::kSplit;

/// Every number tells its row and column.
std::vector<float> numbered(size_t rows, size_t width) {
  std::vector<float> out(rows * width);
  std::iota(out.begin(), out.end(), 0.0f);
  return out;
}

/// Meaning of a plan in the plainest way: the oracle.
std::vector<float> carried_out(const RestructurePlan& plan, size_t width, const std::vector<float>& rows) {
  std::vector<float> out;
  for (const RowOrigin& origin : plan.rows) {
    for (size_t k = 0; k < width; ++k) out.push_back(origin.kind == kKeep ? rows[origin.source * width + k] : 0.0f);
  }
  return out;
}

GaussianModel two_gaussians() {
  GaussianModel model;
  model.semantic_channels = 2;
  model.resize(2);
  model.positions = {0, 0, 0, 10, 0, 0};
  model.log_scales = {0, 0, 0, 0.5f, 0.5f, 0.5f};
  model.rotations = {1, 0, 0, 0, 1, 0, 0, 0};
  model.semantics = {0, 5, 1, 6};
  return model;
}

TEST(Restructure, MovesParametersAndZeroesMomentsOfNewRows) {
  GaussianModel model = two_gaussians();
  RestructurePlan plan;
  plan.rows = {{1, kKeep, {0, 0, 0}, 1}, {0, kSplit, {0.5f, 0, 0}, 2}};
  std::vector<float> moments = {1, 2, 3, 4};
  restructure_rows(plan, 2, moments);
  EXPECT_EQ(moments, (std::vector<float>{3, 4, 0, 0}));
  restructure_model(plan, model);
  ASSERT_EQ(model.size(), 2u);
  EXPECT_FLOAT_EQ(model.positions[0], 10);
  EXPECT_FLOAT_EQ(model.positions[3], 0.5f);
  EXPECT_NEAR(std::exp(model.log_scales[3]), 0.5, 1e-6);
  EXPECT_FLOAT_EQ(model.semantics[0], 1);
  EXPECT_FLOAT_EQ(model.semantics[2], 0);
}

TEST(Restructure, CopiesAreOfRowsAsTheyWereBeforeAnyMoved) {
  GaussianModel model = two_gaussians();
  RestructurePlan plan;
  plan.rows = {{1, kKeep}, {0, kClone}};  // row 1 moves to the place of the copy's source
  restructure_model(plan, model);
  EXPECT_EQ(model.semantics, (std::vector<float>{1, 6, 0, 5}));
}

TEST(Restructure, AnyPlanGivesWhatThePlainLoopGives) {
  constexpr size_t kOfThePlan = 40, kWidth = 3;
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    RestructurePlan plan;
    for (uint32_t i = 0; i < kOfThePlan; ++i) {
      if (random.uniform() < 0.8) plan.rows.push_back({i});
    }
    const size_t copies = trial % 3 == 0 ? 0 : static_cast<size_t>(random.uniform() * 20);
    for (size_t k = 0; k < copies; ++k)
      plan.rows.push_back({static_cast<uint32_t>(random.uniform() * kOfThePlan), k % 2 ? kClone : kSplit});
    if (trial % 5 == 0) std::reverse(plan.rows.begin(), plan.rows.end());  // as an order along a curve may have it
    std::vector<float> rows = numbered(kOfThePlan, kWidth);
    const std::vector<float> want = carried_out(plan, kWidth, rows);
    restructure_rows(plan, kWidth, rows);
    EXPECT_EQ(rows, want) << "trial " << trial;
  }
}

TEST(Restructure, KeepsItsMemoryWhereThereIsRoom) {
  std::vector<float> rows = numbered(100, 4);
  const float* before = rows.data();
  std::vector<uint8_t> keep(100, 1);
  keep[3] = keep[50] = 0;
  RestructurePlan plan = plan_keep(keep);
  plan.rows.push_back({7, kClone});
  restructure_rows(plan, 4, rows);
  EXPECT_EQ(rows.data(), before);
  EXPECT_EQ(rows.size(), 99u * 4);
}

TEST(Restructure, ArraysWithoutNumbersAndPlansWithoutRowsAreFine) {
  std::vector<float> none;
  restructure_rows(plan_keep({1, 0, 1}), 0, none);
  EXPECT_TRUE(none.empty());
  std::vector<float> rows = numbered(2, 3);
  restructure_rows(plan_keep({0, 0}), 3, rows);
  EXPECT_TRUE(rows.empty());
}

}  // namespace
}  // namespace aligngs
