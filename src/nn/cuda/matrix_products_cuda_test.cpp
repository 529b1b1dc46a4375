#include "nn/cuda/matrix_products.h"

#include <gmock/gmock.h>

#include <cmath>
#include <utility>

#include "device/testing/device.h"
#include "nn/cuda/device_pool.h"
#include "nn/cuda/lt_products.h"

namespace aligngs::cuda {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;

/// Takes products of float32 only, counts them, and leaves y alone.
class CountingLibrary : public LibraryProducts {
 public:
  explicit CountingLibrary(int& count) : count_(count) {}
  std::string name() const override { return "a library for tests"; }
  bool multiply(const ProductSpans&, DeviceSpan<const uint16_t>, DeviceSpan<const uint16_t>) override { return false; }
  bool multiply(const ProductSpans&, DeviceSpan<const float>, DeviceSpan<const float>) override {
    ++count_;
    return true;
  }

 private:
  int& count_;
};

constexpr uint16_t kHalfTwo = 0x4000;  // 2 in bfloat16
constexpr float kUntouched = -7.0f;

/// One row of 32 twos times 3 weights of 32 twos: 128 each.
class MatrixProductsTest : public DeviceTest {
 protected:
  void SetUp() override {
    DeviceTest::SetUp();
    if (IsSkipped()) return;
    floats_.assign(context(), std::vector<float>(96, 2.0f), "operands");
    halves_.assign(context(), std::vector<uint16_t>(96, kHalfTwo), "operands");
    y_.assign(context(), std::vector<float>(3, kUntouched), "results");
  }
  template <class T>
  std::vector<float> found(MatrixProducts& products, DeviceArray<T>& twos) {
    const ProductSpans product{1, 3, kDepthStep, nullptr, nn::Activation::kNone, y_.span()};
    const DeviceSpan<const T> operands = std::as_const(twos).span();
    products.multiply(product, operands.part(0, 32), operands);
    return y_.to_host();
  }
  std::vector<float> found_in_float32(MatrixProducts& products) { return found(products, floats_); }
  std::vector<float> found_in_bfloat16(MatrixProducts& products) { return found(products, halves_); }

 private:
  DeviceArray<float> floats_, y_;
  DeviceArray<uint16_t> halves_;
};

TEST_F(MatrixProductsTest, WithoutALibraryTheProgramsOwnKernelsFormAll) {
  MatrixProducts products(context(), {});
  EXPECT_THAT(found_in_float32(products), Each(128.0f));
  EXPECT_THAT(found_in_bfloat16(products), Each(128.0f));
}

TEST_F(MatrixProductsTest, ALibraryFormsWhatItTakesAndTheOwnKernelsTheRest) {
  int taken = 0;
  MatrixProducts products(context(), {std::make_unique<CountingLibrary>(taken), {}});
  EXPECT_THAT(found_in_float32(products), Each(kUntouched));
  EXPECT_EQ(taken, 1);
  EXPECT_THAT(found_in_bfloat16(products), Each(128.0f));
  EXPECT_EQ(taken, 1);
}

TEST_F(MatrixProductsTest, AMissingLibraryIsSaidOnce) {
  testing::internal::CaptureStderr();
  MatrixProducts products(context(), {nullptr, "libx.so is not there"});
  (void)found_in_float32(products);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, HasSubstr("libx.so is not there"));
  EXPECT_EQ(said.find("own kernels"), said.rfind("own kernels"));
}

TEST_F(MatrixProductsTest, ARefusedProductIsSaidOnce) {
  int taken = 0;
  MatrixProducts products(context(), {std::make_unique<CountingLibrary>(taken), {}});
  testing::internal::CaptureStderr();
  (void)found_in_bfloat16(products);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("a library for tests takes no product of 1 x 32 with 32 x 3"));
  testing::internal::CaptureStderr();
  (void)found_in_bfloat16(products);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
}

TEST_F(MatrixProductsTest, TheEmulationHasNoLibraryAndSaysNothingOfIt) {
  if (!kEmulated) GTEST_SKIP() << "for the emulation";
  const auto pool = std::make_shared<DevicePool>(context().device(), 0);
  const LibraryStart start = start_lt_products(*pool);
  EXPECT_EQ(start.products, nullptr);
  EXPECT_EQ(start.reason, "");
}

}  // namespace
}  // namespace aligngs::cuda
