// The semantic loss put together from its channels. It is that of semantic_loss.h if every channel is a class. It is
// that of n equal classes if the last channel represents n.
#include "engine/formulas/semantic_channel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/random.h"
#include "engine/formulas/semantic_loss.h"

namespace aligngs {
namespace {

constexpr double kTolerance = 1e-12;
constexpr int kClasses = 9;  // of which the last kRemainder are equal
constexpr int kRemainder = 4;
constexpr int kChannels = kClasses - kRemainder + 1;

double count_of(int c) { return c == kChannels - 1 ? kRemainder : 1; }

/// All classes, and the same as channels.
struct PixelCase {
  std::vector<double> classes, teacher, channels, channel_teacher;
};

/// `add_up`: the channel holds the sum over its classes (probabilities), else their common value (logits).
PixelCase make_pixel(uint64_t seed, bool add_up) {
  Random random(seed);
  PixelCase p;
  double sum = 0;
  const double common = random.uniform(0.02, 0.1), common_teacher = random.uniform(0.02, 0.1);
  for (int c = 0; c < kClasses; ++c) {
    const bool rest = c >= kChannels - 1;
    p.classes.push_back(rest ? common : random.uniform(0.02, 0.2));
    p.teacher.push_back(rest ? common_teacher : random.uniform(0.05, 0.3));
    sum += p.teacher.back();
  }
  for (double& t : p.teacher) t /= sum;
  p.channels.assign(p.classes.begin(), p.classes.begin() + kChannels);
  p.channel_teacher.assign(p.teacher.begin(), p.teacher.begin() + kChannels);
  p.channel_teacher.back() *= kRemainder;
  if (add_up) p.channels.back() *= kRemainder;
  return p;
}

TEST(SemanticChannel, ProbabilitiesOfARemainderAreThoseOfItsClasses) {
  for (uint64_t seed = 1; seed < 6; ++seed) {
    const PixelCase p = make_pixel(seed, true);
    const double alpha = 0.8, rest = (1 - alpha) / kClasses, omega = 0.6;
    const SemanticWeights<double> weights{0.7, 0.4};
    const int top = arg_max(p.teacher.data(), kClasses);
    ASSERT_LT(top, kChannels - 1);
    std::vector<double> g(kClasses), h(kClasses);
    semantic_loss_probabilities(p.classes.data(), alpha, p.teacher.data(), kClasses, weights, g.data());
    bounded_coupling_probabilities(p.classes.data(), alpha, p.teacher.data(), kClasses, omega, h.data());
    for (int c = 0; c < kChannels; ++c) {
      const ProbabilityChannel<double> channel =
          probability_channel(p.channels[c], rest, count_of(c), semantic_floor<double>(kClasses));
      // The channel's one row receives the gradient of each of its equal classes' rows.
      const double hard = c == top ? weights.hard : 0.0;
      EXPECT_NEAR(probability_gradient(channel, p.channel_teacher[c], weights.soft, hard), g[c], kTolerance);
      EXPECT_NEAR(bounded_probability_direction(p.channels[c], 1 / alpha, p.channel_teacher[c], omega, count_of(c)),
                  h[c], kTolerance);
    }
  }
}

TEST(SemanticChannel, AtTheFloorThereIsNoGradientAndNotANumberIsNotTheFloor) {
  const ProbabilityChannel<double> low = probability_channel(1e-5, 0.0, 1.0, 1e-3);
  EXPECT_FALSE(low.above);
  EXPECT_EQ(low.q, 1e-3);
  EXPECT_EQ(probability_gradient(low, 0.5, 1.0, 1.0), 0.0);
  EXPECT_TRUE(std::isnan(probability_channel(std::numeric_limits<double>::quiet_NaN(), 0.0, 1.0, 1e-3).q));
}

TEST(SemanticChannel, LogitsOfARemainderAreThoseOfItsClasses) {
  for (uint64_t seed = 1; seed < 6; ++seed) {
    const PixelCase p = make_pixel(seed, false);
    const double alpha = 0.8, omega = 0.6;
    const SemanticWeights<double> weights{0.7, 0.4};
    const int top = arg_max(p.teacher.data(), kClasses);
    std::vector<double> q(kClasses), g(kClasses), h(kClasses);
    semantic_loss_logits(p.classes.data(), p.teacher.data(), kClasses, weights, q.data(), g.data());
    bounded_coupling_logits(q.data(), alpha, p.teacher.data(), kClasses, omega, h.data());
    double along = 0;
    std::vector<double> channel_q(kChannels);
    for (int c = 0; c < kChannels; ++c) {
      channel_q[c] = q[c] * count_of(c);
      along += channel_q[c] * bounded_logit_error(channel_q[c], p.channel_teacher[c], count_of(c));
    }
    for (int c = 0; c < kChannels; ++c) {
      const double error = bounded_logit_error(channel_q[c], p.channel_teacher[c], count_of(c));
      // A logit of the remainder moves all of its classes: it receives their sum.
      EXPECT_NEAR(logit_gradient(channel_q[c], p.channel_teacher[c], 1.0, weights.soft, weights.hard,
                                 c == top ? weights.hard : 0.0),
                  g[c] * count_of(c), kTolerance);
      EXPECT_NEAR(bounded_logit_direction(channel_q[c], error, along, omega), h[c] * count_of(c), kTolerance);
    }
  }
}

}  // namespace
}  // namespace aligngs
