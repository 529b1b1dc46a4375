// Operators of networks on a device against those of the CPU. Whole networks: the parity cases (tests/cuda).
#include <cmath>

#include "core/error.h"
#include "device/testing/device.h"
#include "device/tolerances.h"
#include "nn/attention.h"
#include "nn/cuda/network_device.h"
#include "nn/ops/blocks.h"
#include "nn/ops/convolution.h"
#include "nn/ops/linear.h"
#include "nn/testing/weights.h"
#include "nn/transformer_block.h"

namespace aligngs {
namespace {

using nn::Compute;
using nn::ComputeOptions;
using nn::Matrix;
using nn::Precision;
using nn::Values;

const cuda::CudaNetworkTolerance kNetworkTolerance;

class CudaNetworks : public cuda::DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    if (!IsSkipped()) device_ = make_cuda_network_device(context().device());
  }
  Compute on_cpu() { return Compute(pool_, {Precision::kFloat32, false, false}); }
  Compute on_device(Precision precision) { return Compute(pool_, {precision, false, false, device_}); }
  nn::NetworkDevice& device() { return *device_; }

 private:
  ThreadPool pool_{2};
  std::shared_ptr<nn::NetworkDevice> device_;
};

Matrix random_matrix(int64_t rows, int64_t columns, uint64_t seed) {
  Matrix m(rows, columns);
  m.data = nn::random_values(size_t(rows * columns), seed);
  return m;
}

double distance(const Values& found, const Values& expected) {
  if (found.size() != expected.size()) return INFINITY;
  const float *a = found.data(), *b = expected.data();
  double most = 0, largest = 1e-30;
  for (size_t i = 0; i < found.size(); ++i) {
    const double d = std::abs(double(a[i]) - double(b[i]));
    if (!(d <= most)) most = std::isnan(d) ? INFINITY : d;
    largest = std::max(largest, std::abs(double(b[i])));
  }
  return most / largest;
}

TEST_F(CudaNetworks, ProductsOfAnySizeWithBiasAndActivation) {
  struct Size {
    int64_t rows, inputs, outputs;
  };
  for (const Size& s : {Size{37, 45, 70}, Size{1, 1, 1}, Size{64, 64, 64}, Size{1030, 17, 1030}}) {
    const Matrix x = random_matrix(s.rows, s.inputs, 1);
    const std::vector<float> w = nn::random_values(size_t(s.inputs * s.outputs), 2),
                             b = nn::random_values(size_t(s.outputs), 3);
    Compute cpu = on_cpu();
    const Matrix expected = nn::Linear(cpu, w, s.outputs, s.inputs, b)(cpu, x, nn::Activation::kGelu);
    for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
      Compute compute = on_device(precision);
      const Matrix found = nn::Linear(compute, w, s.outputs, s.inputs, b)(compute, x, nn::Activation::kGelu);
      EXPECT_LT(distance(found.data, expected.data),
                precision == Precision::kFloat32 ? kNetworkTolerance.single : kNetworkTolerance.bfloat16)
          << s.rows;
    }
  }
}

TEST_F(CudaNetworks, ProductsDoNotDependOnTheOrderOfThreads) {
  const Matrix x = random_matrix(40, 70, 1);
  const std::vector<float> w = nn::random_values(70 * 33, 2);
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    Compute compute = on_device(precision);
    const nn::Linear linear(compute, w, 33, 70, {});
    const Matrix first = linear(compute, x);
    cuda::for_each_thread_order([&] { EXPECT_TRUE(linear(compute, x).data == first.data); });
  }
}

TEST_F(CudaNetworks, WeightsMultiplyRowsOfTheHostAsWell) {
  const Matrix x = random_matrix(5, 33, 1);
  const std::vector<float> w = nn::random_values(33 * 7, 2);
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    Compute compute = on_device(precision);
    const nn::Linear linear(compute, w, 7, 33, {});
    Matrix y(5, 7);
    linear.product(x.row(0), 5, y.row(0), compute.scratch(0));
    EXPECT_LT(distance(y.data, linear(compute, x).data), kNetworkTolerance.same_path);
  }
}

