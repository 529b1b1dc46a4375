#include "priors/semantic_teacher.h"

#include <algorithm>
#include <cmath>

#include "nn/bn_head.h"
#include "nn/eomt/eomt_weights.h"
#include "nn/eomt/semantic.h"
#include "nn/lingbot.h"
#include "nn/mask2former.h"

namespace aligngs {
namespace {

bool begins(const std::string& text, const char* start) { return text.rfind(start, 0) == 0; }

bool is_mask2former(const PublishedModel& model) { return begins(model.name, "ade20k-m2f"); }
bool is_eomt(const PublishedModel& model) { return begins(model.name, "eomt-"); }
bool is_lingbot(const PublishedModel& model) { return begins(model.name, "lingbot-"); }

/// Logits or scores of windows; with several ratios or mirrored the logarithm of the averaged probabilities, which
/// softmax turns back into them.
class WindowedTeacher : public SemanticTeacher {
 public:
  WindowedTeacher(std::unique_ptr<nn::SegmentationNetwork> network, nn::SegmentationPlan plan, SemanticKind kind)
      : network_(std::move(network)), plan_(std::move(plan)), kind_(kind) {}

  int64_t classes() const override { return network_->classes(); }
  SemanticKind kind() const override { return kind_; }
  int short_side() const override { return plan_.resize.short_side; }

  nn::FeatureMap map(nn::Compute& compute, const Image<uint8_t>& rgb, int width, int height) const override {
    if (plan_.ratios.size() == 1 && !plan_.flip) {
      const nn::FeatureMap image = scaled(rgb, plan_.ratios[0]);
      return nn::segmentation_logits(compute, *network_, image, plan_.window, height, width);
    }
    nn::FeatureMap sum(height, width, network_->classes());
    const float share = 1.f / float(plan_.ratios.size() * (plan_.flip ? 2 : 1));
    for (const double ratio : plan_.ratios) {
      const nn::FeatureMap image = scaled(rgb, ratio);
      for (int mirrored = 0; mirrored <= int(plan_.flip); ++mirrored) {
        nn::FeatureMap map = nn::segmentation_logits(
            compute, *network_, mirrored ? nn::flip_horizontally(image) : image, plan_.window, height, width);
        nn::softmax_channels(compute, map);
        if (mirrored) map = nn::flip_horizontally(map);
        for (size_t i = 0; i < map.data.size(); ++i) sum.data[i] += share * map.data[i];
      }
    }
    constexpr float kLeast = 1e-7f;  // of a probability; its logarithm stays within float16
    for (float& v : sum.data) v = std::log(std::max(v, kLeast));
    return sum;
  }

 private:
  nn::FeatureMap scaled(const Image<uint8_t>& rgb, double ratio) const {
    nn::SegmentationResize resize = plan_.resize;
    resize.short_side = int(resize.short_side * ratio);
    return nn::normalised_image(nn::segmentation_image(rgb, resize));
  }

  std::unique_ptr<nn::SegmentationNetwork> network_;
  nn::SegmentationPlan plan_;
  SemanticKind kind_;
};

class EomtTeacher : public SemanticTeacher {
 public:
  EomtTeacher(nn::Compute& compute, const std::filesystem::path& file)
      : network_(compute, nn::eomt_weights(WeightFile::open(file)), nn::eomt_options_beside(file)) {}

  int64_t classes() const override { return network_.classes(); }
  SemanticKind kind() const override { return SemanticKind::kScores; }
  int short_side() const override { return network_.window(); }
  nn::FeatureMap map(nn::Compute& compute, const Image<uint8_t>& rgb, int width, int height) const override {
    return nn::eomt_scores(compute, network_, rgb, height, width);
  }

 private:
  nn::Eomt network_;
};

class LingbotTeacher : public SemanticTeacher {
 public:
  LingbotTeacher(nn::Compute& compute, const std::filesystem::path& file)
      : network_(compute, nn::lingbot_weights(WeightFile::open(file))) {}

