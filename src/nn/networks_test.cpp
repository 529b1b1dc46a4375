// The networks at small sizes on random weights: shapes, errors, and what must hold for any
// weights.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/gzip.h"
#include "nn/bn_head.h"
#include "nn/depther.h"
#include "nn/mask2former.h"
#include "nn/testing/weights.h"
#include "nn/vggt.h"

namespace aligngs::nn {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const VitSize kVit{32, 4, false, 0, 5};

VggtSize small_vggt() {
  VggtSize size;
  size.encoder = {32, 2, false, 4, 5};
  size.depth = 4;
  size.camera_depth = 1;
  size.features = 16;
  size.levels = {8, 12, 16, 20};
  return size;
}

VggtOptions small_vggt_options() {
  VggtOptions options;
  options.heads = 2;
  options.camera_heads = 2;
  options.layers = {0, 1, 2, 3};
  return options;
}

/// vggt_tensors assumes heads of 64 values; with two heads of 16 the norms are narrower.
std::shared_ptr<MemoryWeights> small_vggt_weights() {
  TensorList tensors = vggt_tensors(small_vggt());
  for (SafetensorsStream::Entry& tensor : tensors) {
    if (tensor.name.find(".q_norm.") != std::string::npos || tensor.name.find(".k_norm.") != std::string::npos)
      tensor.shape = {16};
  }
  return MemoryWeights::random(tensors);
}

FeatureMap random_image(int64_t height, int64_t width, uint64_t seed = 1) {
  FeatureMap image(height, width, 3);
  Random random(seed);
  for (float& v : image.data) v = float(random.uniform());
  return image;
}

void expect_finite(const FeatureMap& map) {
  for (const float v : map.data) ASSERT_TRUE(std::isfinite(v));
}

class NetworksTest : public testing::Test {
 protected:
  ThreadPool pool_{2};
  Compute compute_{pool_};
};

std::vector<VggtFrame> run_vggt(Compute& compute, int64_t frames, const VggtRequest& request) {
  const Vggt network(compute, Weights(small_vggt_weights()), small_vggt_options());
  std::vector<FeatureMap> images;
  for (int64_t f = 0; f < frames; ++f) images.push_back(random_image(28, 42, uint64_t(f)));
  std::vector<VggtFrame> out;
  network(compute, images, request, [&](int64_t frame, VggtFrame result) {
    EXPECT_EQ(frame, int64_t(out.size()));
    out.push_back(std::move(result));
  });
  return out;
}

TEST_F(NetworksTest, VggtGivesCamerasDepthAndPointsOfEveryFrame) {
  const std::vector<VggtFrame> frames = run_vggt(compute_, 3, {true, true});
  ASSERT_EQ(frames.size(), 3u);
  for (const VggtFrame& frame : frames) {
    EXPECT_EQ(frame.depth.height, 28);
    EXPECT_EQ(frame.depth.width, 42);
    EXPECT_EQ(frame.depth.channels, 2);
    EXPECT_EQ(frame.points.channels, 4);
    expect_finite(frame.depth);
    expect_finite(frame.points);
    for (int64_t p = 0; p < frame.depth.places(); ++p) {
      ASSERT_GT(frame.depth.data[size_t(2 * p)], 0);
      ASSERT_GE(frame.depth.data[size_t(2 * p + 1)], 1);
    }
    EXPECT_TRUE(std::isfinite(frame.camera.fx));
    EXPECT_EQ(frame.camera.cx, 21);
  }
}

TEST_F(NetworksTest, VggtTakesASingleFrameAndSkipsHeadsNotAskedFor) {
  const std::vector<VggtFrame> frames = run_vggt(compute_, 1, {false, false});
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].depth.data.empty());
}

TEST_F(NetworksTest, TheNumberOfThreadsChangesNoBitOfVggt) {
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    ThreadPool one(1), three(3);
    Compute a(one, {precision, true, true}), b(three, {precision, true, true});
    EXPECT_EQ(run_vggt(a, 2, {true, false})[1].depth.data, run_vggt(b, 2, {true, false})[1].depth.data);
  }
}

