#include "train/photo_opinions.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

constexpr uint32_t kGaussians = 400;

/// One Gaussian's class by one photo at a distance, everything else alike.
PhotoOpinion opinion(uint32_t gaussian, uint16_t channel, float distance) {
  PhotoOpinion o;
  o.gaussian = gaussian;
  o.votes = 10;
  o.channel[0] = channel;
  o.share[0] = 1;
  o.trait[PhotoOpinion::kConfidence] = 1;
  o.trait[PhotoOpinion::kDistance] = distance;
  o.trait[PhotoOpinion::kAngle] = 1;
  o.trait[PhotoOpinion::kBorder] = 50;
  return o;
}

/// Three photos from near that call everything 0 and one from afar that calls every other Gaussian 1.
PhotoOpinions near_and_far() {
  PhotoOpinions opinions;
  opinions.channels = 2;
  opinions.of_photo.resize(4);
  for (uint32_t i = 0; i < kGaussians; ++i) {
    for (size_t v = 0; v < 3; ++v) opinions.of_photo[v].push_back(opinion(i, 0, 1));
    opinions.of_photo[3].push_back(opinion(i, static_cast<uint16_t>(i % 2), 9));
  }
  return opinions;
}

TEST(CalibrateOpinions, PhotosThatOthersContradictCountLess) {
  PhotoOpinions opinions = near_and_far();
  calibrate_opinions(kGaussians, opinions);
  const float near = opinions.of_photo[0][7].weight, far = opinions.of_photo[3][7].weight;
  EXPECT_GT(near, 3.0f);  // log-odds of 0.995 are 5.3
  EXPECT_LT(far, 0.2f);   // half of them are wrong: log-odds 0, at least 0.1
  EXPECT_GE(far, 0.1f);
  EXPECT_EQ(opinions.of_photo[3][8].weight, far) << "whether this one agrees is not what it is weighed by";
}

TEST(CalibrateOpinions, SumsAreWeighed) {
  PhotoOpinions opinions = near_and_far();
  EXPECT_FLOAT_EQ(sum_votes(opinions, kGaussians)[2 * 7 + 1], 10);
  calibrate_opinions(kGaussians, opinions);
  const float weight = opinions.of_photo[3][7].weight;
  EXPECT_FLOAT_EQ(sum_votes(opinions, kGaussians)[2 * 7 + 1], 10 * weight);
}

TEST(CalibrateOpinions, ThingsThatOnePhotoShowsAreNotCalibratedOn) {
  PhotoOpinions opinions;
  opinions.channels = 2;
  opinions.of_photo.resize(2);
  for (uint32_t i = 0; i < kGaussians; ++i) opinions.of_photo[i % 2].push_back(opinion(i, 1, 2));
  calibrate_opinions(kGaussians, opinions);
  EXPECT_EQ(opinions.of_photo[0][0].weight, 1);
}

TEST(CalibrateOpinions, NoOpinionsAreNoError) {
  PhotoOpinions opinions;
  calibrate_opinions(0, opinions);
  EXPECT_TRUE(sum_votes(opinions, 0).empty());
}

}  // namespace
}  // namespace aligngs
