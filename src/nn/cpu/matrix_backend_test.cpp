#include "nn/cpu/matrix_backend.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/half.h"
#include "nn/ops/linear.h"
#include "nn/testing/weights.h"

namespace aligngs::nn {
namespace {

std::vector<std::shared_ptr<MatrixBackend>> backends(Precision precision) {
  std::vector<std::shared_ptr<MatrixBackend>> all = {make_portable_backend(precision)};
  if (auto onednn = make_onednn_backend(precision)) all.push_back(onednn);
  return all;
}

/// Operands rounded as the precision says, sums in double.
std::vector<float> plain_product(const std::vector<float>& x, const std::vector<float>& w, int64_t rows,
                                 int64_t outputs, int64_t inputs, Precision precision) {
  const auto operand = [&](float v) {
    return precision == Precision::kFloat32 ? v : bfloat16_to_float(float_to_bfloat16(v));
  };
  std::vector<float> y;
  for (int64_t r = 0; r < rows; ++r) {
    for (int64_t o = 0; o < outputs; ++o) {
      double sum = 0;
      for (int64_t i = 0; i < inputs; ++i)
        sum += double(operand(x[size_t(r * inputs + i)])) * double(operand(w[size_t(o * inputs + i)]));
      y.push_back(float(sum));
    }
  }
  return y;
}

TEST(MatrixBackend, EveryBackendMultiplies) {
  Scratch scratch;
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    for (const auto& backend : backends(precision)) {
      for (const auto& [rows, outputs, inputs] :
           {std::tuple<int64_t, int64_t, int64_t>{1, 1, 1}, {3, 17, 5}, {16, 16, 32}, {37, 33, 70}, {130, 48, 9}}) {
        const std::vector<float> x = random_values(size_t(rows * inputs), 1);
        const std::vector<float> w = random_values(size_t(outputs * inputs), 2);
        std::vector<float> y(size_t(rows * outputs));
        backend->pack(w.data(), outputs, inputs)->multiply(x.data(), rows, y.data(), scratch);
        const std::vector<float> expected = plain_product(x, w, rows, outputs, inputs, precision);
        for (size_t i = 0; i < y.size(); ++i) {
          ASSERT_NEAR(y[i], expected[i], 2e-5f)
              << backend->name() << " " << rows << " x " << inputs << " x " << outputs << " at " << i;
        }
      }
    }
  }
}

TEST(MatrixBackend, TheNumberOfThreadsChangesNoBit) {
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
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