TEST_F(NetworksTest, ImagesOfAWrongSizeAreBadInput) {
  const Vit vit(compute_, Weights(MemoryWeights::random(dinov2_tensors(kVit))), {2, {}, 0.1, 1e-6f, false});
  for (const auto& images :
       {std::vector<FeatureMap>{random_image(28, 30)},
        std::vector<FeatureMap>{random_image(28, 28), random_image(28, 42)}, std::vector<FeatureMap>{}}) {
    try {
      vit(compute_, images);
      FAIL() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    }
  }
}

TEST_F(NetworksTest, AWrongShapeInTheMiddleOfANetworkIsNamed) {
  const auto file = MemoryWeights::random(dinov2_tensors(kVit));
  file->set("blocks.2.attn.qkv.weight", {3 * 32, 31}, std::vector<float>(3 * 32 * 31));
  VitOptions options;
  options.heads = 2;
  try {
    Vit(compute_, Weights(file), options);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kWeights);
    EXPECT_EQ(error.details().field, "blocks.2.attn.qkv.weight");
    EXPECT_THAT(error.details().message, HasSubstr("(96, 32) expected, (96, 31) found"));
  }
}

TEST_F(NetworksTest, DepthLiesInItsRangeAtTheSizeOfTheImage) {
  DepthOptions options;
  options.vit.heads = 2;
  options.max_depth = 2;
  const auto network = make_depth_network(compute_, Weights(MemoryWeights::random(dinov2_tensors(kVit))),
                                          Weights(MemoryWeights::random(dpt_head_tensors(kVit, 8))), options);
  const FeatureMap depth = (*network)(compute_, random_image(45, 33));
  EXPECT_EQ(depth.height, 45);
  EXPECT_EQ(depth.width, 33);
  for (const float v : depth.data) {
    ASSERT_GE(v, 0.000999f);
    ASSERT_LE(v, 2);
  }
}

TEST_F(NetworksTest, AHeadOfAnotherBackboneIsRefused) {
  const auto head = std::make_shared<MemoryWeights>();
  head->set("decode_head.conv_seg.weight", {3, 48, 1, 1}, std::vector<float>(3 * 48));
  BnHeadOptions options;
  options.vit.heads = 2;
  EXPECT_THROW(BnHeadNetwork(compute_, Weights(MemoryWeights::random(dinov2_tensors(kVit))), Weights(head), options),
               Error);
}

Mask2FormerSize small_mask2former() {
  Mask2FormerSize size;
  size.backbone = {24, 4, true, 0, 5};
  size.inplane = 4;
  size.deform_heads = 3;
  size.features = 24;
  size.heads = 3;
  size.ffn = 32;
  size.queries = 6;
  size.classes = 5;
  size.encoder_layers = 1;
  size.decoder_layers = 3;
  return size;
}

TEST_F(NetworksTest, Mask2FormerScoresEveryClassAtTheSizeOfTheWindow) {
  Mask2FormerOptions options;
  options.adapter.vit.heads = 3;
  options.groups = 8;
  const Mask2Former network(compute_, Weights(MemoryWeights::random(mask2former_tensors(small_mask2former()))),
                            options);
  EXPECT_EQ(network.classes(), 5);
  const FeatureMap scores = network.predict(compute_, random_image(50, 70));
  EXPECT_EQ(scores.height, 50);
  EXPECT_EQ(scores.width, 70);
  for (const float v : scores.data) {
    ASSERT_GE(v, 0);
    ASSERT_LE(v, 6);  // at most the number of queries
  }
}

TEST_F(NetworksTest, SegmentationGivesProbabilitiesOfThePhotograph) {
  const auto head = MemoryWeights::random({{"decode_head.conv_seg.weight", {3, 32, 1, 1}},
                                           {"decode_head.conv_seg.bias", {3}},
                                           {"decode_head.bn.weight", {32}},
                                           {"decode_head.bn.bias", {32}},
                                           {"decode_head.bn.running_mean", {32}},
                                           {"decode_head.bn.running_var", {32}}});
  BnHeadOptions options;
  options.vit.heads = 2;
  const BnHeadNetwork network(compute_, Weights(MemoryWeights::random(dinov2_tensors(kVit))), Weights(head), options);
  Image<uint8_t> photo(40, 30, 3);
  for (size_t i = 0; i < photo.data.size(); ++i) photo.data[i] = uint8_t(i * 37);
  SegmentationPlan plan;
  plan.resize.short_side = 42;
  plan.window = {28, 28, 20, 20};
  plan.ratios = {1.0, 1.5};
  plan.flip = true;
  const FeatureMap map = segment(compute_, network, photo, plan, photo.height, photo.width);
  ASSERT_EQ(map.places(), 40 * 30);
  for (int64_t p = 0; p < map.places(); ++p) {
    const float* v = map.data.data() + p * 3;
    ASSERT_NEAR(v[0] + v[1] + v[2], 1, 1e-5);
  }
}