/// Inputs of attention, and what the CPU makes of them in float32.
struct AttentionCase {
  nn::AttentionShape shape;
  Values q, k, v;
  std::vector<uint8_t> masked;

  explicit AttentionCase(const nn::AttentionShape& s) : shape(s) {
    const int64_t width = s.heads * s.head_dim;
    q = nn::random_values(size_t(s.sequences * s.queries * width), 1);
    k = nn::random_values(size_t(s.sequences * s.keys * width), 2);
    v = nn::random_values(size_t(s.sequences * s.keys * width), 3);
    masked.resize(size_t(s.sequences * s.masks * s.queries * s.keys));
    for (size_t i = 0; i < masked.size(); ++i) masked[i] = i % size_t(s.keys) != 0 && i * 7 % 3 == 0;
  }
  int64_t width() const { return shape.heads * shape.head_dim; }
  const uint8_t* mask() const { return masked.empty() ? nullptr : masked.data(); }
  Values expected(Compute& cpu) const {
    nn::AttentionOperands operands(cpu, shape);
    for (int64_t s = 0; s < shape.sequences; ++s) {
      for (int64_t i = 0; i < shape.queries; ++i)
        operands.set_query_row(s, i, q.data() + (s * shape.queries + i) * width());
      for (int64_t i = 0; i < shape.keys; ++i) {
        operands.set_key_row(s, i, k.data() + (s * shape.keys + i) * width());
        operands.set_value_row(s, i, v.data() + (s * shape.keys + i) * width());
      }
    }
    Values out(q.size());
    nn::attention(cpu, operands, out.data(), mask());
    return out;
  }
  Values found(nn::NetworkDevice& d, Precision precision) const {
    Values out(q.size());
    d.attention(shape, {q.on(d), width()}, {k.on(d), width()}, {v.on(d), width()}, mask(), precision, out.write_on(d));
    return out;
  }
};

TEST_F(CudaNetworks, AttentionNeverFormsTheScoresAndMatchesTheCpu) {
  Compute cpu = on_cpu();
  for (const int64_t dim : {12, 32, 64, 128}) {
    const AttentionCase c({2, 2, dim, 70, 131, 0});
    const Values expected = c.expected(cpu);
    EXPECT_LT(distance(c.found(device(), Precision::kFloat32), expected), kNetworkTolerance.single) << dim;
    EXPECT_LT(distance(c.found(device(), Precision::kBfloat16), expected), kNetworkTolerance.bfloat16) << dim;
  }
  const AttentionCase one({1, 1, 16, 1, 1, 0});
  EXPECT_LT(distance(one.found(device(), Precision::kBfloat16), one.expected(cpu)), kNetworkTolerance.bfloat16);
}

TEST_F(CudaNetworks, AttentionDoesNotDependOnTheOrderOfThreads) {
  const AttentionCase c({1, 2, 16, 20, 70, 0});
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    const Values first = c.found(device(), precision);
    cuda::for_each_thread_order([&] { EXPECT_TRUE(c.found(device(), precision) == first); });
  }
}

TEST_F(CudaNetworks, MaskedAttentionIsExactWhateverThePrecision) {
  Compute cpu = on_cpu();
  for (const int64_t masks : {1, 2}) {
    const AttentionCase c({2, 2, 8, 9, 50, masks});
    EXPECT_LT(distance(c.found(device(), Precision::kBfloat16), c.expected(cpu)), kNetworkTolerance.single) << masks;
  }
}

TEST_F(CudaNetworks, AMaskAgainstTheShapeAndTooWideHeadsAreErrors) {
  AttentionCase c({1, 1, 4, 2, 3, 1});
  c.masked.clear();
  EXPECT_THROW((void)c.found(device(), Precision::kFloat32), Error);
  EXPECT_THROW((void)AttentionCase({1, 1, 512, 2, 3, 0}).found(device(), Precision::kFloat32), Error);
}

