#include "nn/lingbot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "nn/testing/small_networks.h"

namespace aligngs::nn {
namespace {

using testing::HasSubstr;

class LingbotTest : public testing::Test {
 protected:
  LingbotNetwork network() { return LingbotNetwork(compute_, lingbot_weights(weights_)); }
  FeatureMap logits() { return network().photo_logits(compute_, small_photo(50, 70), 33, 21, 64); }
  void expect_refused(const std::string& message) {
    try {
      network();
      FAIL() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kWeights);
      EXPECT_THAT(error.details().message + " " + error.details().field, HasSubstr(message));
    }
  }

  ThreadPool pool_{2};
  Compute compute_{pool_};
  std::shared_ptr<MemoryWeights> weights_ = small_weights(lingbot_tensors(small_lingbot_size()));
};

TEST_F(LingbotTest, GivesLogitsAtAnySize) {
  const FeatureMap map = logits();
  EXPECT_EQ(map.height, 33);
  EXPECT_EQ(map.width, 21);
  EXPECT_EQ(map.channels, 5);
  EXPECT_EQ(network().classes(), 5);
}

TEST_F(LingbotTest, PlaceCountsThoughNothingIsAdded) {
  // A blank image: without the rotation all patches would be equal, and with it values still are. A bright corner
  // tells.
  FeatureMap image(64, 64, 3);
  for (int64_t y = 0; y < 16; ++y) {
    for (int64_t x = 0; x < 48; ++x) image.data[size_t((y * 64 + x) * 3)] = 2;
  }
  const FeatureMap map = network().grid_logits(compute_, image);
  EXPECT_NE(std::vector<float>(map.at(3, 0), map.at(3, 0) + 5), std::vector<float>(map.at(2, 3), map.at(2, 3) + 5));
}

TEST_F(LingbotTest, BiasesOfKeysDoNotCount) {
  const FeatureMap before = logits();
  std::vector<float> bias = weights_->read("backbone.blocks.0.attn.qkv.bias");
  for (size_t i = 32; i < 64; ++i) bias[i] = 5;
  weights_->set("backbone.blocks.0.attn.qkv.bias", {96}, bias);
  EXPECT_EQ(logits().data, before.data);
  weights_->forget("backbone.blocks.0.attn.qkv.bias_mask");
  expect_refused("bias_mask");
}

TEST_F(LingbotTest, ABackboneAloneIsRefused) {
  weights_->forget("predict.weight");
  EXPECT_FALSE(is_lingbot(*weights_));
  expect_refused("the backbone alone");
}

TEST_F(LingbotTest, PeriodsThatAreNotPositiveAreRefused) {
  weights_->set("backbone.rope_embed.periods", {4}, {1, 2, 0, 4});
  expect_refused("not positive");
}

TEST_F(LingbotTest, SidesThatDoNotDivideAreBadInput) {
  EXPECT_THROW(network().grid_logits(compute_, FeatureMap(64, 60, 3)), Error);
}

}  // namespace
}  // namespace aligngs::nn
