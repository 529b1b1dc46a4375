#include "priors/semantic_teacher.h"

#include <algorithm>
#include <cmath>

#include "nn/bn_head.h"
#include "nn/mask2former.h"

namespace aligngs {
namespace {

bool begins(const std::string& text, const char* start) { return text.rfind(start, 0) == 0; }

bool is_mask2former(const PublishedModel& model) { return begins(model.name, "ade20k-m2f"); }

}  // namespace

nn::SegmentationPlan semantic_plan(const PublishedModel& model, bool augment) {
  if (is_mask2former(model)) return nn::mask2former_plan();
  return begins(model.name, "ade20k-ms") ? nn::multi_scale_plan(augment) : nn::linear_plan();
}

void add_semantic_memory(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model,
                         bool augment, const std::vector<NetworkInput>& photos,
                         const NetworkMemoryOptions& options) {
  const nn::SegmentationPlan plan = semantic_plan(model, augment);
  NetworkInput image;
  for (const NetworkInput& photo : photos) {
    const NetworkInput planned = largest_planned_image(plan, int(photo.width), int(photo.height));
    if (planned.width * planned.height > image.width * image.height) image = planned;
  }
  const nn::Weights head = nn::Weights::open(store.require(model).at(0));
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

SemanticTeacher load_semantic_teacher(nn::Compute& compute, const ModelStore& store,
                                      const PublishedModel& model, bool augment,
                                      int mask2former_heads) {
  const std::filesystem::path file = store.require(model).at(0);
  SemanticTeacher teacher;
  teacher.plan = semantic_plan(model, augment);
  if (is_mask2former(model)) {
    nn::Mask2FormerOptions options;
    options.heads = mask2former_heads;
    teacher.network = std::make_unique<nn::Mask2Former>(compute, nn::Weights::open(file), options);
    teacher.kind = SemanticKind::kScores;
    return teacher;
  }
  const std::filesystem::path backbone = store.require(published_model(model.needs.at(0))).at(0);
  teacher.network = std::make_unique<nn::BnHeadNetwork>(compute, nn::Weights::open(backbone),
                                                        nn::Weights::open(file));
  return teacher;
}

TeacherMapSize teacher_map_size(const SemanticTeacher& teacher, int photo_width, int photo_height) {
  constexpr double kStride = 8;
  const double scale =
      teacher.plan.resize.short_side / kStride / std::min(photo_width, photo_height);
  const auto side = [&](int pixels) { return std::max(1, int(std::lround(pixels * scale))); };
  return {side(photo_width), side(photo_height)};
}

nn::FeatureMap teacher_map(nn::Compute& compute, const SemanticTeacher& teacher,
                           const Image<uint8_t>& rgb, int width, int height) {
  const nn::SegmentationPlan& plan = teacher.plan;
  if (plan.ratios.size() == 1 && !plan.flip) {
    nn::SegmentationResize resize = plan.resize;
    resize.short_side = int(resize.short_side * plan.ratios[0]);
    return nn::segmentation_logits(compute, *teacher.network,
                                   nn::normalised_image(nn::segmentation_image(rgb, resize)),
                                   plan.window, height, width);
  }
  nn::FeatureMap sum(height, width, teacher.network->classes());
  const float share = 1.f / float(plan.ratios.size() * (plan.flip ? 2 : 1));
  for (const double ratio : plan.ratios) {
    nn::SegmentationResize resize = plan.resize;
    resize.short_side = int(resize.short_side * ratio);
    const nn::FeatureMap image = nn::normalised_image(nn::segmentation_image(rgb, resize));
    for (int mirrored = 0; mirrored <= int(plan.flip); ++mirrored) {
      nn::FeatureMap map = nn::segmentation_logits(compute, *teacher.network,
                                                   mirrored ? nn::flip_horizontally(image) : image,
                                                   plan.window, height, width);
      nn::softmax_channels(compute, map);
      if (mirrored) map = nn::flip_horizontally(map);
      for (size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += share * map.data[i];
    }
  }
  constexpr float kLeast = 1e-7f;  // of a probability; its logarithm stays within float16
  for (float& v : sum.data) v = std::log(std::max(v, kLeast));
  return sum;
}

}  // namespace aligngs