/// Names and shapes of a list in tests/data/network_keys: "name [2, 3]" per line, '#' for comments.
std::map<std::string, std::string> published(const std::string& file) {
  std::map<std::string, std::string> tensors;
  const fs::path list = fs::path(ALIGNGS_SOURCE_DIR) / "tests/data/network_keys" / (file + ".gz");
  std::istringstream in(gzip_expanded(read_file(list), list, uint64_t(1) << 20));
  for (std::string line; std::getline(in, line);) {
    const size_t space = line.find(' ');
    if (line.empty() || line[0] == '#' || space == std::string::npos) continue;
    const size_t end = line.find(']');  // a type may follow
    tensors[line.substr(0, space)] = line.substr(space + 1, end == std::string::npos ? end : end - space);
  }
  return tensors;
}

std::string text_of(const std::vector<int64_t>& shape) {
  std::string text = "[";
  for (size_t i = 0; i < shape.size(); ++i) text += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  return text + "]";
}

TEST(RandomWeights, HaveTheNamesAndShapesOfThePublishedFiles) {
  const std::vector<std::pair<std::string, TensorList>> lists = {
      {"vggt_1b.txt", vggt_tensors({})},
      {"m2f_vitg14_head_dims_assumed.txt", mask2former_tensors({})},
      {"dinov2_vits14_pretrain.txt", dinov2_tensors(vit_size('s'))},
      {"dinov2_vitb14_reg4_pretrain.txt", dinov2_tensors(vit_size('b', 4))},
      {"dinov2_vitl14_pretrain.txt", dinov2_tensors(vit_size('l'))},
      {"dinov2_vitg14_pretrain.txt", dinov2_tensors(vit_size('g'))},
      {"dinov2_vitl14_nyu_dpt_head.txt", dpt_head_tensors(vit_size('l'))},
      {"da3_small.txt", da3_tensors(da3_size('s'))},
      {"da3_base.txt", da3_tensors(da3_size('b'))},
      {"da3_metric_large.txt", da3_metric_tensors()},
      {"eomt_large_512_ade20k.txt", eomt_tensors()},
      {"eomt_large_512_ade20k_hf.txt", eomt_huggingface_tensors()},
      {"eomt_large_640_ade20k_panoptic.txt", eomt_tensors({{1024, 24, false, 4, 40}, 200})},
      {"lingbot_vits16_ade20k_linear.txt", lingbot_tensors()}};
  for (const auto& [file, tensors] : lists) {
    std::map<std::string, std::string> expected = published(file);
    for (const SafetensorsStream::Entry& tensor : tensors) {
      const auto found = expected.find(tensor.name);
      ASSERT_NE(found, expected.end()) << file << " has no " << tensor.name;
      EXPECT_EQ(found->second, text_of(tensor.shape)) << tensor.name;
      expected.erase(found);
    }
    for (const auto& left : expected) {
      const bool unused =
          left.first.find("track_head.") == 0 || left.first.find("num_batches_tracked") != std::string::npos;
      EXPECT_TRUE(unused) << file << " also has " << left.first;
    }
  }
}

TEST(RandomWeights, AreWrittenAndTheSameForTheSameSeed) {
  const fs::path folder = fs::path(testing::TempDir()) / "random_weights_test";
  fs::create_directories(folder);
  const TensorList tensors = dinov2_tensors(kVit);
  write_random_weights(folder / "a.safetensors", tensors, 3);
  write_random_weights(folder / "b.safetensors", tensors, 3);
  const Weights a = Weights::open(folder / "a.safetensors"), b = Weights::open(folder / "b.safetensors");
  for (const SafetensorsStream::Entry& tensor : tensors)
    ASSERT_EQ(a.load(tensor.name, tensor.shape), b.load(tensor.name, tensor.shape));
}

}  // namespace
}  // namespace aligngs::nn
