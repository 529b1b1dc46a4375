#include "nn/eomt/eomt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/error.h"
#include "nn/eomt/eomt_weights.h"
#include "nn/eomt/semantic.h"
#include "nn/ops/resize.h"
#include "nn/rename.h"
#include "nn/testing/small_networks.h"

namespace aligngs::nn {
namespace {

using testing::HasSubstr;

/// A file of Hugging Face's layout under the publisher's names.
std::shared_ptr<MemoryWeights> as_published(const std::shared_ptr<MemoryWeights>& huggingface, const EomtSize& size) {
  const Weights known = eomt_weights(huggingface);
  const auto out = small_weights(eomt_tensors(size));
  for (const SafetensorsStream::Entry& tensor : eomt_tensors(size)) {
    std::string name = tensor.name;
    replace_start(name, "network.", "");
    replace_part(name, ".reg_token", ".register_tokens");
    if (known.has(name)) out->set(tensor.name, tensor.shape, known.load(name, known.shape(name)));
  }
  return out;
}

class EomtTest : public testing::Test {
 protected:
  Eomt network() { return Eomt(compute_, eomt_weights(weights_), options_); }
  void expect_refused(const std::string& message) {
    try {
      network();
      FAIL() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kWeights);
      EXPECT_THAT(error.details().message, HasSubstr(message));
      EXPECT_FALSE(error.details().remedy.empty());
    }
  }

  ThreadPool pool_{2};
  Compute compute_{pool_};
  EomtOptions options_{2, 0};
  std::shared_ptr<MemoryWeights> weights_ = small_weights(eomt_tensors(small_eomt_size()));
};

TEST_F(EomtTest, GivesAClassAndAMaskPerQuery) {
  const Eomt eomt = network();
  EXPECT_EQ(eomt.window(), 64);
  EXPECT_EQ(eomt.classes(), 5);
  EXPECT_EQ(eomt.queries(), 6);
  const EomtPrediction prediction = eomt(compute_, small_photo(64, 64));
  EXPECT_EQ(prediction.classes.rows, 6);
  EXPECT_EQ(prediction.classes.columns, 6);
  EXPECT_EQ(prediction.masks.height, 16);
  EXPECT_EQ(prediction.masks.channels, 6);
}

TEST_F(EomtTest, BothLayoutsGiveTheSameAndAreToldApartByTheirTensors) {
  weights_ = small_weights(eomt_huggingface_tensors(small_eomt_size()));
  const EomtPrediction a = network()(compute_, small_photo(64, 64));
  weights_ = as_published(weights_, small_eomt_size());
  const EomtPrediction b = network()(compute_, small_photo(64, 64));
  EXPECT_EQ(a.masks.data, b.masks.data);
  EXPECT_EQ(a.classes.data, b.classes.data);
}

TEST_F(EomtTest, NamesOfACompiledModuleAndWithoutNetworkAreKnown) {
  const auto renamed = std::make_shared<MemoryWeights>();
  for (const SafetensorsStream::Entry& tensor : eomt_tensors(small_eomt_size())) {
    std::string name = tensor.name;
    if (replace_start(name, "network.encoder.", "encoder._orig_mod."))
      replace_part(name, "blocks.", "blocks._orig_mod.");
    replace_start(name, "network.", "");
    renamed->set(name, tensor.shape, weights_->read(tensor.name));
  }
  const EomtPrediction a = network()(compute_, small_photo(64, 64));
  weights_ = renamed;
  EXPECT_EQ(network()(compute_, small_photo(64, 64)).masks.data, a.masks.data);
}

TEST_F(EomtTest, TheFilesOwnPixelValuesCount) {
  const EomtPrediction a = network()(compute_, small_photo(64, 64));
  weights_->set("network.encoder.pixel_mean", {1, 3, 1, 1}, {0.2f, 0.5f, 0.4f});
  EXPECT_NE(network()(compute_, small_photo(64, 64)).masks.data, a.masks.data);
  weights_->set("network.encoder.pixel_std", {1, 3, 1, 1}, {0.2f, 0.0f, 0.4f});
  expect_refused("not positive");
}

/// SwiGLU multiplies the halves of the first layer: if one is 0, nothing but the second layer's bias is left.
TEST_F(EomtTest, AGatedFeedForwardPartIsReadByItsShape) {
  const auto masks_with = [&](const std::vector<float>& first, int64_t inner, const std::vector<float>& second) {
    for (int i = 0; i < 4; ++i) {
      const std::string block = "network.encoder.backbone.blocks." + std::to_string(i) + ".mlp.";
      weights_->set(block + "fc1.weight", {128, 32}, first);
      weights_->set(block + "fc1.bias", {128}, std::vector<float>(128));
      weights_->set(block + "fc2.weight", {32, inner}, second);
    }
    return network()(compute_, small_photo(64, 64)).masks.data;
  };
  const std::vector<float> first = random_values(128 * 32, 2), second = random_values(32 * 64, 3);
  const std::vector<float> nothing = masks_with(first, 128, std::vector<float>(32 * 128));
  EXPECT_NE(masks_with(first, 64, second), nothing);
  for (const int64_t half : {0, 1}) {
    std::vector<float> half_of_first = first;
    std::fill_n(half_of_first.begin() + half * 64 * 32, 64 * 32, 0.0f);
    EXPECT_EQ(masks_with(half_of_first, 64, second), nothing) << half;
  }
}

TEST_F(EomtTest, MasksOfTrainingThatAreStillInUseAreRefused) {
  weights_->set("network.attn_mask_probs", {2}, {0, 0.25f});
  expect_refused("attention masks of training");
}

TEST_F(EomtTest, DifferencesToAnotherBackboneAreRefused) {
  weights_->forget("network.encoder.backbone.pos_embed");
  expect_refused("DINOv3");
}

TEST_F(EomtTest, FilesOfOtherNetworksAreRefused) {
  weights_ = small_weights(dinov2_tensors({32, 4, false, 0, 4}));
  EXPECT_FALSE(is_eomt(*weights_));
  expect_refused("no learned queries");
}

TEST_F(EomtTest, ATableThatIsNoSquareIsRefused) {
  weights_->set("network.encoder.backbone.pos_embed", {1, 17, 32}, random_values(17 * 32));
  expect_refused("square number of places");
}

TEST_F(EomtTest, AnotherSizeOfWindowIsBadInput) {
  try {
    network()(compute_, small_photo(80, 64));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(error.details().remedy, HasSubstr("64 x 64"));
  }
}

TEST_F(EomtTest, ScoresComeAtAnySizeAndAreSumsOfShares) {
  const FeatureMap scores = eomt_scores(compute_, network(), small_photo(150, 70), 20, 43);
  ASSERT_EQ(scores.places(), 20 * 43);
  ASSERT_EQ(scores.channels, 5);
  for (const float v : scores.data) {
    ASSERT_GE(v, 0);
    ASSERT_LE(v, 6);
  }
}

TEST_F(EomtTest, ASmallMapIsTheLargeOneResized) {
  // 100 x 70 becomes 91 x 64, two windows that overlap.
  for (const auto& [width, height] : {std::pair{100, 70}, {70, 100}}) {
    const Image<uint8_t> photo = small_photo(width, height);
    const Image<uint8_t> resized = eomt_windows(photo, network().window()).resized;
    const FeatureMap whole = eomt_scores(compute_, network(), photo, resized.height, resized.width);
    const FeatureMap expected = resize_bilinear_map(compute_, whole, 9, 14, false),
                     small = eomt_scores(compute_, network(), photo, 9, 14);
    ASSERT_EQ(small.data.size(), expected.data.size());
    for (size_t i = 0; i < expected.data.size(); ++i) ASSERT_NEAR(small.data[i], expected.data[i], 1e-5) << i;
  }
}

TEST_F(EomtTest, TheNumberOfThreadsChangesNoBit) {
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    std::vector<FeatureMap> scores;
    for (const int threads : {1, 3}) {
      ThreadPool pool(threads);
      Compute compute(pool, {precision, true, true});
      const Eomt eomt(compute, eomt_weights(weights_), options_);
      scores.push_back(eomt_scores(compute, eomt, small_photo(100, 70), 30, 40));
    }
    EXPECT_EQ(scores[0].data, scores[1].data);
  }
}

