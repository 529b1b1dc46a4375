// Losses of the maps against the CPU's, term by term: values, gradients, residual and degenerate cases.
#include "engine/cuda/map_losses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/random.h"
#include "engine/cuda/testing/maps.h"
#include "engine/formulas/photometric.h"
#include "scene/triangle_mesh.h"
#ifdef ALIGNGS_CUDA_EMULATED
#include "device/emulation/emulation.h"
#endif

namespace aligngs::cuda {
namespace {

using testing_maps::LossFixture;
using Result = MapLossResult;

const CudaTolerance kMapTolerance;

constexpr auto kOneView = losses_of(LossStage::kColor, LossStage::kGeometry);

/// One loss, or all that look at one view, in one of the two forms of normals.
struct Case {
  std::optional<Loss> loss;  ///< none: all
  bool paper = false;

  std::string name() const {
    return std::string(paper ? "paper_" : "") + (loss ? std::string(row_of(*loss).name) : "all");
  }
};
const Case kAll{};

std::vector<Case> all_cases() {
  std::vector<Case> cases = {kAll, {{}, true}};
  for (const Loss loss : kOneView) {
    for (const bool paper : {false, true}) cases.push_back({loss, paper});
  }
  return cases;
}

void set_weights(const Case& c, LossSettings& s) {
  s.paper_normals = c.paper;
  for (const Loss loss : kOneView) {
    if (!c.loss || *c.loss == loss) s.weight[loss] = 0.7f;
  }
}

class CudaMapLosses : public DeviceTest {
 protected:
  /// A view with all cases of every term: two walls with a fold, and labels that change across and along it. Prior
  /// values are missing or absurd. Pixels lack depth, have loose depth, or are nearly transparent.
  static LossFixture rough_fixture(int width = 50, int height = 34) {
    LossFixture f(width, height, 5);
    Random random(8);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const size_t i = size_t(y) * width + x;
        if (y > 2 * height / 3 && x < width / 3) f.view.data.labels.at(x, y) = 5;
        if (y > height / 2 && x > 2 * width / 3) f.view.data.labels.at(x, y) = 2;
        if (x == width / 5) f.view.data.labels.at(x, y) = uint16_t(y % 3 == 0 ? kNoLabel : 7);
        if (random.chance(0.03)) f.maps.alpha[i] = 0.2;
        if (random.chance(0.03)) f.maps.distance[i] *= 1.4;
        if (random.chance(0.02)) f.maps.distance[i] *= 4;
        if (random.chance(0.02)) f.maps.distance[i] = 0;
        if (random.chance(0.02)) f.view.data.prior_depth.data[i] = std::numeric_limits<float>::quiet_NaN();
        if (random.chance(0.02)) f.view.depth_weight.data[i] = random.chance(0.5) ? -1.0f : 2.0f;
        if (random.chance(0.02)) f.view.prior_normal.at(x, y, 1) += 3;
      }
    }
    return f;
  }

  static Result run_cpu(const LossFixture& f) { return losses_on_cpu(f); }
  Result run_device(const LossFixture& f) { return losses_on_device(context(), f); }
  void compare(const LossFixture& f) { expect_same_losses(run_device(f), run_cpu(f)); }
};

class CudaMapLossTerms : public CudaMapLosses, public testing::WithParamInterface<Case> {};
INSTANTIATE_TEST_SUITE_P(Each, CudaMapLossTerms, testing::ValuesIn(all_cases()),
                         [](const auto& each) { return each.param.name(); });

TEST_P(CudaMapLossTerms, AgreesWithTheCpu) {
  LossFixture f = rough_fixture();
  set_weights(GetParam(), f.settings);
  const Result cpu = run_cpu(f);
  ASSERT_GT(cpu.terms.total, 0) << "the fixture must give the term something to do";
  expect_same_losses(run_device(f), cpu);
}

TEST_F(CudaMapLosses, MaskedPixelsHaveNoPart) {
  LossFixture f = rough_fixture();
  set_weights(kAll, f.settings);
  f.view.data.mask = ImageF(f.maps.width, f.maps.height, 1, 1.0f);
  for (int y = 0; y < 12; ++y) {
    for (int x = 20; x < 33; ++x) f.view.data.mask.at(x, y) = 0.3f;
  }
  compare(f);
}

TEST_F(CudaMapLosses, NothingCounts) {
  LossFixture f = rough_fixture();
  set_weights(kAll, f.settings);
  f.view.data.mask = ImageF(f.maps.width, f.maps.height, 1, 0.0f);
  const Result r = run_device(f);
  EXPECT_EQ(r.terms.total, 0);
  EXPECT_EQ(largest(r.gradients.color) + largest(r.gradients.normal) + largest(r.gradients.distance), 0);
  expect_same_losses(r, run_cpu(f));
}

TEST_F(CudaMapLosses, PhotosOfEightBitsLoseNothing) {
  LossFixture f = rough_fixture();
  set_weights(kAll, f.settings);
  for (float& v : f.view.data.color.data) v = static_cast<float>(static_cast<int>(v * 255.0f)) / 255.0f;
  const TrainingMaps view(context(), f.view);
  EXPECT_FALSE(view.spans().color_bytes.empty());
  EXPECT_TRUE(view.spans().color.empty());
  compare(f);
}

