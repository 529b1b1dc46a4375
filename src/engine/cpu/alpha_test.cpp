// The vectors' alpha against the scalar formula in double precision. Most cases lie near the two thresholds that decide
// whether a Gaussian takes part in a pixel.
#include "engine/cpu/testing/each_instruction_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/random.h"
#include "engine/formulas/blending.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/alpha_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/cpu/alpha-inl.h"

HWY_BEFORE_NAMESPACE();
namespace aligngs {
namespace cpu {
namespace HWY_NAMESPACE {

/// alpha_lanes at one pixel, in the first lane; `t` is the transmittance before and after. The second alpha is that of
/// alpha_lanes_within, with the pixel marked open if the first took it.
void AlphaAt(const Splat& g, float pixel_x, float pixel_y, const RasterSettings& raster, float* t, float* alpha) {
  const FloatTag d;
  const AlphaConstants constants(raster);
  const FloatVec fdx = hn::Mul(hn::Set(d, g.fxx), hn::Sub(hn::Set(d, pixel_x), hn::Set(d, g.x)));
  const FloatVec y = hn::Set(d, pixel_y);
  FloatVec left = hn::Set(d, *t), again = left;
  const AlphaLanes lanes = raster.smooth_cutoff ? alpha_lanes<true>(g, fdx, y, constants, left)
                                                : alpha_lanes<false>(g, fdx, y, constants, left);
  const AlphaLanes within = raster.smooth_cutoff ? alpha_lanes_within<true>(g, fdx, y, constants, lanes.taken, again)
                                                 : alpha_lanes_within<false>(g, fdx, y, constants, lanes.taken, again);
  *t = hn::GetLane(left);
  alpha[0] = hn::GetLane(lanes.alpha);
  alpha[1] = hn::GetLane(within.alpha);
}

}  // namespace HWY_NAMESPACE
}  // namespace cpu
}  // namespace aligngs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <hwy/targets.h>