TEST(EomtWindows, CoverTheLongSideEvenly) {
  const EomtWindows wide = eomt_windows(Image<uint8_t>(640, 480, 3), 512);
  EXPECT_EQ(wide.resized.width, 683);
  EXPECT_EQ(wide.resized.height, 512);
  EXPECT_FALSE(wide.tall);
  EXPECT_THAT(wide.starts, testing::ElementsAre(0, 171));
  const EomtWindows tall = eomt_windows(Image<uint8_t>(100, 250, 3), 64);
  EXPECT_TRUE(tall.tall);
  EXPECT_THAT(tall.starts, testing::ElementsAre(0, 48, 96));
  EXPECT_THAT(eomt_windows(Image<uint8_t>(30, 30, 3), 64).starts, testing::ElementsAre(0));
  EXPECT_THROW(eomt_windows(Image<uint8_t>(30, 30, 1), 64), Error);
}

TEST(EomtOptions, AreReadFromTheFilesBesideTheWeights) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "eomt_options_test";
  std::filesystem::create_directories(folder);
  for (const char* const name : {"config.json", "preprocessor_config.json"}) std::filesystem::remove(folder / name);
  EXPECT_EQ(eomt_options_beside(folder / "model.safetensors").heads, 0);
  std::ofstream(folder / "config.json") << R"({"model_type": "eomt", "num_attention_heads": 16, "num_blocks": 4})";
  std::ofstream(folder / "preprocessor_config.json") << R"({"image_mean": [0.1, 0.2, 0.3]})";
  const EomtOptions options = eomt_options_beside(folder / "model.safetensors");
  EXPECT_EQ(options.heads, 16);
  EXPECT_EQ(options.query_blocks, 4);
  EXPECT_FLOAT_EQ(options.mean[1], 0.2f);
  EXPECT_FLOAT_EQ(options.deviation[1], 0.224f);
  std::ofstream(folder / "config.json") << R"({"model_type": "eomt", "num_blocks": 1e308})";
  EXPECT_THROW(eomt_options_beside(folder / "model.safetensors"), Error);
  std::ofstream(folder / "config.json") << "{";
  EXPECT_THROW(eomt_options_beside(folder / "model.safetensors"), Error);
}

}  // namespace
}  // namespace aligngs::nn
