#include "engine/losses/map_losses.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "engine/losses/testing/maps.h"
#include "engine/testing/request.h"

namespace aligngs {
namespace {

using testing_maps::gradient_error;
using testing_maps::largest;
using testing_maps::LossFixture;
using testing_maps::narrow;

// One weighted loss at a time, then all of them.
constexpr auto kLossesOfOneView = losses_of(LossStage::kColor, LossStage::kGeometry);

class EachTerm : public testing::TestWithParam<std::tuple<Loss, bool>> {
 protected:
  static Loss loss() { return std::get<0>(GetParam()); }
  LossFixture fixture() const {
    LossFixture f;
    f.settings.weight[loss()] = 0.7f;
    f.settings.paper_normals = std::get<1>(GetParam());
    return f;
  }
};
INSTANTIATE_TEST_SUITE_P(Losses, EachTerm,
                         testing::Combine(testing::ValuesIn(kLossesOfOneView.begin(), kLossesOfOneView.end()),
                                          testing::Bool()),
                         [](const auto& each) {
                           return std::string(row_of(std::get<0>(each.param)).name) +
                                  (std::get<1>(each.param) ? "_paper" : "_default");
                         });

TEST_P(EachTerm, GradientAgreesWithFiniteDifferences) {
  LossFixture f = fixture();
  EXPECT_LT(gradient_error(f), 1e-6);
}

TEST_P(EachTerm, IsActiveOnTheFixture) {
  MapGradients<double> g;
  const LossTerms terms = fixture().run(g);
  EXPECT_GT(terms[loss()], 0);
  EXPECT_NEAR(terms.total, double(0.7f) * (terms[loss()]), 1e-12);
  EXPECT_GT(largest(g), 0);
}

TEST_P(EachTerm, IsZeroWhereNothingIsVisible) {
  LossFixture f = fixture();
  for (auto* map : {&f.maps.color, &f.maps.alpha, &f.maps.normal, &f.maps.distance, &f.maps.expected, &f.maps.median}) {
    std::fill(map->begin(), map->end(), 0.0);
  }
  MapGradients<double> g;
  const LossTerms terms = f.run(g);
  if (row_of(loss()).stage == LossStage::kColor) {  // the black picture counts as it is
    LossFixture black = fixture();
    std::fill(black.maps.color.begin(), black.maps.color.end(), 0.0);
    MapGradients<double> of_black;
    EXPECT_EQ(terms.total, black.run(of_black).total);
    EXPECT_GT(terms.total, 0);
    EXPECT_EQ(g.color, of_black.color);
    return;
  }
  EXPECT_EQ(terms.total, 0);
  EXPECT_EQ(largest(g), 0);
}

TEST_P(EachTerm, IsZeroWhenTheMaskLeavesNothing) {
  LossFixture f = fixture();
  f.view.data.mask = ImageF(f.maps.width, f.maps.height, 1, 0.0f);
  MapGradients<double> g;
  EXPECT_EQ(f.run(g).total, 0);
  EXPECT_EQ(largest(g), 0);
}

TEST_P(EachTerm, MaskedPixelsGetNoGradient) {
  LossFixture f = fixture();
  f.view.data.mask = ImageF(f.maps.width, f.maps.height, 1, 1.0f);
  for (int x = 0; x < f.maps.width; ++x) f.view.data.mask.at(x, 5) = 0;
  MapGradients<double> g;
  f.run(g);
  for (int x = 0; x < f.maps.width; ++x) {
    const size_t i = size_t(5) * f.maps.width + x;
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(g.color[c * f.pixels() + i], 0);
      EXPECT_EQ(g.normal[c * f.pixels() + i], 0);
    }
    EXPECT_EQ(g.distance[i], 0);
  }
}

TEST_P(EachTerm, GradientWithAMaskAgreesWithFiniteDifferences) {
  LossFixture f = fixture();
  f.view.data.mask = ImageF(f.maps.width, f.maps.height, 1, 1.0f);
  for (int x = 3; x < 6; ++x) f.view.data.mask.at(x, 2) = 0;
  EXPECT_LT(gradient_error(f), 1e-6);
}

TEST_P(EachTerm, PriorsThatAreNotNumbersAreLeftOut) {
  LossFixture f = fixture(), without = fixture();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  f.view.data.prior_depth.at(2, 2) = nan;
  f.view.data.prior_depth.at(3, 2) = infinity;
  f.view.data.prior_depth.at(4, 2) = -1;
  f.view.prior_normal.at(5, 2, 1) = nan;
  f.view.depth_weight.at(6, 2) = nan;
  for (const int x : {2, 3, 4}) without.view.data.prior_depth.at(x, 2) = 0;
  for (int c = 0; c < 3; ++c) without.view.prior_normal.at(5, 2, c) = 0;
  without.view.depth_weight.at(6, 2) = 0;
  MapGradients<double> g, wanted;
  EXPECT_EQ(f.run(g).total, without.run(wanted).total);
  EXPECT_EQ(g.color, wanted.color);
  EXPECT_EQ(g.normal, wanted.normal);
  EXPECT_EQ(g.distance, wanted.distance);
}

void expect_near(const std::vector<float>& values, const std::vector<double>& exact, double tolerance) {
  ASSERT_EQ(values.size(), exact.size());
  double worst = 0;
  for (size_t i = 0; i < values.size(); ++i) worst = std::max(worst, std::abs(double(values[i]) - exact[i]));
  EXPECT_LT(worst, tolerance);
}

TEST_P(EachTerm, FloatAgreesWithDouble) {
  for (const int width : {14, 61}) {  // shorter than, and no multiple of, any vector
    LossFixture f(width, 11 + width / 2, 9);
    f.settings = fixture().settings;
    const RenderMaps<float> maps = narrow(f.maps);
    MapGradients<double> exact;
    const LossTerms expected = f.run(exact);
    MapGradients<float> g;
    g.reset(maps.pixels());
    LossTerms terms;
    map_losses<float>({maps, f.view, f.settings, nullptr, nullptr}, terms, g);
    EXPECT_NEAR(terms.total, expected.total, 2e-6 * std::max(1.0, expected.total));
    const double tolerance = 1e-4 * largest(exact);
    expect_near(g.color, exact.color, tolerance);
    expect_near(g.normal, exact.normal, tolerance);
    expect_near(g.distance, exact.distance, tolerance);
  }
}

LossSettings every_term(bool paper) {
  LossSettings s = color_and_class_losses();
  for (const Loss loss : kLossesOfOneView) s.weight[loss] = 0.3f;
  s.paper_normals = paper;
  return s;
}

TEST(MapLosses, AllTermsTogetherAgreeWithFiniteDifferences) {
  LossFixture f;
  f.settings = every_term(false);
  EXPECT_LT(gradient_error(f), 1e-6);
}

template <class T>
void expect_same_for_any_threads(const RenderMaps<T>& maps, const TrainingView& view, const LossSettings& settings) {
  MapGradients<T> one, many;
  LossTerms first;
  one.reset(maps.pixels());
  map_losses<T>({maps, view, settings, nullptr, nullptr}, first, one);
  for (const int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    LossTerms terms;
    many.reset(maps.pixels());
    map_losses<T>({maps, view, settings, &pool, nullptr}, terms, many);
    EXPECT_EQ(terms.total, first.total);
    EXPECT_EQ(terms.psnr, first.psnr);
    EXPECT_EQ(many.color, one.color);
    EXPECT_EQ(many.normal, one.normal);
    EXPECT_EQ(many.distance, one.distance);
  }
}

TEST(MapLosses, ResultsAreTheSameForAnyNumberOfThreads) {
  for (const bool paper : {false, true}) {
    const LossFixture f(61, 53, 4);
    expect_same_for_any_threads(f.maps, f.view, every_term(paper));
    expect_same_for_any_threads(narrow(f.maps), f.view, every_term(paper));
  }
}

TEST(MapLosses, AWorkspaceCarriesNothingFromOneViewToTheNext) {
  LossFixture small(20, 17, 2), large(33, 21, 3);
  small.settings = large.settings = every_term(false);
  large.view.data.mask = ImageF(33, 21, 1, 1.0f);
  MapGradients<double> fresh, reused;
  const LossTerms expected = small.run(fresh);
  MapLossWorkspace<double> workspace;
  LossTerms unused, terms;
  reused.reset(large.pixels());
  map_losses<double>({large.maps, large.view, large.settings, nullptr, &workspace}, unused, reused);
  reused.reset(small.pixels());
  map_losses<double>({small.maps, small.view, small.settings, nullptr, &workspace}, terms, reused);
  EXPECT_EQ(terms.total, expected.total);
  EXPECT_EQ(reused.normal, fresh.normal);
  EXPECT_EQ(reused.distance, fresh.distance);
}

TEST(MapLosses, AMapOfTheWrongSizeIsAnError) {
  LossFixture f;
  f.view.data.prior_depth = ImageF(7, 5, 1, 1.0f);
  MapGradients<double> g;
  try {
    f.run(g);
    FAIL() << "expected an error";
  } catch (const Error& e) {
    EXPECT_EQ(e.details().field, "prior_depth");
  }
}

}  // namespace
}  // namespace aligngs