  int64_t classes() const override { return network_.classes(); }
  SemanticKind kind() const override { return SemanticKind::kLogits; }
  int short_side() const override { return nn::kLingbotSize; }
  nn::FeatureMap map(nn::Compute& compute, const Image<uint8_t>& rgb, int width, int height) const override {
    return network_.photo_logits(compute, rgb, height, width);
  }

 private:
  nn::LingbotNetwork network_;
};

}  // namespace

TeacherMapSize SemanticTeacher::map_size(int photo_width, int photo_height) const {
  constexpr double kStride = 8;
  const double scale = short_side() / kStride / std::min(photo_width, photo_height);
  const auto side = [&](int pixels) { return std::max(1, int(std::lround(pixels * scale))); };
  return {side(photo_width), side(photo_height)};
}

nn::SegmentationPlan semantic_plan(const PublishedModel& model, bool augment) {
  if (is_mask2former(model)) return nn::mask2former_plan();
  return begins(model.name, "ade20k-ms") ? nn::multi_scale_plan(augment) : nn::linear_plan();
}

void add_semantic_memory(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model,
                         bool augment, const std::vector<NetworkInput>& photos,
                         const NetworkMemoryOptions& options) {
  const std::filesystem::path file = store.require(model).at(0);
  if (is_eomt(model)) {
    double longest = 1;  // long side per short side
    for (const NetworkInput& photo : photos) {
      longest = std::max(longest, double(std::max(photo.width, photo.height)) /
                                      double(std::max<int64_t>(std::min(photo.width, photo.height), 1)));
    }
    return add_eomt_memory(budget, nn::eomt_weights(WeightFile::open(file)), longest, options);
  }
  if (is_lingbot(model)) {
    return add_lingbot_memory(budget, nn::lingbot_weights(WeightFile::open(file)),
                              {nn::kLingbotSize, nn::kLingbotSize}, options);
  }
  const nn::SegmentationPlan plan = semantic_plan(model, augment);
  NetworkInput image;
  for (const NetworkInput& photo : photos) {
    const NetworkInput planned = largest_planned_image(plan, int(photo.width), int(photo.height));
    if (planned.width * planned.height > image.width * image.height) image = planned;
  }
  const nn::Weights head = nn::Weights::open(file);
  const NetworkInput window = planned_window(plan, image);
  if (is_mask2former(model)) {
    add_mask2former_memory(budget, head, window, options);
    add_sliding_memory(budget, plan, image, head.dimension("decode_head.cls_embed.weight", 0) - 1);
    return;
  }
  const nn::Weights backbone =
      nn::Weights::open(store.require(published_model(model.needs.at(0))).at(0));
  add_bn_head_memory(budget, backbone, head, window, options);
  add_sliding_memory(budget, plan, image, head.dimension("decode_head.conv_seg.weight", 0));
}

std::unique_ptr<SemanticTeacher> load_semantic_teacher(nn::Compute& compute, const ModelStore& store,
                                                       const PublishedModel& model, bool augment,
                                                       int mask2former_heads) {
  const std::filesystem::path file = store.require(model).at(0);
  if (is_eomt(model)) return std::make_unique<EomtTeacher>(compute, file);
  if (is_lingbot(model)) return std::make_unique<LingbotTeacher>(compute, file);
  const nn::SegmentationPlan plan = semantic_plan(model, augment);
  if (is_mask2former(model)) {
    nn::Mask2FormerOptions options;
    options.heads = mask2former_heads;
    return std::make_unique<WindowedTeacher>(
        std::make_unique<nn::Mask2Former>(compute, nn::Weights::open(file), options), plan, SemanticKind::kScores);
  }
  const std::filesystem::path backbone = store.require(published_model(model.needs.at(0))).at(0);
  return std::make_unique<WindowedTeacher>(
      std::make_unique<nn::BnHeadNetwork>(compute, nn::Weights::open(backbone), nn::Weights::open(file)), plan,
      SemanticKind::kLogits);
}

}  // namespace aligngs
