// The program's calls of cuBLASLt against its own kernels. A library on the host that goes by the words of the header
// replaces cuBLASLt. Nothing where the build has no such header.
#include "nn/cuda/emulation/host_cublas_lt.h"

#ifdef ALIGNGS_CUBLAS_LT

#include <cmath>
#include <type_traits>

#include "core/error.h"
#include "core/half.h"
#include "device/testing/device.h"
#include "nn/cuda/device_pool.h"
#include "nn/cuda/lt_products.h"
#include "nn/testing/weights.h"

namespace aligngs::cuda {
namespace {

using nn::Activation;

constexpr double kLimit = 2e-5;  // of the largest value: sums in another order

class HostLt : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    pool_ = std::make_shared<DevicePool>(0, 0);
    std::string reason;
    lt_ = CublasLt::start(host_cublas_lt(), reason);
    ASSERT_NE(lt_, nullptr) << reason;
    products_ = make_lt_products(*pool_, lt_);
  }
  HostCublasLt& library() { return host_cublas_lt_of(lt_->handle()); }
  LibraryProducts& products() { return *products_; }
  DevicePool& pool() { return *pool_; }

 private:
  std::shared_ptr<DevicePool> pool_;
  std::shared_ptr<CublasLt> lt_;
  std::unique_ptr<LibraryProducts> products_;
};

template <class T>
std::vector<T> operands(int64_t count, uint64_t seed) {
  const std::vector<float> values = nn::random_values(size_t(count), seed);
  std::vector<T> out;
  for (const float v : values) {
    if constexpr (std::is_same_v<T, float>) {
      out.push_back(v);
    } else {
      out.push_back(float_to_bfloat16(v));
    }
  }
  return out;
}

/// 9 rows of 32 inputs to 5 outputs; y may begin some floats after an aligned address.
template <class T>
struct Example {
  ProductSpans product;
  DeviceArray<T> x, w;
  DeviceArray<float> bias, y;

  Example(DeviceContext& context, bool has_bias, Activation activation, size_t skipped = 0, uint64_t bias_seed = 3) {
    x.assign(context, operands<T>(9 * 32, 1), "x");
    w.assign(context, operands<T>(5 * 32, 2), "w");
    bias.assign(context, operands<float>(5, bias_seed), "bias");
    y.resize(context, skipped + 45, "y");
    product = {9, 5, 32, has_bias ? bias.span().data : nullptr, activation, y.span().part(skipped, 45)};
  }
  DeviceSpan<const T> rows() const { return x.span(); }
  DeviceSpan<const T> weights() const { return w.span(); }
  bool taken_by(LibraryProducts& library) { return library.multiply(product, rows(), weights()); }
  std::vector<float> values(const DeviceContext& context) const {
    std::vector<float> out(45);
    download(context, out.data(), product.y);
    return out;
  }
  std::vector<float> own_values(const DeviceContext& context) {
    if constexpr (std::is_same_v<T, float>) {
      multiply_float(context, product, rows(), weights());
    } else {
      multiply_bf16(context, product, rows(), weights());
    }
    return values(context);
  }
};

double distance(const std::vector<float>& a, const std::vector<float>& b) {
  double most = 0, largest = 1e-30;
  for (size_t i = 0; i < b.size(); ++i) {
    const double d = std::abs(double(a[i]) - double(b[i]));
    if (!(d <= most)) most = std::isnan(d) ? INFINITY : d;
    largest = std::max(largest, std::abs(double(b[i])));
  }
  return most / largest;
}

template <class T>
void expect_the_own_product(LibraryProducts& library, DeviceContext& context) {
  for (const bool bias : {false, true}) {
    for (const Activation activation : {Activation::kNone, Activation::kRelu, Activation::kGelu, Activation::kSilu}) {
      Example<T> e(context, bias, activation);
      ASSERT_TRUE(e.taken_by(library));
      const std::vector<float> found = e.values(context);
      EXPECT_LT(distance(found, e.own_values(context)), kLimit) << int(activation) << bias;
    }
  }
}

