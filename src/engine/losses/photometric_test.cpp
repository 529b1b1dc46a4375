#include "engine/losses/photometric.h"

#include <gtest/gtest.h>

#include "engine/losses/ssim.h"
#include "engine/losses/testing/maps.h"

namespace aligngs {
namespace {

using testing_maps::largest;
using testing_maps::LossFixture;

// A fixture whose render is the photo plus an offset.
LossFixture offset_fixture(double offset) {
  LossFixture f(24, 18);
  for (size_t i = 0; i < f.pixels(); ++i) {
    for (int c = 0; c < 3; ++c) {
      float& truth = f.view.data.color.data[3 * i + c];
      truth = 0.1f + 0.8f * truth;
      f.maps.color[c * f.pixels() + i] = double(truth) + offset;
    }
  }
  return f;
}

// SSIM written down from its definition: a 2-D window, no separation.
double plain_ssim(const LossFixture& f) {
  const int w = f.maps.width, h = f.maps.height;
  double window[11][11], sum = 0, total = 0;
  for (int j = 0; j < 11; ++j) {
    for (int i = 0; i < 11; ++i) sum += window[j][i] = std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / 4.5);
  }
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        double mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
        for (int j = -5; j <= 5; ++j) {
          for (int i = -5; i <= 5; ++i) {
            if (x + i < 0 || y + j < 0 || x + i >= w || y + j >= h) continue;
            const double g = window[j + 5][i + 5] / sum;
            const double a = f.maps.color[c * f.pixels() + size_t(y + j) * w + x + i];
            const double b = f.view.data.color.at(x + i, y + j, c);
            mx += g * a;
            my += g * b;
            xx += g * a * a;
            yy += g * b * b;
            xy += g * a * b;
          }
        }
        total += (2 * mx * my + 1e-4) * (2 * (xy - mx * my) + 9e-4) /
                 ((mx * mx + my * my + 1e-4) * (xx - mx * mx + yy - my * my + 9e-4));
      }
    }
  }
  return total / (3.0 * w * h);
}

TEST(Photometric, AnOffsetOfATenthIsAnL1OfATenthAndTwentyDecibels) {
  LossFixture f = offset_fixture(0.1);
  f.settings.weight[Loss::kL1] = 1;
  MapGradients<double> g;
  const LossTerms terms = f.run(g);
  EXPECT_NEAR(terms[Loss::kL1], 0.1, 1e-12);
  EXPECT_NEAR(terms.psnr, 20, 1e-9);
  EXPECT_NEAR(g.color[0], 1 / (3.0 * f.pixels()), 1e-15);
}

TEST(Photometric, AnExactCopyHasNoLossNoGradientAndTheHighestPsnr) {
  LossFixture f = offset_fixture(0);
  f.settings.weight[Loss::kL1] = f.settings.weight[Loss::kSsim] = 1;
  MapGradients<double> g;
  const LossTerms terms = f.run(g);
  EXPECT_EQ(terms[Loss::kL1], 0);
  EXPECT_NEAR(terms[Loss::kSsim], 0, 1e-14);
  EXPECT_EQ(terms.psnr, kPsnrMaximum);
  EXPECT_LT(largest(g), 1e-14);
}

TEST(Photometric, PsnrIsThatOfTheImageAsShown) {
  LossFixture f = offset_fixture(0);
  f.view.data.color.data[0] = 1;
  f.maps.color[0] = 1.7;  // shown as 1
  f.settings.weight[Loss::kL1] = 1;
  MapGradients<double> g;
  EXPECT_EQ(f.run(g).psnr, kPsnrMaximum);
}

TEST(Ssim, AgreesWithItsDefinition) {
  for (const double offset : {0.0, 0.07}) {
    LossFixture f(24, 18, 5);
    for (double& v : f.maps.color) v += offset;
    f.settings.weight[Loss::kSsim] = 1;
    MapGradients<double> g;
    EXPECT_NEAR(1 - f.run(g)[Loss::kSsim], plain_ssim(f), 1e-12);
  }
}

TEST(Ssim, WorksOnImagesSmallerThanItsWindow) {
  LossFixture f(3, 2, 6);
  f.settings.weight[Loss::kSsim] = 1;
  MapGradients<double> g;
  EXPECT_NEAR(1 - f.run(g)[Loss::kSsim], plain_ssim(f), 1e-12);
}

TEST(Photometric, MaskedPixelsCountForNothing) {
  LossFixture f = offset_fixture(0.1);
  f.settings.weight[Loss::kL1] = f.settings.weight[Loss::kSsim] = 1;
  f.view.data.mask = ImageF(24, 18, 1, 1.0f);
  for (int y = 4; y < 9; ++y) f.view.data.mask.at(7, y) = 0;
  MapGradients<double> g;
  const LossTerms before = f.run(g);
  for (int y = 4; y < 9; ++y) f.maps.color[size_t(y) * 24 + 7] = 40;
  const LossTerms after = f.run(g);
  EXPECT_NEAR(after[Loss::kL1], 0.1, 1e-12);
  EXPECT_EQ(after[Loss::kSsim], before[Loss::kSsim]);
  EXPECT_NEAR(after.psnr, 20, 1e-9);
}

TEST(ColorResidual, IsTheMeanAbsoluteDifferenceOutsideTheMask) {
  LossFixture f = offset_fixture(0);
  f.maps.color[5] += 0.3;
  f.maps.color[f.pixels() + 5] -= 0.6;
  f.maps.color[6] += 1;
  f.view.data.mask = ImageF(24, 18, 1, 1.0f);
  f.view.data.mask.data[6] = 0;
  std::vector<float> residual;
  color_residual<double>({f.maps, f.view, f.settings, nullptr, nullptr}, residual);
  EXPECT_NEAR(residual[5], 0.3, 1e-6);
  EXPECT_EQ(residual[6], 0);
  EXPECT_EQ(residual[7], 0);
}

}  // namespace
}  // namespace aligngs