TEST_F(CudaNetworks, ConvolutionsWithStridePaddingAndRectifiedInput) {
  nn::FeatureMap x(7, 9, 5);
  x.data = nn::random_values(x.data.size(), 1);
  const std::vector<float> w = nn::random_values(6 * 5 * 9, 2), b = nn::random_values(6, 3);
  const nn::ConvolutionShape shape{6, 5, 3, 2, 1};
  Compute cpu = on_cpu();
  const nn::FeatureMap expected = nn::Convolution(cpu, shape, w, b)(cpu, x, {true, nn::Activation::kSilu});
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    Compute compute = on_device(precision);
    const nn::FeatureMap found = nn::Convolution(compute, shape, w, b)(compute, x, {true, nn::Activation::kSilu});
    EXPECT_LT(distance(found.data, expected.data),
              precision == Precision::kFloat32 ? kNetworkTolerance.single : kNetworkTolerance.bfloat16);
  }
}

TEST_F(CudaNetworks, PoolingMatchesToTheBit) {
  nn::FeatureMap x(7, 9, 3);
  x.data = nn::random_values(x.data.size(), 1);
  Compute cpu = on_cpu(), compute = on_device(Precision::kFloat32);
  EXPECT_TRUE(nn::max_pool_3x3_stride_2(compute, x).data == nn::max_pool_3x3_stride_2(cpu, x).data);
  EXPECT_TRUE(nn::max_pool_2x2(compute, x).data == nn::max_pool_2x2(cpu, x).data);
}

TEST_F(CudaNetworks, TensorsStayWhereTheyWereWrittenUntilSomeoneLooks) {
  Values x{1, 2, 3}, sum(3);
  EXPECT_EQ(x.where(), nullptr);
  (void)x.on(device());
  EXPECT_EQ(x.where(), nullptr);  // both have it
  sum.change_on(device());        // zeros there
  nn::add_values(sum, x);
  EXPECT_EQ(sum.where(), &device());
  const Values copy = sum;
  EXPECT_EQ(copy.where(), &device());
  EXPECT_TRUE(copy == Values({1, 2, 3}));  // looks
  EXPECT_EQ(copy.where(), nullptr);
  sum[1] = 7;  // the device's copy is out of date
  nn::add_values(sum, x);
  EXPECT_TRUE(sum == Values({2, 9, 6}));
}

TEST_F(CudaNetworks, ATensorOutlivesWhoeverMadeItsDevice) {
  auto own = make_cuda_network_device(context().device());
  Values x{1, 2};
  nn::add_values(x, Values{1, 1});
  x.change_on(*own);
  own.reset();
  EXPECT_TRUE(x == Values({2, 3}));
}

TEST_F(CudaNetworks, BlocksAreCopiedAndAddedWhereTheyAre) {
  const Values from{1, 2, 3, 4, 5, 6};
  Values there(8), here(8);
  there.change_on(device());
  for (Values* to : {&there, &here}) {
    nn::copy_block(*to, {1, 4}, from, {0, 3}, 2, 2);
    nn::add_block(*to, {1, 4}, from, {1, 3}, 2, 2);
  }
  EXPECT_TRUE(there == here);
  EXPECT_TRUE(here == Values({0, 3, 5, 0, 0, 9, 11, 0}));
}

TEST_F(CudaNetworks, ADeviceThatIsFullIsAnError) {
  const auto small = make_cuda_network_device(context().device(), 4096);
  auto kept = small->allocate(256);
  EXPECT_THROW((void)small->allocate(1024), Error);
  kept.reset();  // given back pieces make room for one of another size
  EXPECT_NE(small->allocate(900), nullptr);
}

}  // namespace
}  // namespace aligngs