TEST_F(CudaMapLosses, AnExactCopyHasNoLoss) {
  LossFixture f = rough_fixture();
  f.settings.weight[Loss::kL1] = 0.8f;
  f.settings.weight[Loss::kSsim] = 0.2f;
  const size_t n = f.pixels();
  for (size_t i = 0; i < n; ++i) {
    for (size_t c = 0; c < 3; ++c) f.maps.color[c * n + i] = f.view.data.color.data[3 * i + c];
  }
  const Result r = run_device(f);
  EXPECT_EQ(r.terms[Loss::kL1], 0);
  EXPECT_NEAR(r.terms[Loss::kSsim], 0, kMapTolerance.nothing);
  EXPECT_EQ(r.terms.psnr, kPsnrMaximum);
  EXPECT_LT(largest(r.gradients.color), kMapTolerance.nothing);
}

TEST_F(CudaMapLosses, AViewWithoutPriors) {
  LossFixture f = rough_fixture();
  set_weights(kAll, f.settings);
  f.view.data.prior_depth = f.view.prior_normal = f.view.depth_weight = {};
  f.view.data.labels = {};
  f.view.label_edge = {};
  compare(f);
}

TEST_F(CudaMapLosses, WeightsOfThePriorMayBeAbsent) {
  LossFixture f = rough_fixture();
  set_weights(kAll, f.settings);
  f.view.depth_weight = {};
  compare(f);
}

TEST_F(CudaMapLosses, AFrontalPlaneHasNoCorrelation) {
  LossFixture f = testing_maps::plane_fixture({0, 0, -1}, 2, 40, 30);
  f.settings.weight[Loss::kPearson] = 1;
  const Result r = run_device(f);
  EXPECT_EQ(r.terms[Loss::kPearson], 0);
  EXPECT_EQ(largest(r.gradients.distance), 0);
  expect_same_losses(r, run_cpu(f));
}

TEST_F(CudaMapLosses, TooFewPixelsSwitchATermOff) {
  LossFixture f = rough_fixture();
  set_weights(kAll, f.settings);
  f.settings.weight[Loss::kL1] = f.settings.weight[Loss::kSsim] = 0;
  for (size_t i = 0; i < f.pixels(); ++i) {
    if (i != 700 && i != 701) f.maps.alpha[i] = 0;
  }
  const Result r = run_device(f);
  EXPECT_EQ(r.terms[Loss::kLogDepth] + r.terms[Loss::kNormalConsistency] + r.terms[Loss::kPearson] +
                r.terms[Loss::kPriorNormal],
            0);
  expect_same_losses(r, run_cpu(f));
}

TEST_F(CudaMapLosses, OnePixelAndOneRow) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{37, 1}, std::pair{1, 29}}) {
    LossFixture f(width, height);
    set_weights(kAll, f.settings);
    compare(f);
  }
}

TEST_F(CudaMapLosses, WhatIsNotANumberShowsInItsTerm) {
  LossFixture f = rough_fixture();
  set_weights(kAll, f.settings);
  f.maps.color[77] = std::numeric_limits<double>::quiet_NaN();
  const Result r = run_device(f);
  EXPECT_TRUE(std::isnan(r.terms[Loss::kL1]));
  EXPECT_TRUE(std::isnan(r.terms.total));
  EXPECT_TRUE(std::isfinite(r.terms[Loss::kPearson]));
}

TEST_F(CudaMapLosses, MapsOfAnotherSizeAreRefused) {
  LossFixture f = rough_fixture();
  f.view.depth_weight = ImageF(3, 3, 1);
  EXPECT_THROW(TrainingMaps(context(), f.view), Error);
}

TEST_F(CudaMapLosses, ViewsTakeTheBytesThatWereForecast) {
  const LossFixture f = rough_fixture();
  const uint64_t before = context().used();
  const TrainingMaps view(context(), f.view);
  const uint64_t used = context().used() - before, forecast = TrainingMaps::bytes(f.view);
  EXPECT_GE(used, forecast);
  EXPECT_LE(used, forecast + 6 * 256);  // arrays are aligned
}

#ifdef ALIGNGS_CUDA_EMULATED
TEST_F(CudaMapLosses, TheOrderOfThreadsDoesNotMatter) {
  LossFixture f = rough_fixture();
  set_weights(kAll, f.settings);
  const Result forward = run_device(f);
  for (const ThreadOrder order : {ThreadOrder::kReverse, ThreadOrder::kShuffled}) {
    const ScopedThreadOrder scope(order, 3);
    const Result other = run_device(f);
    EXPECT_EQ(other.terms.total, forward.terms.total);
    EXPECT_EQ(other.gradients.color, forward.gradients.color);
    EXPECT_EQ(other.gradients.normal, forward.gradients.normal);
    EXPECT_EQ(other.gradients.distance, forward.gradients.distance);
  }
}
#endif

}  // namespace
}  // namespace aligngs::cuda
