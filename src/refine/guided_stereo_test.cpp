#include "refine/guided_stereo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

/// Photos with true cameras and a prior depth that is bent by up to `bend` (log units) along the image.
struct BentPhotos {
  std::vector<RefineView> photos;
  std::vector<ImageF> truth;
  std::vector<const MatchView*> views;

  BentPhotos(int count, double bend) {
    for (int i = 0; i < count; ++i) {
      photos.push_back(photo(true_camera(i)));
      truth.push_back(photos.back().match.depth);
      ImageF& depth = photos.back().match.depth;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x)
          depth.at(x, y) *= static_cast<float>(std::exp(bend * std::sin(0.05 * x + i) * std::cos(0.03 * y)));
      }
    }
    for (const RefineView& p : photos) views.push_back(&p.match);
  }

  /// Median relative error of view i's depth after `log_factor` (empty: before).
  double error(size_t i, const ImageF& log_factor) const {
    std::vector<double> errors;
    for (size_t p = 0; p < truth[i].pixels(); ++p) {
      const double factor = log_factor.empty() ? 1 : std::exp(static_cast<double>(log_factor.data[p]));
      errors.push_back(std::abs(photos[i].match.depth.data[p] * factor / truth[i].data[p] - 1));
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    return errors[errors.size() / 2];
  }
};

TEST(GuidedStereo, StraightensABentPrior) {
  const BentPhotos bent(6, 0.06);
  ThreadPool pool(2);
  const std::vector<StereoResult> results = guided_stereo(bent.views, {}, pool);
  for (size_t i = 1; i + 1 < results.size(); ++i) {
    EXPECT_GT(bent.error(i, {}), 0.015);
    EXPECT_LT(bent.error(i, results[i].log_factor), 0.5 * bent.error(i, {})) << i;
    EXPECT_GT(results[i].measured, 0.4) << i;
  }
}

TEST(GuidedStereo, ALoneViewKeepsItsDepth) {
  const BentPhotos bent(1, 0.04);
  ThreadPool pool(1);
  const std::vector<StereoResult> results = guided_stereo(bent.views, {}, pool);
  EXPECT_EQ(results[0].measured, 0);
  for (const float g : results[0].log_factor.data) EXPECT_EQ(g, 0);
}

TEST(GuidedStereo, PlainWallsKeepTheirDepth) {
  BentPhotos bent(4, 0.04);
  for (RefineView& p : bent.photos) std::fill(p.match.luma.data.begin(), p.match.luma.data.end(), 0.6f);
  ThreadPool pool(1);
  for (const StereoResult& result : guided_stereo(bent.views, {}, pool)) {
    EXPECT_EQ(result.measured, 0);
    for (const float g : result.log_factor.data) EXPECT_EQ(g, 0);
  }
}

TEST(GuidedStereo, DoesNotDependOnTheNumberOfThreads) {
  const BentPhotos bent(4, 0.03);
  ThreadPool one(1), three(3);
  const auto a = guided_stereo(bent.views, {}, one), b = guided_stereo(bent.views, {}, three);
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].log_factor.data, b[i].log_factor.data);
}

TEST(GuidedStereo, ViewsWithoutDepthAreLeftOut) {
  BentPhotos bent(4, 0.03);
  bent.photos[2].match.depth = ImageF();
  ThreadPool pool(1);
  const std::vector<StereoResult> results = guided_stereo(bent.views, {}, pool);
  EXPECT_TRUE(results[2].log_factor.empty());
  EXPECT_GT(results[1].measured, 0.2);
}

TEST(GuidedStereo, SmallPatchesCanBeLeftOut) {
  const BentPhotos bent(4, 0.03);
  ThreadPool pool(2);
  StereoSettings settings;
  settings.least_patch = 0;
  const std::vector<StereoResult> all = guided_stereo(bent.views, settings, pool);
  settings.least_patch = 100;
  const std::vector<StereoResult> large = guided_stereo(bent.views, settings, pool);
  size_t dropped = 0, kept = 0;
  for (size_t p = 0; p < all[1].certainty.pixels(); ++p) {
    const float a = all[1].certainty.data[p], b = large[1].certainty.data[p];
    EXPECT_TRUE(b == a || b == 0);
    dropped += a > 0 && b == 0;
    kept += b > 0;
  }
  EXPECT_GT(dropped, 0u);
  EXPECT_GT(kept, 10 * dropped);
}

TEST(SweepPriorDepth, TheTruthCostsLeast) {
  const BentPhotos exact(4, 0);
  SweepSettings settings;
  const CostVolume volume =
      sweep_prior_depth(*exact.views[1], {exact.views[0], exact.views[2], exact.views[3]}, settings);
  const int middle = settings.hypotheses / 2;
  size_t right = 0, known = 0;
  for (int y = 10; y < kHeight - 10; ++y) {
    for (int x = 10; x < kWidth - 10; ++x) {
      if (!volume.known[static_cast<size_t>(y) * kWidth + x]) continue;
      const float* cost = volume.at(x, y);
      ++known;
      right += std::abs(static_cast<int>(std::min_element(cost, cost + settings.hypotheses) - cost) - middle) <= 3;
    }
  }
  EXPECT_GT(known, size_t(kWidth) * kHeight / 3);
  EXPECT_GT(right, known * 3 / 4);
}