TEST_F(HostLt, Float32ProductsAreTheOwnOnes) { expect_the_own_product<float>(products(), context()); }
TEST_F(HostLt, Bfloat16ProductsAreTheOwnOnes) { expect_the_own_product<uint16_t>(products(), context()); }

TEST_F(HostLt, AnAlgorithmIsChosenOncePerShapeTypeAndAlignment) {
  Example<float> first(context(), true, Activation::kNone), moved(context(), true, Activation::kNone, 1);
  Example<uint16_t> halves(context(), true, Activation::kNone);
  for (int repeat = 0; repeat < 3; ++repeat) ASSERT_TRUE(first.taken_by(products()));
  EXPECT_EQ(library().choices, 1);
  ASSERT_TRUE(moved.taken_by(products()));  // the library refuses addresses that it was promised otherwise
  EXPECT_EQ(library().choices, 2);
  ASSERT_TRUE(halves.taken_by(products()));
  EXPECT_EQ(library().choices, 3);
}

TEST_F(HostLt, EachProductHasItsOwnBiasThoughTheyShareAnAlgorithm) {
  // Both are there at once, so that their biases lie at different addresses.
  Example<float> first(context(), true, Activation::kNone, 0, 3), second(context(), true, Activation::kNone, 0, 4);
  for (Example<float>* e : {&first, &second}) {
    ASSERT_TRUE(e->taken_by(products()));
    const std::vector<float> found = e->values(context());
    EXPECT_LT(distance(found, e->own_values(context())), kLimit);
  }
  EXPECT_EQ(library().choices, 1);
}

TEST_F(HostLt, ScratchMemoryGoesBackToThePool) {
  Example<float> e(context(), false, Activation::kNone);
  ASSERT_TRUE(e.taken_by(products()));
  const uint64_t allocations = pool().context().allocations();
  for (int repeat = 0; repeat < 3; ++repeat) ASSERT_TRUE(e.taken_by(products()));
  EXPECT_EQ(pool().context().allocations(), allocations);
}

TEST_F(HostLt, AShapeWithoutAnAlgorithmIsRefusedAndNotAskedForAgain) {
  library().choice = CUBLAS_STATUS_NOT_SUPPORTED;
  Example<float> e(context(), false, Activation::kGelu);
  fill_zero(context(), e.product.y);
  EXPECT_FALSE(e.taken_by(products()));
  EXPECT_FALSE(e.taken_by(products()));
  EXPECT_EQ(library().choices, 1);
  EXPECT_EQ(e.values(context()), std::vector<float>(45, 0.0f));
}

TEST_F(HostLt, AProductThatTheDeviceDoesNotSupportIsRefusedBeforeItIsActivated) {
  library().product = CUBLAS_STATUS_NOT_SUPPORTED;
  Example<float> e(context(), true, Activation::kSilu);
  fill_zero(context(), e.product.y);
  EXPECT_FALSE(e.taken_by(products()));
  EXPECT_EQ(e.values(context()), std::vector<float>(45, 0.0f));
}

TEST_F(HostLt, EmptyProductsAreRefused) {
  Example<float> e(context(), false, Activation::kNone);
  e.product.rows = 0;
  EXPECT_FALSE(e.taken_by(products()));
  EXPECT_EQ(library().choices, 0);
}

TEST_F(HostLt, FailuresAreErrorsOfTheirKind) {
  const auto kind_of = [&](cublasStatus_t status) {
    library().product = status;
    Example<float> e(context(), false, Activation::kNone);
    try {
      (void)e.taken_by(products());
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::kUsage;  // none
  };
  EXPECT_EQ(kind_of(CUBLAS_STATUS_ALLOC_FAILED), ErrorKind::kResources);
  EXPECT_EQ(kind_of(CUBLAS_STATUS_EXECUTION_FAILED), ErrorKind::kFailed);
  EXPECT_EQ(kind_of(CUBLAS_STATUS_INVALID_VALUE), ErrorKind::kFailed);
}

}  // namespace
}  // namespace aligngs::cuda

#endif
