// Weights of the published networks' sizes with random values: for measuring shapes, memory and
// time without the publishers' files. Predictions of such a network mean nothing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/safetensors_stream.h"

namespace aligngs::nn {

using TensorList = std::vector<SafetensorsStream::Entry>;

/// ViT-S, B, L, g: 384, 12, false; 768, 12, false; 1024, 24, false; 1536, 40, true.
struct VitSize {
  int64_t channels = 384, depth = 12;
  bool gated = false;  ///< SwiGLU
  int64_t registers = 0;
  int64_t grid = 37;  ///< trained places per side
  int64_t hidden() const { return gated ? (channels * 8 / 3 + 7) / 8 * 8 : 4 * channels; }
};
VitSize vit_size(char letter, int64_t registers = 0);  ///< 's', 'b', 'l', 'g'

struct VggtSize {
  VitSize encoder{1024, 24, false, 4, 37};
  int64_t depth = 24, camera_depth = 4, features = 256;
  std::vector<int64_t> levels = {256, 512, 1024, 1024};
};

struct Mask2FormerSize {
  VitSize backbone{1536, 40, true, 0, 37};
  int64_t inplane = 64, deform_heads = 24, features = 1536, heads = 24, ffn = 6144;
  int64_t queries = 100, classes = 150, encoder_layers = 6, decoder_layers = 9;
};

/// Depth Anything 3, any-view; the default is Base.
struct Da3Size {
  VitSize encoder{768, 12, false, 0, 37};
  int64_t heads = 12;
  int64_t alternate_from = 4;  ///< the first block with norms of queries and keys
  int64_t features = 128, camera_depth = 4;
  std::vector<int64_t> levels = {96, 192, 384, 768};
};
Da3Size da3_size(char letter);  ///< 's', 'b', 'l'

/// DA3METRIC-LARGE and DA3MONO-LARGE.
struct Da3MetricSize {
  VitSize encoder{1024, 24, false, 0, 37};
  int64_t features = 256;
  std::vector<int64_t> levels = {256, 512, 1024, 1024};
};

/// EoMT-L, semantic at 512. Panoptic at 640: 200 queries, 40 places per side.
struct EomtSize {
  VitSize encoder{1024, 24, false, 4, 32};
  int64_t queries = 100, query_blocks = 4, classes = 150;
};

/// LingBot-Vision-S with its linear head.
struct LingbotSize {
  VitSize encoder{384, 12, false, 4, 0};
  int64_t heads = 6, classes = 150;
};

/// Names and shapes as published. `prefix` precedes every name.
TensorList dinov2_tensors(const VitSize& size, const std::string& prefix = "");
TensorList dpt_head_tensors(const VitSize& size, int64_t features = 256);
/// Segmentation heads on `inputs` features (linear: the channels of the backbone; ms: four times).
TensorList bn_head_tensors(int64_t inputs, int64_t classes = 150);
/// Linear depth heads; `inputs`: twice the channels, times the layers.
TensorList linear_depth_tensors(int64_t inputs, int64_t bins = 256);
/// LPIPS: VGG16's convolutions, and the weights of its five stages.
TensorList vgg16_tensors(const std::vector<int64_t>& widths = {64, 128, 256, 512, 512});
TensorList lpips_tensors(const std::vector<int64_t>& widths = {64, 128, 256, 512, 512});
TensorList vggt_tensors(const VggtSize& size);  ///< without the tracker
TensorList mask2former_tensors(const Mask2FormerSize& size);
TensorList da3_tensors(const Da3Size& size);
TensorList da3_metric_tensors(const Da3MetricSize& size = {});
TensorList eomt_tensors(const EomtSize& size = {});              ///< the publisher's names
TensorList eomt_huggingface_tensors(const EomtSize& size = {});  ///< Hugging Face's
TensorList lingbot_tensors(const LingbotSize& size = {});        ///< LibreYOLO's file

/// Writes them to a safetensors file in half precision, one after the other. Values are such that
/// activations stay of the order of one, and VGGT's cameras are ones that photographs could have;
/// equal seeds give equal files.
void write_random_weights(const std::filesystem::path& path, const TensorList& tensors, uint64_t seed);

}  // namespace aligngs::nn
