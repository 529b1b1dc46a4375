// The differences that the table reports.
#include "op_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "io/npy.h"

namespace aligngs::op_compare {
namespace {

using Floats = std::vector<float>;
using testing::HasSubstr;

TEST(OpTable, DifferencesAreRelativeToTheLargestEntry) {
  OpTable table;
  table.compare("blend", "colour", Floats{4.0f, 1.04f}, Floats{4.0f, 1.0f}, tight(0.02));
  const OpRow& row = table.rows().front();
  EXPECT_NEAR(row.worst, 0.01, 1e-6);
  EXPECT_NEAR(row.rms, 0.01 / std::sqrt(2.0), 1e-6);
  EXPECT_TRUE(table.ok());
  table.compare("blend", "alpha", Floats{1.0f}, Floats{1.05f}, tight(0.02));
  EXPECT_FALSE(table.ok());
  EXPECT_THAT(table.text(), HasSubstr("2 channels, 1 beyond their limit"));
  EXPECT_THAT(table.text(), HasSubstr("FAIL"));
}

TEST(OpTable, ASingleNumberIsComparedInItsUnit) {
  OpTable table;
  table.compare_number("losses", "psnr", 20.0005, 20.0, absolute(tight(1e-3)));
  EXPECT_TRUE(table.ok());
  table.compare_number("losses", "psnr", 20.01, 20.0, absolute(tight(1e-3)));
  EXPECT_FALSE(table.ok());
}

TEST(OpTable, WhatIsNotANumberIsADifferenceUnlessBothSidesAreNone) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  OpTable table;
  table.compare("a", "both", Floats{nan, 1.0f}, Floats{nan, 1.0f}, tight(0.1));
  EXPECT_TRUE(table.ok());
  table.compare("a", "one", Floats{nan, 1.0f}, Floats{1.0f, 1.0f}, tight(0.1));
  EXPECT_FALSE(table.ok());
  EXPECT_TRUE(std::isinf(table.rows().back().worst));
  Floats many(1000000, 1.0f);
  many[7] = nan;
  table.compare("a", "one of many", many, Floats(many.size(), 1.0f), tight(0.1));
  EXPECT_FALSE(table.rows().back().ok) << "not a flip";
}

TEST(OpTable, ADecisionMayFlipInOneOfManyEntriesAndInNoneOfFew) {
  Floats want(100000, 1.0f), got = want;
  got[7] = 2.0f;
  OpTable table;
  table.compare("a", "many", got, want, tight(0.1));
  EXPECT_TRUE(table.ok());
  EXPECT_EQ(table.rows().back().beyond, 1u);
  want.resize(1000);
  got.resize(1000);
  table.compare("a", "few", got, want, tight(0.1));
  EXPECT_FALSE(table.ok());
}

TEST(OpTable, ArraysOfTwoLengthsAreAFailure) {
  OpTable table;
  table.compare("a", "b", Floats{1.0f}, Floats{1.0f, 1.0f}, loose(10));
  EXPECT_FALSE(table.ok());
}

TEST(OpTable, ExactMeansExact) {
  OpTable table;
  table.compare("lists", "rows", std::vector<uint32_t>{3, 4}, std::vector<uint64_t>{3, 4}, exact());
  EXPECT_TRUE(table.ok());
  table.compare("lists", "rows", std::vector<uint32_t>{3, 4}, std::vector<uint64_t>{3, 5}, exact());
  EXPECT_FALSE(table.ok());
}

TEST(OpTable, BothSidesAreDumped) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "op_table";
  std::filesystem::remove_all(folder);
  OpTable table(folder);
  table.compare("blend", "expected depth", Floats{1.5f, 2.0f}, Floats{1.0f, 2.0f}, tight(1));
  EXPECT_EQ(read_npy(folder / "blend.expected_depth.device.npy").data, (Floats{1.5f, 2.0f}));
  EXPECT_EQ(read_npy(folder / "blend.expected_depth.cpu.npy").data, (Floats{1.0f, 2.0f}));
}

}  // namespace
}  // namespace aligngs::op_compare
