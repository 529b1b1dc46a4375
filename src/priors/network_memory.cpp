#include "priors/network_memory.h"

#include <algorithm>
#include <functional>
#include <string>

namespace aligngs {
namespace {

constexpr uint64_t kFloat = 4;  // bytes
constexpr int64_t kPatch = 14;  // pixels, of every DINOv2
/// Memory that the allocator keeps beyond the used share: freed maps of other sizes. Measured: 8 to
/// 14 %.
constexpr double kAllocatorShare = 0.15;
constexpr uint64_t kProgram = 50'000'000;  // bytes: code, libraries, photos on their way

uint64_t operand_bytes(const NetworkMemoryOptions& options) { return nn::bytes_of_operand(options.precision); }

uint64_t round_up(int64_t n, int64_t unit) { return uint64_t((n + unit - 1) / unit * unit); }

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

/// Matrices as they lie packed; `exact` says which stay in float32. Vectors are small either way.
uint64_t weight_bytes(const nn::Weights& weights, const NetworkMemoryOptions& options,
                      const std::function<bool(const std::string&)>& exact) {
  uint64_t bytes = 0;
  for (const std::string& name : weights.names()) {
    uint64_t count = 1;
    for (const int64_t n : weights.shape(name)) count *= uint64_t(n);
    bytes += count * (exact(name) ? kFloat : nn::bytes_of_weight(options.precision));
  }
  return bytes;
}

bool never(const std::string&) { return false; }

/// Working memory of a transformer: the stream, an update of it, operands of attention, and rows of the
/// widest layer for each thread.
uint64_t transformer_bytes(const nn::Weights& backbone, uint64_t tokens, uint64_t kept_layers,
                           const NetworkMemoryOptions& options) {
  constexpr uint64_t kStream = 3, kOperands = 3, kRows = 288;  // rows: nn::product_rows
  const auto channels = uint64_t(backbone.dimension("cls_token", 2));
  uint64_t widest = 4 * channels;
  if (backbone.has("blocks.0.mlp.w12.weight"))
    widest = uint64_t(backbone.dimension("blocks.0.mlp.w12.weight", 0)) * 3 / 2;  // and its gated half
  const uint64_t rows = uint64_t(options.threads) * kRows * (widest + 4 * channels) * kFloat;
  return tokens * channels * ((kStream + kept_layers) * kFloat + kOperands * operand_bytes(options)) + rows;
}

void add_overhead(MemoryBudget& budget, uint64_t work_bytes) {
  budget.add("what the allocator keeps, and the program", uint64_t(kAllocatorShare * double(work_bytes)) + kProgram);
}

void add_work(MemoryBudget& budget, const char* what, uint64_t bytes) {
  budget.add(what, bytes);
  add_overhead(budget, bytes);
}

}  // namespace

void add_mask2former_memory(MemoryBudget& budget, const nn::Weights& weights, const NetworkInput& window,
                            const NetworkMemoryOptions& options) {
  // As nn/mask2former.cpp and nn/pixel_decoder.cpp have it: the decoder and what leads to the mask
  // logits are float32 whatever the precision.
  const auto exact = [](const std::string& name) {
    if (contains(name, "sampling_offsets") || contains(name, "attention_weights")) return true;
    if (!contains(name, "decode_head.")) return false;
    return !contains(name, "pixel_decoder.encoder.") && !contains(name, "output_convs.");
  };
  budget.add("weights of the network", weight_bytes(weights, options, exact));
  const nn::Weights backbone = weights.sub("backbone.");
  const auto channels = uint64_t(backbone.dimension("cls_token", 2));
  const auto features = uint64_t(weights.dimension("decode_head.pixel_decoder.mask_feature.weight", 0));
  constexpr int64_t kCoarsest = 32;
  const uint64_t width = round_up(window.width, kCoarsest), height = round_up(window.height, kCoarsest);
  const uint64_t quarter = width / 4 * (height / 4);
  const uint64_t coarser = quarter / 4 + quarter / 16 + quarter / 64;
  const uint64_t tokens = width / kPatch * (height / kPatch) + 1;
  // The peak is where the pixel decoder makes its finest map. The backbone's four maps are still there. The coarser
  // levels hold the tokens, their positions and the copies handed on. The finest holds the map before, the map after
  // and the operand of the convolution between them.
  constexpr uint64_t kCopies = 3;
  const uint64_t maps = (quarter + coarser) * channels * kFloat;
  const uint64_t decoder = features * (kCopies * coarser * kFloat + quarter * (2 * kFloat + operand_bytes(options)));
  budget.add("maps of the backbone", maps);
  budget.add("maps of the pixel decoder", decoder);
  const uint64_t rest = transformer_bytes(backbone, tokens, 0, options);
  budget.add("tokens in work", rest);
  add_overhead(budget, maps + decoder + rest);
}

void add_bn_head_memory(MemoryBudget& budget, const nn::Weights& backbone, const nn::Weights& head,
                        const NetworkInput& window, const NetworkMemoryOptions& options) {
  const uint64_t weights = weight_bytes(backbone, options, never) + weight_bytes(head, options, never);
  budget.add("weights of the network", weights);
  const auto channels = uint64_t(backbone.dimension("cls_token", 2));
  const auto classes = uint64_t(head.dimension("decode_head.conv_seg.weight", 0));
  const uint64_t layers = uint64_t(head.dimension("decode_head.conv_seg.weight", 1)) / channels;
  const uint64_t places = round_up(window.width, kPatch) / kPatch * (round_up(window.height, kPatch) / kPatch);
  constexpr uint64_t kJoined = 2;  // the layers kept, and all of them side by side
  add_work(budget, "tokens and values of one window",
           transformer_bytes(backbone, places + 1, kJoined * layers, options) + places * classes * kFloat +
               uint64_t(window.width) * uint64_t(window.height) * classes * kFloat);
}

void add_depth_network_memory(MemoryBudget& budget, const nn::Weights& backbone, const nn::Weights& head,
                              const NetworkInput& image, const NetworkMemoryOptions& options) {
  budget.add("weights of the network", weight_bytes(backbone, options, never) + weight_bytes(head, options, never));
  const uint64_t places = round_up(image.width, kPatch) / kPatch * (round_up(image.height, kPatch) / kPatch);
  const auto channels = uint64_t(backbone.dimension("cls_token", 2));
  uint64_t layers = 4, per_place = 0;
  if (head.has("decode_head.conv_depth.weight")) {
    const auto bins = uint64_t(head.dimension("decode_head.conv_depth.weight", 0));
    layers = uint64_t(head.dimension("decode_head.conv_depth.weight", 1)) / (2 * channels);
    constexpr uint64_t kFiner = 17;  // the grid and its enlargement by 4 x 4
    per_place = bins * kFiner * kFloat + 2 * channels * layers * kFloat;
  } else {
    // The peak is the last convolution but one, at 16 x 16 places of a token. It holds its input, the operand made of
    // it and its output. The four levels of 4 x 4, 2 x 2, 1 and 1/4 places are still there.
    const auto features = uint64_t(head.dimension("decode_head.convs.0.conv.weight", 0));
    const auto input = uint64_t(head.dimension("decode_head.conv_depth.head.0.weight", 0));
    const auto output = uint64_t(head.dimension("decode_head.conv_depth.head.2.weight", 0));
    constexpr uint64_t kFinest = 256, kLevels = 22;
    per_place = kFinest * (input * (kFloat + operand_bytes(options)) + output * kFloat) + kLevels * features * kFloat;
  }
  constexpr uint64_t kImages = 5;  // photo, normalised, padded, depth twice: floats per pixel
  const uint64_t pixels = uint64_t(image.width) * uint64_t(image.height);
  add_work(budget, "tokens and maps of one photo",
           transformer_bytes(backbone, places + 1, layers, options) + places * per_place + kImages * pixels * kFloat);
}

void add_eomt_memory(MemoryBudget& budget, const nn::Weights& weights, double aspect,
                     const NetworkMemoryOptions& options) {
  // As nn/eomt/eomt.cpp has it: the heads of the queries are float32 whatever the precision.
  const auto exact = [](const std::string& name) {
    return contains(name, "class_head.") || contains(name, "mask_head.");
  };
  budget.add("weights of the network", weight_bytes(weights, options, exact));
  const nn::Weights backbone = weights.sub("encoder.backbone.");
  const auto channels = uint64_t(backbone.dimension("cls_token", 2));
  const auto queries = uint64_t(weights.dimension("q.weight", 0));
  const auto classes = uint64_t(weights.dimension("class_head.weight", 0)) - 1;
  const auto patch = uint64_t(backbone.dimension("patch_embed.proj.weight", 2));
  const nn::Shape table = backbone.shape("pos_embed");
  const auto places = uint64_t(table[table.size() - 2]);  // of the window's grid
  const uint64_t registers = backbone.has("register_tokens") ? uint64_t(backbone.dimension("register_tokens", 1)) : 0;
  // The peak is the last upscaling: its input, the grown map and the mixed one, and the masks made of it.
  constexpr uint64_t kFinest = 16, kMaps = 3;  // places at 1/4 per patch of 16
  const uint64_t finest = places * kFinest;
  const uint64_t maps = (kMaps * finest + finest / 4) * channels * kFloat + finest * queries * kFloat;
  const uint64_t tokens = transformer_bytes(backbone, places + 1 + registers + queries, 0, options);
  const uint64_t pixels = places * patch * patch;
  const auto photo = uint64_t(double(pixels) * aspect);
  add_work(budget, "tokens, maps or values of one window", std::max({maps, tokens, pixels * classes * kFloat}));
  budget.add("values of the whole photo", photo * classes * kFloat);
}

void add_lingbot_memory(MemoryBudget& budget, const nn::Weights& weights, const NetworkInput& window,
                        const NetworkMemoryOptions& options) {
  budget.add("weights of the network", weight_bytes(weights, options, never));
  const nn::Weights backbone = weights.sub("backbone.");
  const auto classes = uint64_t(weights.dimension("predict.weight", 0));
  const int64_t patch = std::max<int64_t>(backbone.dimension("patch_embed.proj.weight", 2), 1);
  const uint64_t places = uint64_t((window.width / patch) * (window.height / patch));
  const auto registers = uint64_t(backbone.dimension("register_tokens", 1));
  constexpr uint64_t kFiner = 4;  // the stored map has four values per patch
  add_work(budget, "tokens and values of one photo",
           transformer_bytes(backbone, places + 1 + registers, 1, options) + places * (1 + kFiner) * classes * kFloat +
               uint64_t(window.width) * uint64_t(window.height) * 3 * kFloat);
}

NetworkInput largest_planned_image(const nn::SegmentationPlan& plan, int photo_width, int photo_height) {
  NetworkInput largest;
  for (const double ratio : plan.ratios) {
    const nn::ImageSize size = nn::segmentation_size(photo_width, photo_height, plan.resize_at(ratio));
    if (int64_t(size.width) * size.height > largest.width * largest.height) largest = {size.width, size.height};
  }
  return largest;
}

NetworkInput planned_window(const nn::SegmentationPlan& plan, const NetworkInput& image) {
  if (plan.window.crop_width <= 0 || plan.window.crop_height <= 0) return image;
  return {std::min(plan.window.crop_width, image.width), std::min(plan.window.crop_height, image.height)};
}

void add_sliding_memory(MemoryBudget& budget, const nn::SegmentationPlan& plan, const NetworkInput& image,
                        int64_t classes) {
  const NetworkInput window = planned_window(plan, image);
  const uint64_t pixels = uint64_t(image.width) * uint64_t(image.height);
  constexpr uint64_t kImages = 3;  // resized, normalised, one window of it: floats of three channels
  uint64_t bytes = kImages * 3 * pixels * kFloat;
  if (window.width < image.width || window.height < image.height) bytes += pixels * uint64_t(classes) * kFloat;
  budget.add("values of the whole photo", bytes);
}

}  // namespace aligngs
