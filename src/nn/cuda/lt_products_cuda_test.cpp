// cuBLASLt against the program's own kernels, on a device.
#include <cmath>

#include "core/half.h"
#include "device/testing/device.h"
#include "device/tolerances.h"
#include "nn/cuda/cublas_lt.h"
#include "nn/cuda/device_pool.h"
#include "nn/cuda/lt_products.h"
#include "nn/testing/weights.h"

namespace aligngs::cuda {
namespace {

#ifdef ALIGNGS_CUBLAS_LT
TEST(CublasLt, EveryFunctionIsInTheLibraryAndAnotherNameIsNoLibrary) {
  const CublasLtLibrary absent = load_cublas_lt({"libaligngs-has-no-such-library.so.7", "libm.so.6"});
  EXPECT_EQ(absent.loaded, nullptr);
  EXPECT_NE(absent.reason.find("libm.so.6: it has no cublasLt"), std::string::npos) << absent.reason;
  const CublasLtLibrary found = load_cublas_lt(cublas_lt_names());
  if (found.loaded == nullptr) GTEST_SKIP() << found.reason;
  EXPECT_EQ(found.functions.get_version() / 10000, size_t(CUBLAS_VER_MAJOR));
  EXPECT_NE(found.functions.multiply, nullptr);
}
#endif

struct Case {
  int64_t rows, outputs, depth;
  bool bias;
  nn::Activation activation;
  int64_t skipped = 0;  ///< floats before y, which move it off its alignment
};

const std::vector<Case>& cases() {
  using nn::Activation;
  static const std::vector<Case> list{
      {1041, 3072, 1024, true, Activation::kNone},  // a block of VGGT on one view
      {1041, 4096, 1024, true, Activation::kGelu}, {1041, 1024, 4096, false, Activation::kNone},
      {70, 33, 96, true, Activation::kRelu},       {70, 33, 96, false, Activation::kRelu},
      {37, 70, 64, true, Activation::kSilu},       {37, 71, 64, true, Activation::kNone, 3},
      {1, 1, 32, true, Activation::kNone}};
  return list;
}

class LtProductsTest : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    if (IsSkipped()) return;
    pool_ = std::make_shared<DevicePool>(test_device().index, 0);
    LibraryStart start = start_lt_products(*pool_);
    if (start.products == nullptr) GTEST_SKIP() << (kEmulated ? "the emulation has no cuBLASLt" : start.reason);
    library_ = std::move(start.products);
  }

  void own_product(const ProductSpans& p, DeviceSpan<const float> x, DeviceSpan<const float> w) {
    multiply_float(pool_->context(), p, x, w);
  }
  void own_product(const ProductSpans& p, DeviceSpan<const uint16_t> x, DeviceSpan<const uint16_t> w) {
    multiply_bf16(pool_->context(), p, x, w);
  }

  /// Largest difference of the library's and the own product, in parts of the largest value. Infinite if refused, or if
  /// a second product has other bits.
  template <class T>
  double distance(const Case& c, const std::vector<T>& x_values, const std::vector<T>& w_values) {
    const size_t count = size_t(c.rows * c.outputs);
    DeviceArray<T> x, w;
    DeviceArray<float> bias, y;
    DeviceContext& on = pool_->context();
    x.assign(on, x_values, "x");
    w.assign(on, w_values, "w");
    bias.assign(on, nn::random_values(size_t(c.outputs), 3), "bias");
    y.resize(on, count + size_t(c.skipped), "y");
    ProductSpans p{c.rows,       c.outputs,
                   c.depth,      c.bias ? bias.span().data : nullptr,
                   c.activation, y.span().part(size_t(c.skipped), count)};
    const auto result = [&] {
      std::vector<float> values(count);
      download(on, values.data(), p.y);
      fill_zero(on, p.y);
      return values;
    };
    const DeviceSpan<const T> rows = x.span(), weights = w.span();
    own_product(p, rows, weights);
    const std::vector<float> expected = result();
    if (!library_->multiply(p, rows, weights)) return INFINITY;
    const std::vector<float> found = result();
    if (!library_->multiply(p, rows, weights) || result() != found) return INFINITY;
    double most = 0, largest = 1e-30;
    for (size_t i = 0; i < count; ++i) {
      const double d = std::abs(double(found[i]) - double(expected[i]));
      if (!(d <= most)) most = std::isnan(d) ? INFINITY : d;
      largest = std::max(largest, std::abs(double(expected[i])));
    }
    return most / largest;
  }

 private:
  std::shared_ptr<DevicePool> pool_;
  std::unique_ptr<LibraryProducts> library_;
};

TEST_F(LtProductsTest, Float32IsTheOwnProductWithSumsInAnotherOrder) {
  for (const Case& c : cases()) {
    const auto x = nn::random_values(size_t(c.rows * c.depth), 1),
               w = nn::random_values(size_t(c.outputs * c.depth), 2);
    EXPECT_LT(distance(c, x, w), CudaNetworkTolerance().single) << c.rows << " x " << c.outputs;
  }
}

TEST_F(LtProductsTest, Bfloat16OperandsAreSummedInFloat32) {
  const auto rounded = [](const std::vector<float>& values) {
    std::vector<uint16_t> out;
    for (const float v : values) out.push_back(float_to_bfloat16(v));
    return out;
  };
  for (const Case& c : cases()) {
    const auto x = rounded(nn::random_values(size_t(c.rows * c.depth), 1));
    const auto w = rounded(nn::random_values(size_t(c.outputs * c.depth), 2));
    EXPECT_LT(distance(c, x, w), CudaNetworkTolerance().rounded) << c.rows << " x " << c.outputs;
  }
}

}  // namespace
}  // namespace aligngs::cuda
