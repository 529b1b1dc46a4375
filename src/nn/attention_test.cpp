#include "nn/attention.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "nn/tensor.h"
#include "nn/testing/vector_limit.h"
#include "nn/testing/weights.h"

namespace aligngs::nn {
namespace {

struct Inputs {
  AttentionShape shape;
  std::vector<float> q, k, v;

  explicit Inputs(const AttentionShape& s) : shape(s) {
    const size_t row = size_t(s.heads * s.head_dim);
    q = random_values(size_t(s.sequences * s.queries) * row, 1);
    k = random_values(size_t(s.sequences * s.keys) * row, 2);
    v = random_values(size_t(s.sequences * s.keys) * row, 3);
  }
  int64_t width() const { return shape.heads * shape.head_dim; }

  std::vector<float> blocked(Compute& compute, const uint8_t* masked = nullptr) const {
    AttentionOperands operands(compute, shape);
    for (int64_t s = 0; s < shape.sequences; ++s) {
      for (int64_t i = 0; i < shape.queries; ++i)
        operands.set_query_row(s, i, q.data() + (s * shape.queries + i) * width());
      for (int64_t i = 0; i < shape.keys; ++i) {
        operands.set_key_row(s, i, k.data() + (s * shape.keys + i) * width());
        operands.set_value_row(s, i, v.data() + (s * shape.keys + i) * width());
      }
    }
    std::vector<float> out(q.size());
    attention(compute, operands, out.data(), masked);
    return out;
  }

  /// softmax(q k^T / sqrt(d)) v in double, the whole row of scores at once.
  std::vector<float> plain(const uint8_t* masked = nullptr) const {
    std::vector<float> out(q.size());
    for (int64_t s = 0; s < shape.sequences; ++s) {
      for (int64_t h = 0; h < shape.heads; ++h) {
        for (int64_t i = 0; i < shape.queries; ++i) {
          const int64_t at = (s * shape.queries + i) * width() + h * shape.head_dim;
          std::vector<double> weight(size_t(shape.keys), 0.0);
          double total = 0;
          for (int64_t j = 0; j < shape.keys; ++j) {
            if (masked && masked[(s * shape.queries + i) * shape.keys + j]) continue;
            double score = 0;
            const int64_t key = (s * shape.keys + j) * width() + h * shape.head_dim;
            for (int64_t d = 0; d < shape.head_dim; ++d)
              score += double(q[size_t(at + d)]) * double(k[size_t(key + d)]);
            weight[size_t(j)] = std::exp(score / std::sqrt(double(shape.head_dim)));
            total += weight[size_t(j)];
          }
          for (int64_t d = 0; d < shape.head_dim; ++d) {
            double sum = 0;
            for (int64_t j = 0; j < shape.keys; ++j) {
              sum += weight[size_t(j)] * double(v[size_t((s * shape.keys + j) * width() + h * shape.head_dim + d)]);
            }
            out[size_t(at + d)] = float(sum / total);
          }
        }
      }
    }
    return out;
  }
};

void expect_near(const std::vector<float>& a, const std::vector<float>& b, float tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], tolerance) << i;
}

// Lengths on both sides of the block sizes: 16, 32, 64 and 256.
const AttentionShape kShapes[] = {{1, 1, 64, 1, 1},   {2, 3, 16, 17, 31}, {1, 2, 64, 33, 257},
                                  {1, 1, 8, 70, 512}, {1, 2, 80, 5, 40},  {1, 1, 64, 300, 600}};

TEST(Attention, Float32IsItsDefinition) {
  ThreadPool pool(2);
  Compute compute(pool);
  for (const AttentionShape& shape : kShapes) {
    const Inputs inputs(shape);
    expect_near(inputs.blocked(compute), inputs.plain(), 2e-6f);
  }
}

TEST(Attention, EveryVectorWidthIsNear) {
  ThreadPool pool(2);
  for (const int64_t target : vector_targets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    const VectorLimit limit(target);
    Compute compute(pool);
    for (const AttentionShape& shape : kShapes) {
      const Inputs inputs(shape);
      expect_near(inputs.blocked(compute), inputs.plain(), 2e-6f);
    }
  }
}

TEST(Attention, Bfloat16IsNear) {
  ThreadPool pool(2);
  for (const bool amx : {true, false}) {
    Compute compute(pool, {Precision::kBfloat16, true, amx});
    for (const AttentionShape& shape : kShapes) {
      const Inputs inputs(shape);
      expect_near(inputs.blocked(compute), inputs.plain(), 0.05f);
    }
  }
}

TEST(Attention, MaskedKeysDoNotCount) {
  ThreadPool pool(2);
  AttentionShape shape{2, 2, 16, 19, 300};
  shape.masks = 1;
  const Inputs inputs(shape);
  std::vector<uint8_t> masked(size_t(shape.sequences * shape.queries * shape.keys));
  Random random(5);
  for (uint8_t& m : masked) m = random.chance(0.9);
  for (int64_t i = 0; i < shape.sequences * shape.queries; ++i)
    masked[size_t(i * shape.keys + shape.keys - 1)] = 0;  // one is left, the last one
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    Compute compute(pool, {precision, true, true});
    expect_near(inputs.blocked(compute, masked.data()), inputs.plain(masked.data()), 2e-6f);
  }
}

TEST(Attention, AMaskIsGivenExactlyWhenTheShapeSaysSo) {
  ThreadPool pool(1);
  Compute compute(pool);
  const Inputs inputs({1, 1, 16, 4, 4});
  const std::vector<uint8_t> masked(16);
  EXPECT_THROW(inputs.blocked(compute, masked.data()), Error);
}

TEST(Attention, LargeScoresDoNotOverflow) {
  ThreadPool pool(1);
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    Compute compute(pool, {precision, true, true});
    Inputs inputs({1, 1, 64, 3, 40});
    std::vector<float> wanted;  // each query is a key of its own, by thousands ahead of the others: that key's value
    for (size_t i = 0; i < inputs.q.size(); ++i) {
      const size_t key = 11 * (i / 64) + 5, at = key * 64 + i % 64;
      inputs.q[i] = 1000 * inputs.k[at];
      wanted.push_back(inputs.v[at]);
    }
    expect_near(inputs.blocked(compute), wanted, precision == Precision::kFloat32 ? 1e-6f : 0.02f);
  }
}

TEST(Attention, TheNumberOfThreadsChangesNoBit) {
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    const Inputs inputs({2, 3, 64, 270, 290});
    ThreadPool one(1), three(3);
    Compute a(one, {precision, true, true}), b(three, {precision, true, true});
    EXPECT_EQ(inputs.blocked(a), inputs.blocked(b));
  }
}

}  // namespace
}  // namespace aligngs::nn
