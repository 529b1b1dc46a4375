#include "engine/formulas/semantic_loss.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "engine/formulas/teacher_sampling.h"
#include "scene/semantic_target.h"

namespace aligngs {
namespace {

constexpr int kC = 5;
const std::vector<double> kTeacher = {0.1, 0.5, 0.2, 0.15, 0.05};
const SemanticWeights<double> kWeights{1.0, 0.1};

double total(const SemanticTerms<double>& t) { return kWeights.soft * t.soft + kWeights.hard * t.hard; }

/// Largest difference between `analytic` and central differences of `loss` over x.
double difference(std::vector<double> x, const std::vector<double>& analytic,
                  const std::function<double(const std::vector<double>&)>& loss) {
  double worst = 0;
  const double h = 1e-6;
  for (size_t k = 0; k < x.size(); ++k) {
    const double start = x[k];
    x[k] = start + h;
    const double up = loss(x);
    x[k] = start - h;
    const double down = loss(x);
    x[k] = start;
    worst = std::max(worst, std::abs((up - down) / (2 * h) - analytic[k]));
  }
  return worst;
}

TEST(SemanticLoss, SoftmaxOfLargeLogitsIsFinite) {
  double s[3] = {1000, 999, -1000}, p[3];
  softmax(s, 3, p);
  EXPECT_NEAR(p[0], 1 / (1 + std::exp(-1.0)), 1e-12);
  EXPECT_EQ(p[2], 0);
}

TEST(SemanticLoss, SoftmaxBackwardMatchesDifferences) {
  const std::vector<double> s = {0.3, -1, 0.7, 0.1, 2}, g = {1, -0.5, 0.3, 0.9, -0.2};
  std::vector<double> pi(kC), ds(kC);
  softmax(s.data(), kC, pi.data());
  softmax_backward(pi.data(), g.data(), kC, ds.data());
  EXPECT_LT(difference(s, ds,
                       [&](const std::vector<double>& x) {
                         std::vector<double> p(kC);
                         softmax(x.data(), kC, p.data());
                         double sum = 0;
                         for (int c = 0; c < kC; ++c) sum += p[c] * g[c];
                         return sum;
                       }),
            1e-9);
}

TEST(SemanticLoss, LogitsGradientMatchesDifferences) {
  const std::vector<double> logits = {0.3, -1, 0.7, 0.1, 2};
  std::vector<double> q(kC), g(kC);
  semantic_loss_logits(logits.data(), kTeacher.data(), kC, kWeights, q.data(), g.data());
  EXPECT_LT(
      difference(logits, g,
                 [&](const std::vector<double>& x) {
                   std::vector<double> a(kC), b(kC);
                   return total(semantic_loss_logits(x.data(), kTeacher.data(), kC, kWeights, a.data(), b.data()));
                 }),
      1e-9);
}

TEST(SemanticLoss, PerfectStudentHasNoSoftLoss) {
  std::vector<double> logits(kC), q(kC), g(kC);
  for (int c = 0; c < kC; ++c) logits[c] = std::log(kTeacher[c]) + 3;
  EXPECT_NEAR(semantic_loss_logits(logits.data(), kTeacher.data(), kC, {1, 0}, q.data(), g.data()).soft, 0, 1e-12);
  EXPECT_NEAR(semantic_loss_probabilities(kTeacher.data(), 1.0, kTeacher.data(), kC, {1, 0}, g.data()).soft, 0, 1e-12);
}

/// One class at score 1 through a softmax over 150: 0.0179, and 0.00653 nats from the uniform start.
TEST(SemanticLoss, UniformStudentOfAScoreTeacher) {
  std::vector<double> teacher(150, 0.0), logits(150, 0.0), q(150), g(150);
  teacher[7] = 1;
  softmax(teacher.data(), 150, teacher.data());
  EXPECT_NEAR(teacher[7], 0.0179, 5e-5);
  const SemanticTerms<double> t =
      semantic_loss_logits(logits.data(), teacher.data(), 150, {1, 0.1}, q.data(), g.data());
  EXPECT_NEAR(t.soft, 0.00653, 5e-6);
  EXPECT_NEAR(t.hard, std::log(150.0), 1e-12);
}

TEST(SemanticLoss, ProbabilitiesGradientMatchesDifferences) {
  const std::vector<double> blended = {0.1, 0.05, 0.3, 0.0, 0.25};
  std::vector<double> g(kC);
  semantic_loss_probabilities(blended.data(), 0.7, kTeacher.data(), kC, kWeights, g.data());
  EXPECT_LT(difference(blended, g,
                       [&](const std::vector<double>& x) {
                         std::vector<double> unused(kC);
                         return total(
                             semantic_loss_probabilities(x.data(), 0.7, kTeacher.data(), kC, kWeights, unused.data()));
                       }),
            1e-7);
}

TEST(SemanticLoss, FloorStopsTheLogarithm) {
  const std::vector<double> blended = {1, 0, 0, 0, 0};
  std::vector<double> g(kC);
  const SemanticTerms<double> t =
      semantic_loss_probabilities(blended.data(), 1.0, kTeacher.data(), kC, kWeights, g.data());
  EXPECT_NEAR(t.hard, -std::log(1e-3), 1e-12);
  EXPECT_EQ(g[1], 0);
  EXPECT_LT(semantic_floor<double>(2000), 1.0 / 2000);  // the uniform start has a gradient for any C
}

TEST(SemanticLoss, EmptyPixelIsTheUniformStudent) {
  const std::vector<double> nothing(kC, 0.0);
  std::vector<double> q(kC), g(kC);
  const auto a = semantic_loss_logits(nothing.data(), kTeacher.data(), kC, kWeights, q.data(), g.data());
  const auto b = semantic_loss_probabilities(nothing.data(), 0.0, kTeacher.data(), kC, kWeights, g.data());
  EXPECT_NEAR(a.soft, b.soft, 1e-12);
  EXPECT_NEAR(a.hard, b.hard, 1e-12);
}

TEST(SemanticLoss, ArgMaxTakesTheLowestOfEquals) {
  const double p[3] = {0.2, 0.4, 0.4};
  EXPECT_EQ(arg_max(p, 3), 1);
}

TEST(Coupling, BoundedMatchesDifferencesWithAlphaDetached) {
  const std::vector<double> blended = {0.1, 0.05, 0.3, 0.0, 0.25};
  std::vector<double> h(kC);
  bounded_coupling_probabilities(blended.data(), 0.7, kTeacher.data(), kC, 0.6, h.data());
  EXPECT_LT(difference(blended, h,
                       [&](const std::vector<double>& x) {
                         std::vector<double> unused(kC);
                         return bounded_coupling_probabilities(x.data(), 0.7, kTeacher.data(), kC, 0.6, unused.data());
                       }),
            1e-9);
}

TEST(Coupling, BoundedLogitsMatchesDifferences) {
  const std::vector<double> logits = {0.3, -1, 0.7, 0.1, 2};
  std::vector<double> q(kC), h(kC);
  softmax(logits.data(), kC, q.data());
  bounded_coupling_logits(q.data(), 0.7, kTeacher.data(), kC, 0.6, h.data());
  EXPECT_LT(difference(logits, h,
                       [&](const std::vector<double>& x) {
                         std::vector<double> p(kC), unused(kC);
                         softmax(x.data(), kC, p.data());
                         return bounded_coupling_logits(p.data(), 0.7, kTeacher.data(), kC, 0.6, unused.data());
                       }),
            1e-9);
}

/// However wrong the label, |h . pi| stays of order 1, where the plain gradient of an opaque wrong pixel is in the
/// hundreds.
TEST(Coupling, BoundedIsBounded) {
  std::vector<double> wrong = {0.999, 0.00025, 0.00025, 0.00025, 0.00025}, sure = {0, 1, 0, 0, 0}, h(kC);
  for (double a : {1.0, 0.5}) {
    std::vector<double> blended(kC);
    for (int c = 0; c < kC; ++c) blended[c] = a * wrong[c];
    bounded_coupling_probabilities(blended.data(), a, sure.data(), kC, 1.0, h.data());
    for (int c = 0; c < kC; ++c) EXPECT_LE(std::abs(h[c]), 1 / a + 1e-12);
  }
}

TEST(Coupling, BoundedIsSilentOnThinPixels) {
  const std::vector<double> blended = {0.1, 0, 0.3, 0, 0};
  std::vector<double> h(kC, 7.0);
  EXPECT_EQ(bounded_coupling_probabilities(blended.data(), 0.4, kTeacher.data(), kC, 1.0, h.data()), 0);
  EXPECT_EQ(h, std::vector<double>(kC, 0.0));
}

SemanticTarget two_by_one(float left_confidence, float right_confidence) {
  SemanticTarget t;
  t.channels = 2;
  t.width = 2;
  t.height = 1;
  t.probabilities = {float_to_half(1), float_to_half(0), float_to_half(0.25f), float_to_half(0.75f)};
  t.confidence = {left_confidence, right_confidence};
  return t;
}

TEST(TeacherSampling, HalfPixelRule) {
  const SemanticTarget t = two_by_one(1, 1);
  const float expected[4] = {1.0f, 0.8125f, 0.4375f, 0.25f};  // centres at -1/4, 1/4, 3/4, 5/4 of the map
  for (int x = 0; x < 4; ++x) {
    float p[2];
    const TeacherTaps taps = teacher_taps(t, x, 0, 4, 2);
    ASSERT_TRUE(taps.valid);
    sample_teacher(t, taps, p);
    EXPECT_FLOAT_EQ(p[0], expected[x]);
    EXPECT_FLOAT_EQ(p[0] + p[1], 1.0f);
  }
}

/// The halves of a near-uniform row of 150 classes sum to 2e-4 off 1. The KL divergence of equals is then as far off 0.
TEST(TeacherSampling, SamplesSumToOneSoThatEqualsHaveNoLoss) {
  constexpr int kManyClasses = 150;
  std::vector<float> scores(2 * kManyClasses, 0.0f);
  for (const size_t i : {2, 9, 100, 287}) scores[i] = 1;
  const SemanticTarget t = semantic_target(scores.data(), kManyClasses, 2, 1, {SemanticKind::kLogits, 1});
  std::vector<float> p(kManyClasses);
  sample_teacher(t, teacher_taps(t, 1, 0, 3, 1), p.data());
  double sum = 0;
  for (const float x : p) sum += static_cast<double>(x);
  EXPECT_NEAR(sum, 1, 1e-6);
  const std::vector<double> teacher(p.begin(), p.end());
  std::vector<double> unused(kManyClasses), blended = teacher;
  for (double& x : blended) x /= sum;
  const SemanticTerms<double> terms =
      semantic_loss_probabilities(blended.data(), 1.0, teacher.data(), kManyClasses, {1.0, 0.0}, unused.data());
  EXPECT_NEAR(terms.soft, 0, 1e-6);
}

TEST(TeacherSampling, OwnSizeGivesOwnPixels) {
  const SemanticTarget t = two_by_one(1, 1);
  float p[2];
  sample_teacher(t, teacher_taps(t, 1, 0, 2, 1), p);
  EXPECT_EQ(p[0], 0.25f);
}

TEST(TeacherSampling, UnknownPixelsHaveNoSay) {
  const SemanticTarget t = two_by_one(0, 1);
  EXPECT_FALSE(teacher_taps(t, 0, 0, 4, 2).valid);
  EXPECT_FALSE(teacher_taps(t, 1, 0, 4, 2).valid);  // three quarters unknown
  const TeacherTaps taps = teacher_taps(t, 2, 0, 4, 2);
  ASSERT_TRUE(taps.valid);
  float p[2];
  sample_teacher(t, taps, p);
  EXPECT_FLOAT_EQ(p[1], 0.75f);  // the known pixel alone
}

}  // namespace
}  // namespace aligngs
