// A new pixel term from nothing: what CONTRIBUTING.md shows is compiled and checked here.
#include "engine/losses/pixel_terms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "engine/engine_arrays.h"
#include "engine/losses/depth_map.h"
#include "engine/losses/pixel_rows.h"
#include "engine/losses/terms/pixel_terms.h"
#include "engine/losses/testing/maps.h"

namespace aligngs {
namespace {

using testing_maps::LossFixture;

// CONTRIBUTING.md has the same text between its fences.
// [example]
template <class T>
struct BehindPriorTerm {
  static constexpr Loss kLoss = Loss::kLogDepth;  // a new term has a row of its own

  ALIGNGS_HD explicit BehindPriorTerm(const LossSettings&) {}

  ALIGNGS_HD ALIGNGS_ALWAYS_INLINE T weight(const TermPixel<T>& p) const {
    const bool behind = (p.validity == kDepthTight) & (p.prior_depth > 0) & (p.depth > static_cast<T>(p.prior_depth));
    const bool used = behind & (p.confidence > 0) & (p.confidence <= 1);
    return used ? static_cast<T>(p.confidence) : T(0);
  }
  ALIGNGS_HD ALIGNGS_ALWAYS_INLINE TermValue<T> at(const TermPixel<T>& p, T weight, T step) const {
    const T behind = weight > T(0) ? p.depth - static_cast<T>(p.prior_depth) : T(0);
    TermValue<T> out;
    out.value = weight * behind * behind / T(2);
    out.by_depth = step * weight * behind;
    return out;
  }
};
// [end]

constexpr unsigned kNeeds = row_of(BehindPriorTerm<double>::kLoss).needs;

double behind_prior(const LossFixture& f, double weight, std::vector<double>& by_depth) {
  MapLossWorkspace<double> workspace;
  MapGradients<double> gradients;
  gradients.reset(f.pixels());
  const MapLossInputs<double> in{f.maps, f.view, f.settings, nullptr, &workspace};
  compute_depth_map(in, workspace);
  const BehindPriorTerm<double> term(f.settings);
  const double value = fold_pixel_term<double>(
      in, weight, kNeeds,
      [&](const PixelRow<double>& row, double* weights) { weights_of_row<kNeeds>(term, row, weights); },
      [&](const PixelRow<double>& row, const double* weights, double step, const PixelRowOutputs<double>& out) {
        values_of_row<kNeeds>(term, row, weights, step, out);
      },
      workspace, gradients);
  by_depth = workspace.depth_gradient;
  return value;
}

TEST(PixelTerms, ANewTermIsAWeightedMeanWithItsGradient) {
  LossFixture f;
  std::vector<double> by_depth, unused;
  ASSERT_GT(behind_prior(f, 0.7, by_depth), 0);
  size_t checked = 0;
  for (size_t i = 0; i < f.pixels(); ++i) {
    if (by_depth[i] == 0) continue;
    // Distance and depth are proportional along a ray: dL/dlog z by both.
    const double distance = f.maps.distance[i], h = 1e-6;
    MapLossWorkspace<double> workspace;
    compute_depth_map<double>({f.maps, f.view, f.settings, nullptr, &workspace}, workspace);
    f.maps.distance[i] = distance * (1 + h);
    const double up = behind_prior(f, 0.7, unused);
    f.maps.distance[i] = distance * (1 - h);
    const double down = behind_prior(f, 0.7, unused);
    f.maps.distance[i] = distance;
    EXPECT_NEAR(0.7 * (up - down) / (2 * h), by_depth[i] * workspace.depth[i], 1e-7);
    ++checked;
  }
  EXPECT_GT(checked, f.pixels() / 10);
}

/// The lines between two marks of a file.
std::string between(const std::string& file, const std::string& first, const std::string& last) {
  std::ifstream in(std::string(ALIGNGS_SOURCE_DIR) + "/" + file);
  std::string text, line;
  bool inside = false;
  while (std::getline(in, line)) {
    if (inside && line == last) return text;
    if (inside) text += line + "\n";
    inside = inside || line == first;
  }
  return "";
}

TEST(PixelTerms, TheExampleOfTheManualIsThisOne) {
  const std::string here = between("src/engine/losses/pixel_terms_test.cpp", "// [example]", "// [end]");
  ASSERT_NE(here, "");
  EXPECT_EQ(between("CONTRIBUTING.md", "```cpp", "```"), here);
}

TEST(PixelTerms, ATermWithoutItsPriorIsZero) {
  LossFixture f;
  f.view.data.prior_depth = {};
  std::vector<double> by_depth;
  EXPECT_EQ(behind_prior(f, 1, by_depth), 0);
  EXPECT_EQ(*std::max_element(by_depth.begin(), by_depth.end()), 0);
}

TEST(PixelTerms, TheListHoldsTermsOfTheCatalogueAlone) {
  size_t found = 0;
  for (const LossRow& row : kLossCatalogue) {
    if (pixel_term_loss<float>(row.loss) == nullptr) continue;
    EXPECT_EQ(row.stage, LossStage::kGeometry) << row.name;
    ++found;
  }
  EXPECT_EQ(found, PixelTerms::kCount);
}

TEST(LossCatalogue, NamesAreUniqueAndEndWithAZero) {
  for (const LossRow& row : kLossCatalogue) {
    EXPECT_EQ(row.name.data()[row.name.size()], '\0');
    for (const LossRow& other : kLossCatalogue) {
      if (other.loss != row.loss) {
        EXPECT_NE(other.name, row.name);
      }
    }
  }
}

TEST(LossCatalogue, SymbolsAreThoseOfTheManual) {
  std::ifstream in(std::string(ALIGNGS_SOURCE_DIR) + "/docs/method.md");
  const std::string manual{std::istreambuf_iterator<char>(in), {}};
  for (const LossRow& row : kLossCatalogue) EXPECT_NE(manual.find(row.symbol), std::string::npos) << row.symbol;
}

TEST(LossCatalogue, ALossThatIsNotFiniteIsNamed) {
  for (const LossRow& row : kLossCatalogue) {
    LossTerms terms;
    terms[row.loss] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(std::string(non_finite_loss(terms)), row.name);
  }
  LossTerms terms;
  EXPECT_EQ(non_finite_loss(terms), nullptr);
  terms.total = std::numeric_limits<double>::infinity();
  EXPECT_STREQ(non_finite_loss(terms), "total");
}

/// Both engines ask this whether a term acts.
TEST(GivenInputs, SufficeWhenEachNeedIsThere) {
  TrainingView view;
  view.data.prior_depth = ImageF(1, 1, 1);
  view.data.labels = Image<uint16_t>(1, 1, 1);
  const GivenInputs given = given_inputs(view);
  EXPECT_TRUE(given.suffice(kNeedsNothing));
  EXPECT_TRUE(given.suffice(kNeedsPriorDepth | kNeedsLabels | kNeedsDepth | kNeedsUnitNormal));
  EXPECT_FALSE(given.suffice(kNeedsPriorNormal));
  EXPECT_FALSE(GivenInputs{}.suffice(kNeedsPriorDepth));
  EXPECT_FALSE(GivenInputs{}.suffice(kNeedsLabels));
}

}  // namespace
}  // namespace aligngs
