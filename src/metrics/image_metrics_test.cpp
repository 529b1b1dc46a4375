#include "metrics/image_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/random.h"

namespace aligngs {
namespace {

ImageF noise_image(int width, int height, uint64_t seed) {
  Random random(seed);
  ImageF image(width, height, 3);
  for (float& v : image.data) v = static_cast<float>(random.below(256)) / 255.0f;
  return image;
}

TEST(Psnr, OfAConstantOffsetIsItsLogarithm) {
  const ImageF truth(8, 6, 3, 0.5f), render(8, 6, 3, 0.6f);
  EXPECT_NEAR(psnr(render, truth, {}, {.quantise = false}), 20, 1e-4);  // MSE 0.01
  // 0.6 is 153 / 255 exactly, 0.601 rounds to the same byte.
  EXPECT_NEAR(psnr(ImageF(8, 6, 3, 0.601f), truth), psnr(render, truth), 1e-9);
}

TEST(Psnr, EqualImagesAndOutOfRangeValuesAreBounded) {
  const ImageF truth(4, 4, 3, 1.0f);
  EXPECT_EQ(psnr(truth, truth), kMaxPsnr);
  EXPECT_EQ(psnr(ImageF(4, 4, 3, 7.0f), truth), kMaxPsnr);                              // clamped to 1
  EXPECT_EQ(psnr(ImageF(4, 4, 3, std::numeric_limits<float>::quiet_NaN()), truth), 0);  // counts as black
}

TEST(Psnr, TheMaskChoosesThePixels) {
  const ImageF truth(4, 2, 3, 0.0f);
  ImageF render = truth, mask(4, 2, 1, 0.0f);
  for (int c = 0; c < 3; ++c) render.at(1, 1, c) = 1;
  mask.at(0, 0) = 1;
  EXPECT_EQ(psnr(render, truth, mask), kMaxPsnr);
  mask.at(1, 1) = 1;  // one of two pixels is wrong by 1
  EXPECT_NEAR(psnr(render, truth, mask), 10 * std::log10(2.0), 1e-9);
  EXPECT_TRUE(std::isnan(psnr(render, truth, ImageF(4, 2, 1, 0.0f))));
}

TEST(Psnr, DifferentSizesAreRefused) {
  EXPECT_THROW(psnr(ImageF(4, 4, 3), ImageF(4, 5, 3)), Error);
  EXPECT_THROW(psnr(ImageF(4, 4, 3), ImageF(4, 4, 3), ImageF(2, 2, 1)), Error);
}

/// The definition, one window at a time.
double ssim_by_definition(const ImageF& a, const ImageF& b) {
  double weights[11], total = 0, sum = 0;
  for (int i = 0; i < 11; ++i) total += weights[i] = std::exp(-(i - 5) * (i - 5) / (2 * 1.5 * 1.5));
  for (int c = 0; c < a.channels; ++c)
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) {
        double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
        for (int j = -5; j <= 5; ++j)
          for (int i = -5; i <= 5; ++i) {
            if (x + i < 0 || y + j < 0 || x + i >= a.width || y + j >= a.height) continue;
            const double w = weights[i + 5] * weights[j + 5] / (total * total);
            const double u = a.at(x + i, y + j, c), v = b.at(x + i, y + j, c);
            ma += w * u;
            mb += w * v;
            aa += w * u * u;
            bb += w * v * v;
            ab += w * u * v;
          }
        sum += (2 * ma * mb + 1e-4) * (2 * (ab - ma * mb) + 9e-4) /
               ((ma * ma + mb * mb + 1e-4) * (aa - ma * ma + bb - mb * mb + 9e-4));
      }
  return sum / static_cast<double>(a.data.size());
}

TEST(Ssim, EqualsItsDefinition) {
  const ImageF a = noise_image(23, 17, 1), b = noise_image(23, 17, 2);
  EXPECT_NEAR(ssim(a, a), 1, 1e-6);
  EXPECT_NEAR(ssim(a, b), ssim_by_definition(a, b), 1e-6);
}

TEST(Ssim, ImagesSmallerThanTheWindowHaveAScore) {
  const ImageF a = noise_image(3, 2, 1), b = noise_image(3, 2, 2);
  EXPECT_NEAR(ssim(a, b), ssim_by_definition(a, b), 1e-6);
}

TEST(Ssim, TheMaskHidesWhatLiesOutside) {
  const ImageF a = noise_image(40, 30, 1);
  ImageF b = a, mask(40, 30, 1, 1.0f);
  b.at(20, 15, 1) = 1 - b.at(20, 15, 1);
  mask.at(20, 15) = 0;
  EXPECT_LT(ssim(a, b), 1 - 1e-4);
  EXPECT_NEAR(ssim(a, b, mask), 1, 1e-6);
  EXPECT_TRUE(std::isnan(ssim(a, b, ImageF(40, 30, 1, 0.0f))));
}

TEST(Ssim, IsTheSameForAnyNumberOfThreads) {
  const ImageF a = noise_image(57, 43, 3), b = noise_image(57, 43, 4);
  const double alone = ssim(a, b);
  for (const int threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    EXPECT_EQ(ssim(a, b, {}, {}, &pool), alone);
  }
}

TEST(ColorFit, UndoesAnExposureChange) {
  const ImageF truth = noise_image(40, 20, 5);
  ColorAffine exposure;
  exposure.m[0][0] = 0.7;
  exposure.m[1][1] = 0.8;
  exposure.m[2][0] = 0.1;
  exposure.m[2][2] = 0.7;
  exposure.m[1][3] = 0.05;
  const ImageF render = apply_color_affine(truth, exposure);
  const ImageScores scores = compare_images(render, truth, {}, {.quantise = false});
  EXPECT_LT(scores.psnr, 22);
  EXPECT_GT(scores.psnr_affine_full, 60);
  EXPECT_GT(scores.psnr_affine_crossfit, 60);
}

TEST(ColorFit, CrossFittingDoesNotRewardAFitOfOneHalf) {
  // The left half is right, the right half has lost its colour: no single affine explains both.
  const ImageF truth = noise_image(40, 20, 6);
  ImageF render = truth;
  for (int y = 0; y < 20; ++y)
    for (int x = 20; x < 40; ++x)
      for (int c = 0; c < 3; ++c) render.at(x, y, c) = 1 - truth.at(x, y, c);
  const ImageScores scores = compare_images(render, truth);
  EXPECT_LT(scores.psnr_affine_crossfit, scores.psnr_affine_full - 3);
}

TEST(ColorFit, AOneColourImageHasADefinedFit) {
  const ImageF truth = noise_image(20, 20, 7), render(20, 20, 3, 0.5f);
  const ImageScores scores = compare_images(render, truth);
  EXPECT_GT(scores.psnr_affine_full, scores.psnr - 0.1);
  EXPECT_LT(scores.psnr_affine_crossfit, 20);
}

}  // namespace
}  // namespace aligngs
