// How far the vector functions are from the true values, with every instruction set of this machine. The bounds are
// those that their comments state.
#include "engine/cpu/testing/each_instruction_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/simd_math_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/simd_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

template <class Function>
void evaluate(const std::vector<float>& in, std::vector<float>& out, Function function) {
  const FloatTag d;
  for (size_t i = 0; i < in.size(); i += kLanes)
    hn::StoreU(function(d, hn::LoadU(d, in.data() + i)), d, out.data() + i);
}

/// `in` holds a multiple of 16 numbers.
void Exp(const std::vector<float>& in, std::vector<float>& out) {
  evaluate(in, out, [](FloatTag d, FloatVec x) HWY_ATTR { return fast_exp(d, x); });
}
void Exp2(const std::vector<float>& in, std::vector<float>& out) {
  evaluate(in, out, [](FloatTag d, FloatVec x) HWY_ATTR { return fast_exp2(d, x); });
}
void Reciprocal(const std::vector<float>& in, std::vector<float>& out) {
  evaluate(in, out, [](FloatTag d, FloatVec x) HWY_ATTR { return fast_reciprocal(d, x); });
}
void Log(const std::vector<float>& in, std::vector<float>& out) {
  evaluate(in, out, [](FloatTag d, FloatVec x) HWY_ATTR { return fast_log(d, x); });
}
void LossLog(const std::vector<float>& in, std::vector<float>& out) {
  evaluate(in, out, [](FloatTag, FloatVec x) HWY_ATTR { return loss_log(x); });
}
void RoughLog2(const std::vector<float>& in, std::vector<float>& out) {
  evaluate(in, out, [](FloatTag, FloatVec x) HWY_ATTR { return rough_log2(x); });
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <hwy/targets.h>

namespace aligngs::cpu {

HWY_EXPORT(Exp);
HWY_EXPORT(Exp2);
HWY_EXPORT(Reciprocal);
HWY_EXPORT(Log);
HWY_EXPORT(LossLog);
HWY_EXPORT(RoughLog2);

namespace {

using VectorFunction = std::function<void(const std::vector<float>&, std::vector<float>&)>;
using TrueFunction = double (*)(double);
constexpr size_t kCount = size_t(1) << 19;  ///< arguments, a multiple of every vector

/// Evenly from the lowest to the highest.
std::vector<float> evenly(double lowest, double highest) {
  std::vector<float> x(kCount);
  for (size_t i = 0; i < kCount; ++i) {
    x[i] = static_cast<float>(lowest + (highest - lowest) * static_cast<double>(i) / static_cast<double>(kCount - 1));
  }
  return x;
}

/// Positive numbers of every exponent from `lowest` to `highest`, half of them within [1/2, 2), where logarithms
/// vanish.
std::vector<float> every_exponent(int lowest, int highest) {
  std::vector<float> x = evenly(0.5, 2);
  for (size_t i = 0; i < kCount; i += 2) {
    const double mantissa = 1 + static_cast<double>(i) / static_cast<double>(kCount);
    x[i] = static_cast<float>(
        std::ldexp(mantissa, lowest + static_cast<int>(i / 2 % static_cast<size_t>(highest - lowest + 1))));
  }
  return x;
}

double units_in_the_last_place(double got, double want) {
  return std::abs(got - want) / std::ldexp(1.0, std::ilogb(want) - 23);
}
double absolute(double got, double want) { return std::abs(got - want); }
/// The absolute error of numbers below 1, the relative error of larger ones.
double mixed(double got, double want) { return std::abs(got - want) / std::max(1.0, std::abs(want)); }

/// The largest error over the arguments, for each instruction set.
void expect_within(double bound, double (*error)(double, double), const VectorFunction& function, TrueFunction truth,
                   const std::vector<float>& arguments) {
  std::vector<float> got(arguments.size());
  for_each_target([&] {
    function(arguments, got);
    double worst = 0;
    size_t at = 0;
    for (size_t i = 0; i < arguments.size(); ++i) {
      const double want = truth(static_cast<double>(arguments[i]));
      if (want == 0 && got[i] == 0) continue;
      const double e = error(static_cast<double>(got[i]), want);
      if (!(e <= worst)) worst = e, at = i;
    }
    EXPECT_LE(worst, bound) << "at " << arguments[at];
    EXPECT_GT(worst, 0) << "nothing was compared";
  });
}

TEST(SimdMath, ExponentialIsWithinTwoUnits) {
  const auto exp = [](const std::vector<float>& in, std::vector<float>& out) { HWY_DYNAMIC_DISPATCH(Exp)(in, out); };
  expect_within(2, units_in_the_last_place, exp, std::exp, evenly(-87, 88));
  expect_within(2, units_in_the_last_place, exp, std::exp, evenly(-1, 0));
}

TEST(SimdMath, PowerOfTwoIsWithinTwoAndAHalfUnits) {
  const auto exp2 = [](const std::vector<float>& in, std::vector<float>& out) { HWY_DYNAMIC_DISPATCH(Exp2)(in, out); };
  expect_within(2.5, units_in_the_last_place, exp2, std::exp2, evenly(-126, 127));
  expect_within(2.5, units_in_the_last_place, exp2, std::exp2, evenly(-8, 0));  // the alphas of a pixel
}

TEST(SimdMath, PowerOfTwoIsExactAtWholeNumbersAndEndsAtItsLowest) {
  std::vector<float> in(256, -1e30f), out(256);
  for (int i = 0; i < 254; ++i) in[static_cast<size_t>(i)] = static_cast<float>(i - 126);
  HWY_DYNAMIC_DISPATCH(Exp2)(in, out);
  for (size_t i = 0; i < 254; ++i) EXPECT_EQ(out[i], std::ldexp(1.0f, static_cast<int>(i) - 126));
  EXPECT_EQ(out[255], std::ldexp(1.0f, -126));
}

TEST(SimdMath, ReciprocalIsWithinThreeAndAHalfUnits) {
  const auto reciprocal = [](const std::vector<float>& in, std::vector<float>& out) {
    HWY_DYNAMIC_DISPATCH(Reciprocal)(in, out);
  };
  expect_within(
      3.5, units_in_the_last_place, reciprocal, [](double x) { return 1 / x; }, every_exponent(-125, 125));
}

TEST(SimdMath, LogarithmIsWithinTwoUnits) {
  const auto log = [](const std::vector<float>& in, std::vector<float>& out) { HWY_DYNAMIC_DISPATCH(Log)(in, out); };
  expect_within(2, units_in_the_last_place, log, std::log, every_exponent(-126, 127));
}

TEST(SimdMath, LogarithmOfALossIsWithinItsBound) {
  const auto log = [](const std::vector<float>& in, std::vector<float>& out) {
    HWY_DYNAMIC_DISPATCH(LossLog)(in, out);
  };
  expect_within(5e-7, mixed, log, std::log, every_exponent(-126, 127));
}

TEST(SimdMath, RoughLogarithmIsWithinItsBound) {
  const auto log2 = [](const std::vector<float>& in, std::vector<float>& out) {
    HWY_DYNAMIC_DISPATCH(RoughLog2)(in, out);
  };
  // probabilities from a thousandth of the floor
  expect_within(1.5e-5, absolute, log2, std::log2, every_exponent(-20, 1));
  expect_within(2.5e-5, absolute, log2, std::log2, every_exponent(-126, 127));
}

}  // namespace
}  // namespace aligngs::cpu
#endif
