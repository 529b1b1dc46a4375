// The vector forms of Adam against its formula in double, over several steps from moments that are not zero.
#include "engine/cpu/adam.h"

#include <cmath>
#include <limits>

#include "core/half.h"
#include "core/random.h"
#include "engine/cpu/aligned_array.h"
#include "engine/cpu/bf16_packing.h"
#include "engine/cpu/testing/each_instruction_set.h"
#include "engine/cpu/tile_products.h"
#include "engine/formulas/semantic_loss.h"
#include "gaussians/gaussian_model.h"

namespace aligngs::cpu {
namespace {

constexpr int kSteps = 5;
constexpr size_t kRow = 3 * kShCoefficients;
/// Relative to the rate: a step is a ratio of two numbers with a few roundings of 6e-8 each.
constexpr double kOfTheRate = 1e-5;
constexpr double kRelative = 1e-6;  ///< of moments and parameters

/// Numbers under Adam, in float as the kernels keep them and in double by the formula.
struct Numbers {
  std::vector<float> p, m, v;
  std::vector<double> want_p, want_m, want_v;

  Numbers(size_t count, Random& random) : p(count), m(count), v(count) {
    for (size_t i = 0; i < count; ++i) {
      p[i] = static_cast<float>(random.normal());
      m[i] = static_cast<float>(0.1 * random.normal());
      v[i] = static_cast<float>(0.01 * random.uniform(0.1, 1));
    }
    want_p.assign(p.begin(), p.end());
    want_m.assign(m.begin(), m.end());
    want_v.assign(v.begin(), v.end());
  }
  void update(size_t i, const AdamStep<double>& step, double gradient) {
    adam_update<double>(step, gradient, want_p[i], want_m[i], want_v[i]);
  }
  void expect_equal(double rate) const {
    for (size_t i = 0; i < p.size(); ++i) {
      ASSERT_NEAR(m[i], want_m[i], kRelative) << i;
      ASSERT_NEAR(v[i], want_v[i], kRelative * std::abs(want_v[i]) * 10) << i;
      ASSERT_NEAR(p[i], want_p[i], kOfTheRate * rate * kSteps + kRelative * std::abs(want_p[i])) << i;
    }
  }
};

std::vector<float> gradients(size_t count, Random& random) {
  std::vector<float> g(count);
  for (float& x : g) x = static_cast<float>(random.normal() * (random.chance(0.1) ? 0.0 : 0.3));
  return g;
}

TEST(Adam, RangesOfAnyLength) {
  for_each_target([] {
    for (const size_t count : {size_t(1), size_t(7), size_t(16), size_t(33), size_t(1000)}) {
      Random random(count);
      Numbers n(count, random);
      const double rate = 1e-2;
      for (int t = 1; t <= kSteps; ++t) {
        const std::vector<float> g = gradients(count, random);
        adam_range(make_adam_step<float>({}, rate, t), g.data(), count, n.p.data(), n.m.data(), n.v.data());
        for (size_t i = 0; i < count; ++i) n.update(i, make_adam_step<double>({}, rate, t), g[i]);
      }
      n.expect_equal(rate);
    }
  });
}

TEST(Adam, RowsOfHarmonicsHaveTwoRatesAndUntouchedOnesNoGradient) {
  for_each_target([] {
    constexpr size_t kRows = 9;
    for (const size_t used : {size_t(3), size_t(12), size_t(48)}) {
      Random random(used);
      Numbers n(kRow * kRows, random);
      const double dc = 1e-2, rest = 5e-4;
      const size_t visited = std::min(kRow, (used + 15) / 16 * 16);
      std::vector<uint8_t> touched(kRows);
      for (int t = 1; t <= kSteps; ++t) {
        std::vector<float> g = gradients(kRow * kRows, random);
        for (size_t row = 0; row < kRows; ++row) {
          touched[row] = random.chance(0.6) ? 1 : 0;
          for (size_t i = 0; i < kRow; ++i) {
            float& x = g[kRow * row + i];
            if (i >= used) x = 0;
            if (i < visited)
              n.update(kRow * row + i, make_adam_step<double>({}, i < 3 ? dc : rest, t), touched[row] ? x : 0.0f);
            if (touched[row] == 0) x = std::numeric_limits<float>::quiet_NaN();  // must not be read
          }
        }
        const ShAdam steps{make_adam_step<float>({}, dc, t), make_adam_step<float>({}, rest, t), used};
        adam_sh_rows(steps, g.data(), touched.data(), kRows, n.p.data(), n.m.data(), n.v.data());
      }
      n.expect_equal(dc);
    }
  });
}

/// A row whose gradient goes through its softmax, kept as float32 or rounded to bfloat16.
template <class Number>
void check_semantic_rows(Number (*stored)(float), float (*number_of)(Number)) {
  for (const size_t channels : {size_t(1), size_t(7), size_t(57), size_t(150), size_t(151)}) {
    const size_t padded = padded_channels(static_cast<int>(channels)), depth = padded_depth(padded);
    Random random(channels);
    Numbers n(channels, random);
    const double rate = 4e-2;
    for (int t = 1; t <= kSteps; ++t) {
      AlignedArray<float> g;
      AlignedArray<Number> softmax;
      g.resize(padded);
      softmax.resize(depth);
      for (size_t c = 0; c < padded; ++c) g[c] = 0;
      for (size_t c = 0; c < depth; ++c) softmax[c] = 0;
      std::vector<double> pi(channels), exact(channels), ds(channels);
      for (size_t c = 0; c < channels; ++c) {
        g[c] = static_cast<float>(random.normal());
        softmax[c] = stored(static_cast<float>(random.uniform(0, 2.0 / static_cast<double>(channels))));
        pi[c] = static_cast<double>(number_of(softmax[c]));
        exact[c] = static_cast<double>(g[c]);
      }
      softmax_backward<double>(pi.data(), exact.data(), static_cast<int>(channels), ds.data());
      adam_semantic_row(make_adam_step<float>({}, rate, t), g.data(), softmax.data(), channels, n.p.data(), n.m.data(),
                        n.v.data());
      for (size_t c = 0; c < channels; ++c) n.update(c, make_adam_step<double>({}, rate, t), ds[c]);
    }
    n.expect_equal(rate);
  }
}

TEST(Adam, SemanticRowsThroughTheirSoftmax) {
  for_each_target([] {
    check_semantic_rows<float>([](float x) { return x; }, [](float x) { return x; });
    check_semantic_rows<uint16_t>([](float x) { return float_to_bfloat16(x); },
                                  [](uint16_t x) { return bfloat16_to_float(x); });
  });
}

TEST(Adam, SemanticRowsWithoutSoftmaxOrGradient) {
  for_each_target([] {
    Random random(4);
    Numbers n(7, random);
    AlignedArray<float> g;
    g.resize(padded_channels(7));
    for (size_t c = 0; c < g.size(); ++c) g[c] = 0;
    for (size_t c = 0; c < 7; ++c) g[c] = static_cast<float>(random.normal());
    const float* none = nullptr;
    adam_semantic_row(make_adam_step<float>({}, 1e-2, 1), g.data(), none, 7, n.p.data(), n.m.data(), n.v.data());
    for (size_t c = 0; c < 7; ++c) n.update(c, make_adam_step<double>({}, 1e-2, 1), g[c]);
    adam_semantic_row(make_adam_step<float>({}, 1e-2, 2), none, none, 7, n.p.data(), n.m.data(), n.v.data());
    for (size_t c = 0; c < 7; ++c) n.update(c, make_adam_step<double>({}, 1e-2, 2), 0);
    n.expect_equal(1e-2);
  });
}

TEST(Adam, BoundsFindWhatIsBeyondAndWhatIsNotANumber) {
  for_each_target([] {
    for (const size_t count : {size_t(1), size_t(16), size_t(35)}) {
      std::vector<float> values(count, 0.5f);
      EXPECT_TRUE(all_within(values.data(), count, 1));
      for (size_t i = 0; i < count; ++i) {
        for (const float bad :
             {1.5f, -1.5f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
          values[i] = bad;
          EXPECT_FALSE(all_within(values.data(), count, 1)) << i << " of " << count;
        }
        values[i] = 0.5f;
      }
    }
  });
}

}  // namespace
}  // namespace aligngs::cpu