/// A row of pixels whose five hypotheses all cost 1.
CostVolume undecided_row(int width) {
  CostVolume volume;
  volume.width = width, volume.height = 1, volume.hypotheses = 5;
  volume.cost.assign(static_cast<size_t>(width) * 5, 1.0f);
  volume.known.assign(static_cast<size_t>(width), 1);
  return volume;
}

TEST(AggregateCosts, NeighboursDecideWhereAPixelDoesNot) {
  CostVolume volume = undecided_row(9);
  for (int x = 0; x < 9; ++x) {
    if (x != 4) volume.at(x, 0)[3] = 0.2f;
  }
  volume.at(4, 0)[0] = 0.95f;  // hardly better than the rest
  aggregate_costs(volume, ImageF(9, 1, 1, 2.0f), {});
  for (int x = 0; x < 9; ++x) {
    const float* cost = volume.at(x, 0);
    EXPECT_EQ(std::min_element(cost, cost + 5) - cost, 3) << x;
  }
}

TEST(AggregateCosts, ADepthEdgeLetsBothSidesDiffer) {
  CostVolume volume = undecided_row(8);
  ImageF depth(8, 1, 1, 2.0f);
  for (int x = 0; x < 8; ++x) {
    volume.at(x, 0)[x < 4 ? 0 : 4] = 0.7f;
    if (x >= 4) depth.at(x, 0) = 3.0f;
  }
  aggregate_costs(volume, depth, {});
  for (int x = 0; x < 8; ++x) {
    const float* cost = volume.at(x, 0);
    EXPECT_EQ(std::min_element(cost, cost + 5) - cost, x < 4 ? 0 : 4) << x;
  }
}

TEST(AggregateCosts, AnEdgeOfThePhotoLetsBothSidesDiffer) {
  CostVolume volume = undecided_row(8);
  ImageF luma(8, 1, 1, 0.2f);
  for (int x = 0; x < 8; ++x) {
    volume.at(x, 0)[x < 5 ? 0 : 4] = 0.9f;  // weak: three pixels alone would follow the other five
    if (x >= 5) luma.at(x, 0) = 0.9f;
  }
  CostVolume blind = volume;
  SemiGlobalSettings settings;
  aggregate_costs(volume, ImageF(8, 1, 1, 2.0f), settings, luma);
  settings.luma_edge = 0;
  aggregate_costs(blind, ImageF(8, 1, 1, 2.0f), settings, luma);
  const float* b = blind.at(5, 0);
  const float* v = volume.at(5, 0);
  EXPECT_LT(v[4] - v[0], b[4] - b[0]);
  EXPECT_EQ(std::min_element(v, v + 5) - v, 4);
}

TEST(SpreadLogCorrection, StopsAtEdgesOfThePhotoWhenItIsLookedAt) {
  ImageF depth(30, 10, 1, 2.0f), given(30, 10, 1), weight(30, 10, 1), luma(30, 10, 1, 0.2f);
  for (int y = 0; y < 10; ++y) {
    for (int x = 15; x < 30; ++x) luma.at(x, y) = 0.8f;
    for (const int x : {1, 28}) {
      given.at(x, y) = x == 1 ? 0.05f : -0.05f;
      weight.at(x, y) = 1;
    }
  }
  LogCorrectionSettings settings;
  const ImageF field = spread_log_correction(depth, given, weight, settings, luma);
  settings.luma_edge = 0;
  const ImageF blind = spread_log_correction(depth, given, weight, settings, luma);
  EXPECT_NEAR(blind.at(13, 5), 0, 0.012f);
  EXPECT_NEAR(field.at(13, 5), 0.05f, 0.012f);
  EXPECT_NEAR(field.at(16, 5), -0.05f, 0.012f);
}

TEST(SpreadLogCorrection, FillsBetweenWhatIsKnownAndStopsAtDepthEdges) {
  ImageF depth(30, 10, 1, 2.0f), given(30, 10, 1), weight(30, 10, 1);
  for (int y = 0; y < 10; ++y) {
    for (int x = 20; x < 30; ++x) depth.at(x, y) = 4.0f;
    for (const int x : {2, 17}) {
      given.at(x, y) = 0.05f;
      weight.at(x, y) = 1;
    }
    given.at(25, y) = -0.03f;
    weight.at(25, y) = 1;
  }
  const ImageF field = spread_log_correction(depth, given, weight, {});
  EXPECT_NEAR(field.at(10, 5), 0.05f, 0.005f);
  EXPECT_NEAR(field.at(28, 5), -0.03f, 0.005f);
}

TEST(SpreadLogCorrection, NothingKnownAndNothingThereGiveZero) {
  const ImageF none(8, 6, 1);
  for (const float g : spread_log_correction(none, none, none, {}).data) EXPECT_EQ(g, 0);
  for (const float g : spread_log_correction(ImageF(8, 6, 1, 2.0f), none, none, {}).data) EXPECT_EQ(g, 0);
}

}  // namespace
}  // namespace aligngs
