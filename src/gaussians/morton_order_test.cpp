#include "gaussians/morton_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "gaussians/restructure.h"

namespace aligngs {
namespace {

/// Rows that carry their number in every array.
GaussianModel model_at(const std::vector<Vec3f>& positions) {
  GaussianModel model;
  model.semantic_channels = 2;
  model.resize(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) model.positions[3 * i + k] = positions[i][static_cast<int>(k)];
    model.opacity_logits[i] = static_cast<float>(i);
    model.semantics[2 * i + 1] = static_cast<float>(i);
  }
  return model;
}

std::vector<uint32_t> sources(const RestructurePlan& plan) {
  std::vector<uint32_t> out;
  for (const RowOrigin& row : plan.rows) out.push_back(row.source);
  return out;
}

RestructurePlan sorted(const GaussianModel& model) {
  RestructurePlan plan = plan_keep(std::vector<uint8_t>(model.size(), 1));
  sort_by_morton(model, plan);
  return plan;
}

TEST(MortonOrder, CodesInterleaveTheBits) {
  EXPECT_EQ(morton_code(0, 0, 0), 0u);
  EXPECT_EQ(morton_code(1, 0, 0), 1u);
  EXPECT_EQ(morton_code(0, 1, 0), 2u);
  EXPECT_EQ(morton_code(0, 0, 1), 4u);
  EXPECT_EQ(morton_code(3, 5, 6), 0b110'101'011u);  // threes of bits of z, y, x
  const uint32_t all = (1u << kMortonBits) - 1u;
  EXPECT_EQ(morton_code(all, all, all), (uint64_t(1) << 63) - 1);
  for (int bit = 0; bit < kMortonBits; ++bit) EXPECT_EQ(morton_code(0, 1u << bit, 0), uint64_t(2) << (3 * bit));
}

TEST(MortonOrder, GoesThroughTheOctantsOneAfterTheOther) {
  const std::vector<Vec3f> corners = {{9, 9, 9}, {0, 9, 9}, {9, 0, 9}, {0, 0, 9},
                                      {9, 9, 0}, {0, 9, 0}, {9, 0, 0}, {0, 0, 0}};
  EXPECT_EQ(sources(sorted(model_at(corners))), (std::vector<uint32_t>{7, 6, 5, 4, 3, 2, 1, 0}));
  // Two clusters, given in turn, are apart afterwards.
  std::vector<Vec3f> clusters;
  for (int i = 0; i < 20; ++i) clusters.push_back({i % 2 == 0 ? 0.1f : 5.0f, 0.001f * static_cast<float>(i), 0.0f});
  const std::vector<uint32_t> order = sources(sorted(model_at(clusters)));
  for (size_t i = 0; i < 20; ++i) EXPECT_EQ(order[i] % 2, i < 10 ? 0u : 1u) << i;
}

TEST(MortonOrder, RowsTakeParametersMomentsAndStatisticsAlong) {
  GaussianModel model = model_at({{2, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  const RestructurePlan plan = sorted(model);
  ASSERT_EQ(sources(plan), (std::vector<uint32_t>{1, 2, 0}));
  std::vector<float> moments = {0, 0.5f, 1, 1.5f, 2, 2.5f}, radius = {10, 11, 12};
  restructure_model(plan, model);
  restructure_rows(plan, 2, moments);
  restructure_rows(plan, 1, radius);
  EXPECT_EQ(model.positions, (std::vector<float>{0, 0, 0, 1, 0, 0, 2, 0, 0}));
  EXPECT_EQ(model.opacity_logits, (std::vector<float>{1, 2, 0}));
  EXPECT_EQ(model.semantics, (std::vector<float>{0, 1, 0, 2, 0, 0}));
  EXPECT_EQ(moments, (std::vector<float>{1, 1.5f, 2, 2.5f, 0, 0.5f}));
  EXPECT_EQ(radius, (std::vector<float>{11, 12, 10}));
}

TEST(MortonOrder, AModelIsOrderedInPlace) {
  GaussianModel model = model_at({{2, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  model.opacity_logits = {0, 1, 2};
  sort_by_morton(model);
  EXPECT_EQ(model.positions, (std::vector<float>{0, 0, 0, 1, 0, 0, 2, 0, 0}));
  EXPECT_EQ(model.opacity_logits, (std::vector<float>{1, 2, 0}));
}

TEST(MortonOrder, NewRowsStandWhereTheyWillBe) {
  const GaussianModel model = model_at({{0, 0, 0}, {4, 0, 0}});
  RestructurePlan plan = plan_keep({1, 1});
  plan.cloned = 1;
  plan.rows.push_back({1, RowOrigin::Kind::kClone, {-3, 0, 0}, 1});  // at x = 1, between the two
  sort_by_morton(model, plan);
  EXPECT_EQ(sources(plan), (std::vector<uint32_t>{0, 1, 1}));
  EXPECT_EQ(plan.rows[1].kind, RowOrigin::Kind::kClone);
  EXPECT_EQ(plan.rows[2].kind, RowOrigin::Kind::kKeep);
  EXPECT_EQ(plan.cloned, 1u);
}

TEST(MortonOrder, EqualPositionsKeepTheirOrder) {
  EXPECT_EQ(sources(sorted(model_at(std::vector<Vec3f>(5, {1, 2, 3})))), (std::vector<uint32_t>{0, 1, 2, 3, 4}));
  EXPECT_TRUE(sorted(model_at({})).rows.empty());
}

TEST(MortonOrder, PositionsThatAreNotFiniteComeLast) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const float most = std::numeric_limits<float>::max();
  EXPECT_EQ(sources(sorted(model_at({{nan, 0, 0}, {1, 0, 0}, {0, infinity, 0}, {0, 0, 0}}))),
            (std::vector<uint32_t>{3, 1, 0, 2}));
  EXPECT_EQ(sources(sorted(model_at({{most, 0, 0}, {-most, 0, 0}}))), (std::vector<uint32_t>{1, 0}));
}

TEST(MortonOrder, DensityControlOrdersItsPlanWhenAsked) {
  const GaussianModel model = model_at({{2, 0, 0}, {0, 0, 0}, {1, 0, 0}});
  DensityStatistics statistics;
  for (std::vector<float>* v : {&statistics.gradient, &statistics.gradient_abs, &statistics.visible, &statistics.radius,
                                &statistics.weight, &statistics.residual, &statistics.unsupported}) {
    v->assign(3, 0.0f);
  }
  DensityRule rule;
  Random random(1);
  EXPECT_EQ(sources(plan_density_control(model, statistics, rule, random)), (std::vector<uint32_t>{0, 1, 2}));
  rule.morton_order = true;
  EXPECT_EQ(sources(plan_density_control(model, statistics, rule, random)), (std::vector<uint32_t>{1, 2, 0}));
}

}  // namespace
}  // namespace aligngs