namespace aligngs::cpu {

HWY_EXPORT(AlphaAt);

namespace {

/// Relative to a threshold: what float and double may part over. exp2 has 2 units of 6e-8; the exponent, up to 8, as
/// many roundings of its own size.
constexpr double kRounding = 5e-6;
const std::vector<double> kBeside = {1e-2, -1e-2, 1e-3, -1e-3, 1e-4, -1e-4, 1e-5, -1e-5};

/// A Gaussian and a pixel within three standard deviations of it.
struct Sight {
  Splat splat;
  float x = 0, y = 0;
  double falloff = 0;  ///< there, without the opacity
};
Sight random_sight(Random& random) {
  Sight s;
  s.splat = Splat{};
  s.x = static_cast<float>(random.below(640)) + 0.5f;
  s.y = static_cast<float>(random.below(480)) + 0.5f;
  s.splat.fxx = static_cast<float>(random.uniform(0.2, 1.4));
  s.splat.fyy = static_cast<float>(random.uniform(0.2, 1.4));
  s.splat.fxy = static_cast<float>(random.uniform(-0.3, 0.3));
  const double angle = random.uniform(0, 6.2831853), reach = random.uniform(0, 2.6);  // exponents down to -6.8
  const double r = reach * std::sin(angle), dy = r / static_cast<double>(s.splat.fyy);
  const double dx =
      (reach * std::cos(angle) - static_cast<double>(s.splat.fxy) * dy) / static_cast<double>(s.splat.fxx);
  s.splat.x = static_cast<float>(static_cast<double>(s.x) - dx);
  s.splat.y = static_cast<float>(static_cast<double>(s.y) - dy);
  s.splat.opacity = 1;
  return s;
}

/// The scalar formula for the same numbers: log2(e)/2 A = F F^T.
AlphaSample<double> scalar_alpha(const Sight& s, const RasterSettings& raster) {
  const double xx = s.splat.fxx, xy = s.splat.fxy, yy = s.splat.fyy, k = 2 * std::log(2.0);
  const Vec2d mean{static_cast<double>(s.splat.x), static_cast<double>(s.splat.y)};
  return alpha_at<double>(mean, {k * xx * xx, k * xx * xy, k * (xy * xy + yy * yy)},
                          static_cast<double>(s.splat.opacity), static_cast<double>(s.x), static_cast<double>(s.y),
                          raster);
}

struct Taken {
  float alpha[2], left;
};
Taken take(const Sight& s, const RasterSettings& raster, float before) {
  Taken out{{0, 0}, before};
  HWY_DYNAMIC_DISPATCH(AlphaAt)(s.splat, s.x, s.y, raster, &out.left, out.alpha);
  return out;
}

TEST(Alpha, FollowsTheFormula) {
  for_each_target([] {
    Random random(1);
    for (const bool smooth : {false, true}) {
      RasterSettings raster;
      raster.smooth_cutoff = smooth;
      for (int i = 0; i < 2000; ++i) {
        Sight s = random_sight(random);
        s.splat.opacity = static_cast<float>(random.uniform(0.02, 1));
        const double want = scalar_alpha(s, raster).alpha;
        const Taken got = take(s, raster, 1);
        ASSERT_NEAR(got.alpha[0], want, 2e-5 * want + (smooth ? 1e-6 : 0)) << i;
        ASSERT_EQ(got.alpha[0], got.alpha[1]);
        ASSERT_NEAR(got.left, 1 - want, 2e-5);
      }
    }
  });
}

TEST(Alpha, TakesPartJustAboveTheThresholdAndNotJustBelow) {
  const RasterSettings raster;
  for_each_target([&] {
    Random random(2);
    for (int i = 0; i < 4000; ++i) {
      Sight s = random_sight(random);
      const double beside = kBeside[static_cast<size_t>(i) % kBeside.size()];
      const double falloff = scalar_alpha(s, raster).falloff;
      s.splat.opacity = static_cast<float>(static_cast<double>(raster.alpha_min) * (1 + beside) / falloff);
      ASSERT_LE(s.splat.opacity, 1.0f);
      const double want = scalar_alpha(s, raster).alpha;
      ASSERT_EQ(want > 0, beside > 0);
      const Taken got = take(s, raster, 0.7f);
      ASSERT_NEAR(got.alpha[0], want, kRounding * want) << beside << ", number " << i;
      ASSERT_EQ(got.alpha[0], got.alpha[1]);
      ASSERT_EQ((got.left < 0.7f), (want > 0));
    }
  });
}

TEST(Alpha, APixelClosesBeforeItsTransmittanceFallsBelowTheLeast) {
  const RasterSettings raster;
  for_each_target([&] {
    Random random(3);
    for (int i = 0; i < 4000; ++i) {
      Sight s = random_sight(random);
      s.splat.opacity = static_cast<float>(random.uniform(0.3, 0.9));  // 1 - alpha keeps most of its digits
      const double alpha = scalar_alpha(s, raster).alpha;
      if (alpha == 0) continue;
      const double beside = kBeside[static_cast<size_t>(i) % (kBeside.size() - 2)];  // float tells 1e-4 apart
      const float before =
          static_cast<float>(static_cast<double>(raster.transmittance_min) * (1 + beside) / (1 - alpha));
      double left = static_cast<double>(before), weight = 0;
      ASSERT_EQ(blend_step(alpha, static_cast<double>(raster.transmittance_min), left, weight), beside > 0);
      const Taken got = take(s, raster, before);
      ASSERT_EQ(got.alpha[0] > 0, beside > 0) << beside << ", number " << i;
      ASSERT_EQ(got.alpha[0], got.alpha[1]);
      // A closed pixel keeps what it had and is marked by the sign: nothing behind takes part, however faint.
      ASSERT_NEAR(std::abs(got.left), left, 1e-3 * left);
      ASSERT_EQ(std::signbit(got.left), beside < 0);
      Sight faint = s;
      faint.splat.opacity =
          static_cast<float>(2 * static_cast<double>(raster.alpha_min) / scalar_alpha(s, raster).falloff);
      if (beside < 0) {
        ASSERT_EQ(take(faint, raster, got.left).alpha[0], 0.0f);
      }
    }
  });
}

}  // namespace
}  // namespace aligngs::cpu
#endif
