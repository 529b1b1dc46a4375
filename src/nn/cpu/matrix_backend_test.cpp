#include "nn/cpu/matrix_backend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/half.h"
#include "nn/ops/linear.h"
#include "nn/testing/vector_limit.h"
#include "nn/testing/weights.h"

namespace aligngs::nn {
namespace {

std::vector<std::shared_ptr<MatrixBackend>> backends(Precision precision) {
  std::vector<std::shared_ptr<MatrixBackend>> all = {make_vector_backend(precision)};
  if (precision != Precision::kBfloat16) return all;
  if (auto onednn = make_onednn_backend()) all.push_back(onednn);
  return all;
}

float weight_of(float v, Precision precision) {
  switch (precision) {
    case Precision::kBfloat16:
      return bfloat16_to_float(float_to_bfloat16(v));
    case Precision::kFloat16:
      return half_to_float(float_to_half(v));
    case Precision::kFloat32:
      break;
  }
  return v;
}

/// Operands rounded as the precision says, sums in double.
std::vector<float> plain_product(const std::vector<float>& x, const std::vector<float>& w, int64_t rows,
                                 int64_t outputs, int64_t inputs, Precision precision) {
  const auto operand = [&](float v) { return precision == Precision::kBfloat16 ? weight_of(v, precision) : v; };
  std::vector<float> y;
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t o = 0; o < outputs; ++o) {
      double sum = 0;
      for (int64_t i = 0; i < inputs; ++i)
        sum += double(operand(x[size_t(r * inputs + i)])) * double(weight_of(w[size_t(o * inputs + i)], precision));
      y.push_back(float(sum));
    }
  }
  return y;
}

/// Panels that fill none, one and several tiles of rows and of columns, and inputs of one and several blocks.
constexpr std::tuple<int64_t, int64_t, int64_t> kProducts[] = {
    {1, 1, 1}, {3, 17, 5}, {16, 16, 32}, {37, 33, 70}, {130, 48, 9}, {23, 300, 64}, {14, 40, 512}, {25, 64, 700}};

void expect_product(const MatrixBackend& backend, int64_t rows, int64_t outputs, int64_t inputs, Precision precision) {
  Scratch scratch;
  const std::vector<float> x = random_values(size_t(rows * inputs), 1);
  const std::vector<float> w = random_values(size_t(outputs * inputs), 2);
  std::vector<float> y(size_t(rows * outputs));
  backend.pack(w.data(), outputs, inputs)->multiply(x.data(), rows, y.data(), scratch);
  const std::vector<float> expected = plain_product(x, w, rows, outputs, inputs, precision);
  const float tolerance = std::max(2e-5f, 1.5e-7f * float(inputs));  // sums of products of about one
  for (size_t i = 0; i < y.size(); ++i) {
    ASSERT_NEAR(y[i], expected[i], tolerance) << backend.name() << ", " << word_of(precision) << ": " << rows << " x "
                                              << inputs << " x " << outputs << " at " << i;
  }
}

TEST(MatrixBackend, EveryBackendMultiplies) {
  for (const auto& [precision, word] : kChoiceWords<Precision>) {
    for (const auto& backend : backends(precision)) {
      for (const auto& [rows, outputs, inputs] : kProducts) expect_product(*backend, rows, outputs, inputs, precision);
    }
  }
}

TEST(MatrixBackend, EveryVectorWidthMultiplies) {
  for (const int64_t target : vector_targets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    const VectorLimit limit(target);
    for (const auto& [precision, word] : kChoiceWords<Precision>) {
      const auto backend = make_vector_backend(precision);
      for (const auto& [rows, outputs, inputs] : kProducts) expect_product(*backend, rows, outputs, inputs, precision);
    }
  }
}

