#include "priors/frame_choice.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::ElementsAre;

/// Waves of 16 pixels that begin at `shift`, seen at a gain.
Image<uint8_t> waves(double shift, double gain = 1, double contrast = 1) {
  Image<uint8_t> image(96, 72, 1);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) = uint8_t(gain * (80 + 60 * contrast * std::sin((x + shift) * 0.4) * std::cos(y * 0.1)));
  }
  return image;
}

TEST(FrameMeter, TheFirstFrameHasNoChangeAndTheSameAgainNone) {
  FrameMeter meter;
  EXPECT_EQ(meter.measure(waves(0)).change, 0);
  EXPECT_NEAR(meter.measure(waves(0)).change, 0, 1e-6);
}

TEST(FrameMeter, ALargerStepChangesMore) {
  FrameMeter meter;
  meter.measure(waves(0));
  const double small = meter.measure(waves(1)).change, large = meter.measure(waves(4)).change;
  EXPECT_GT(small, 0);
  EXPECT_GT(large, 2 * small);
}

TEST(FrameMeter, ExposureIsNoChangeButBrightness) {
  FrameMeter meter;
  const FrameFeatures dark = meter.measure(waves(0)), bright = meter.measure(waves(0, 1.6));
  EXPECT_LT(bright.change, 1e-3);
  EXPECT_NEAR(bright.brightness / dark.brightness, 1.6, 0.02);
  EXPECT_NEAR(bright.sharpness / dark.sharpness, 1, 0.05);
}

TEST(FrameMeter, ABlurredFrameIsLessSharp) {
  FrameMeter meter;
  const double sharp = meter.measure(waves(0)).sharpness;
  EXPECT_LT(meter.measure(waves(0, 1, 0.3)).sharpness, 0.5 * sharp);
}

TEST(FrameMeter, AFrameOfOneColourHasNothingInCommonWithAnother) {
  FrameMeter meter;
  meter.measure(waves(0));
  EXPECT_EQ(meter.measure(Image<uint8_t>(96, 72, 1, 90)).change, 1);
}

TEST(FrameMeter, AFrameWithoutPixelsIsAnError) {
  FrameMeter meter;
  EXPECT_THROW(meter.measure(Image<uint8_t>(2, 2, 1)), Error);
  EXPECT_THROW(meter.measure(Image<uint8_t>(8, 8, 3)), Error);
}

TEST(ChooseFrames, FewFramesAreAllTaken) {
  EXPECT_THAT(choose_frames(std::vector<FrameFeatures>(3), 5), ElementsAre(0, 1, 2));
}

TEST(ChooseFrames, TheSharpestOfEachPieceIsTaken) {
  std::vector<FrameFeatures> frames(12, {1, 0.5, 0.1});
  frames[1].sharpness = frames[5].sharpness = frames[11].sharpness = 2;
  EXPECT_THAT(choose_frames(frames, 3), ElementsAre(1, 5, 11));
}

TEST(ChooseFrames, ARestingCameraGivesFewFrames) {
  std::vector<FrameFeatures> frames(100, {1, 0.5, 0});
  for (size_t i = 80; i < 100; ++i) frames[i].change = 0.2;  // it moves at the end
  const std::vector<size_t> chosen = choose_frames(frames, 10);
  EXPECT_EQ(chosen.size(), 10u);
  const auto resting = std::count_if(chosen.begin(), chosen.end(), [](size_t i) { return i < 80; });
  EXPECT_LE(resting, 3);
  EXPECT_GE(resting, 1);
}

TEST(ChooseFrames, WithoutAnyChangeTimeDecides) {
  EXPECT_THAT(choose_frames(std::vector<FrameFeatures>(8, {1, 0.5, 0}), 4), testing::SizeIs(4));
}

TEST(ChooseFrames, NoFrameIsNone) { EXPECT_THAT(choose_frames({}, 4), ElementsAre()); }

}  // namespace
}  // namespace aligngs
