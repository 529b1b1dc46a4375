#include "gaussians/drawn_labels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gaussians/object_labels.h"

namespace aligngs {
namespace {

constexpr int kDrawnClasses = 3;

/// A line of Gaussians, 1 apart, all alike but for their classes' probabilities.
GaussianModel line(const std::vector<std::array<double, kDrawnClasses>>& probabilities) {
  GaussianModel model;
  model.semantic_channels = kDrawnClasses;
  model.resize(probabilities.size());
  for (size_t i = 0; i < probabilities.size(); ++i) {
    model.positions[3 * i] = static_cast<float>(i);
    model.rotations[4 * i] = 1;
    model.opacity_logits[i] = 2;
    for (size_t c = 0; c < kDrawnClasses; ++c)
      model.semantics[kDrawnClasses * i + c] = static_cast<float>(std::log(probabilities[i][c]));
  }
  return model;
}

std::array<double, kDrawnClasses> drawn(const GaussianModel& model, size_t i) {
  std::array<double, kDrawnClasses> p{};
  double sum = 0;
  for (size_t c = 0; c < kDrawnClasses; ++c)
    sum += p[c] = std::exp(static_cast<double>(model.semantics[kDrawnClasses * i + c]));
  for (double& x : p) x /= sum;
  return p;
}

// Far beyond the reach of the smoothing, so that rows are independent.
constexpr double kTinyExtent = 1e-3, kWideExtent = 1000;

TEST(DrawnLabels, ProbabilitiesAreRaisedToThePower) {
  GaussianModel model = line({{0.6, 0.3, 0.1}});
  ThreadPool pool(1);
  sharpen_label_rows(model, kTinyExtent, 4, pool);
  const auto p = drawn(model, 0);
  const double a = std::pow(0.6, 4), b = std::pow(0.3, 4), c = std::pow(0.1, 4);
  EXPECT_NEAR(p[0], a / (a + b + c), 1e-5);
  EXPECT_NEAR(p[1], b / (a + b + c), 1e-5);
  EXPECT_NEAR(p[2], c / (a + b + c), 1e-5);
}

TEST(DrawnLabels, RowsThatNoPixelTaughtStayWithoutClass) {
  GaussianModel model = line({{1, 1, 1}, {0.98, 0.01, 0.01}});
  ThreadPool pool(1);
  sharpen_label_rows(model, kTinyExtent, 4, pool);
  EXPECT_NEAR(drawn(model, 0)[0], 1.0 / 3, 1e-6);
  EXPECT_GT(drawn(model, 1)[0], 0.999);
}

TEST(DrawnLabels, NeighboursOfLikeColourHaveASay) {
  std::vector<std::array<double, kDrawnClasses>> rows(20, {0.9, 0.05, 0.05});
  rows[10] = {0.45, 0.5, 0.05};
  GaussianModel model = line(rows);
  ThreadPool pool(2);
  sharpen_label_rows(model, kWideExtent, 4, pool);
  EXPECT_GT(drawn(model, 10)[0], 0.9);
}

TEST(DrawnLabels, GivenProbabilitiesNeedNoSmoothing) {
  const GaussianModel model = line({{0.6, 0.3, 0.1}, {0.2, 0.5, 0.3}, {0.1, 0.1, 0.8}});
  ThreadPool pool(1);
  GaussianModel smoothed = model, given = model;
  sharpen_label_rows(smoothed, kWideExtent, 4, pool);
  sharpen_label_rows(given, smoothed_labels(model, kWideExtent, pool), 4, pool);
  EXPECT_EQ(smoothed.semantics, given.semantics);
}

TEST(DrawnLabels, WithoutSemanticsOrGaussiansNothingHappens) {
  ThreadPool pool(1);
  GaussianModel none;
  sharpen_label_rows(none, 1, 4, pool);
  none.semantic_channels = kDrawnClasses;
  sharpen_label_rows(none, 1, 4, pool);
  EXPECT_EQ(none.size(), 0u);
}

}  // namespace
}  // namespace aligngs
