#include "train/sparse_floats.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace aligngs {
namespace {

std::string bytes_of(const std::vector<float>& floats) {
  return {reinterpret_cast<const char*>(floats.data()), floats.size() * sizeof(float)};
}

/// Mostly -9.25, with every kind of float among the others.
std::vector<float> scores() {
  std::vector<float> floats(1003, -9.25f);
  const float others[] = {0.0f, -0.0f, 1e-42f, std::numeric_limits<float>::infinity(), std::nanf("7"), -3.5f};
  for (size_t i = 0; i < floats.size(); i += 5) floats[i] = others[i % std::size(others)];
  return floats;
}

TEST(SparseFloats, ComeBackBitForBit) {
  const std::string before = bytes_of(scores());
  const auto sparse = sparse_floats(before);
  ASSERT_TRUE(sparse);
  EXPECT_EQ(sparse->bytes.size(), 126u + 4 * 201);
  EXPECT_LE(sparse->bytes.size(), most_sparse_bytes(1003));
  std::vector<uint8_t> after(before.size());
  ASSERT_TRUE(expand_sparse_floats(sparse->common, sparse->bytes, 1003, after.data()));
  EXPECT_EQ(std::memcmp(after.data(), before.data(), before.size()), 0);
}

TEST(SparseFloats, AreNotMadeOfFloatsThatDiffer) {
  std::vector<float> floats = scores();
  for (size_t i = 1; i < floats.size(); i += 10) floats[i] = static_cast<float>(i);
  EXPECT_FALSE(sparse_floats(bytes_of(floats))) << "three in ten differ";
}

TEST(SparseFloats, ThatDoNotFitTheCountAreRefused) {
  const std::string before = bytes_of(scores());
  const auto sparse = sparse_floats(before);
  std::vector<uint8_t> after(before.size() + 64);
  const std::string& bytes = sparse->bytes;
  EXPECT_FALSE(expand_sparse_floats(0, bytes.substr(0, bytes.size() - 4), 1003, after.data()));
  EXPECT_FALSE(expand_sparse_floats(0, bytes.substr(0, bytes.size() - 1), 1003, after.data()));
  EXPECT_FALSE(expand_sparse_floats(0, bytes + "1234", 1003, after.data()));
  EXPECT_FALSE(expand_sparse_floats(0, "", 1003, after.data()));
}

}  // namespace
}  // namespace aligngs