TEST(MatrixBackend, WeightsBeyondFloat16StayFloat32) {
  const auto backend = make_vector_backend(Precision::kFloat16);
  const float large[] = {65504, 1}, larger[] = {65536, 1};
  EXPECT_EQ(backend->pack(large, 1, 2)->precision(), Precision::kFloat16);
  const auto packed = backend->pack(larger, 1, 2);
  EXPECT_EQ(packed->precision(), Precision::kFloat32);
  Scratch scratch;
  const float x[] = {2, 3};
  float y = 0;
  packed->multiply(x, 1, &y, scratch);
  EXPECT_EQ(y, 2 * 65536 + 3);
}

TEST(MatrixBackend, WeightsOfSixteenBitsTakeHalfTheMemory) {
  const std::vector<float> w(64 * 32);
  const size_t whole = make_vector_backend(Precision::kFloat32)->pack(w.data(), 64, 32)->bytes();
  for (const Precision precision : {Precision::kBfloat16, Precision::kFloat16})
    EXPECT_EQ(2 * make_vector_backend(precision)->pack(w.data(), 64, 32)->bytes(), whole);
}

TEST(MatrixBackend, TheNumberOfThreadsChangesNoBit) {
  for (const auto& [precision, word] : kChoiceWords<Precision>) {
    std::vector<std::vector<float>> results;
    for (const int threads : {1, 2, 5}) {
      ThreadPool pool(threads);
      Compute compute(pool, {precision, true, true});
      const Linear linear(compute, random_values(40 * 24), 40, 24, random_values(40));
      Matrix x(1000, 24);
      x.data = random_values(x.data.size());
      results.push_back(linear(compute, x, Activation::kGelu).data);
    }
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
  }
}

TEST(ProductRows, AreEvenSharesOfWholeTiles) {
  EXPECT_EQ(product_rows(1, 8), 24);
  EXPECT_EQ(product_rows(1029, 2), 264);   // two for each thread
  EXPECT_EQ(product_rows(1029, 8), 144);   // one for each
  EXPECT_EQ(product_rows(10412, 8), 264);  // five for each
  EXPECT_EQ(product_rows(200, 8), 120);    // two in all: shorter ones would pass the weights too often
}

TEST(MatrixBackend, ARowOfTheVectorKernelsDoesNotDependOnTheOthers) {
  Scratch scratch;
  constexpr int64_t kRows = 29, kInputs = 530, kOutputs = 40;
  const std::vector<float> x = random_values(kRows * kInputs, 1), w = random_values(kOutputs * kInputs, 2);
  for (const int64_t target : vector_targets()) {
    const VectorLimit limit(target);
    for (const auto& [precision, word] : kChoiceWords<Precision>) {
      const auto packed = make_vector_backend(precision)->pack(w.data(), kOutputs, kInputs);
      std::vector<float> together(kRows * kOutputs), alone(kOutputs);
      packed->multiply(x.data(), kRows, together.data(), scratch);
      for (int64_t r = 0; r < kRows; ++r) {
        packed->multiply(x.data() + r * kInputs, 1, alone.data(), scratch);
        EXPECT_TRUE(std::equal(alone.begin(), alone.end(), together.begin() + r * kOutputs))
            << hwy::TargetName(target) << ", " << word_of(precision) << ", row " << r;
      }
    }
  }
}

TEST(Compute, CountsTheOperationsOfProducts) {
  ThreadPool pool(2);
  Compute compute(pool);
  const Linear linear(compute, random_values(8 * 4), 8, 4, {});
  Matrix x(500, 4);
  linear(compute, x);
  EXPECT_EQ(compute.operations(), 2.0 * 500 * 8 * 4);
}

TEST(Scratch, BuffersTakenInAFrameAreReused) {
  Scratch scratch;
  void* first;
  {
    const Scratch::Frame frame(scratch);
    first = scratch.bytes(1000);
    EXPECT_NE(scratch.bytes(1000), first);
  }
  EXPECT_EQ(scratch.bytes(500), first);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(first) % 64, 0u);
}

}  // namespace
}  // namespace aligngs::nn
