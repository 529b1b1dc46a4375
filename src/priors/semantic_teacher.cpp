#include "priors/semantic_teacher.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "nn/bn_head.h"
#include "nn/eomt/eomt_weights.h"
#include "nn/eomt/semantic.h"
#include "nn/lingbot.h"
#include "nn/mask2former.h"
#include "priors/teacher_list.h"

namespace aligngs {
namespace {

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
    if (plan_.images() == 1) {
      const nn::FeatureMap image = nn::shown_image(rgb, plan_, plan_.ratios[0]);
      return nn::segmentation_logits(compute, *network_, image, plan_.window, height, width);
    }
    nn::FeatureMap map = nn::segment(compute, *network_, rgb, plan_, height, width);
    constexpr float kLeast = 1e-7f;  // of a probability; its logarithm stays within float16
    compute.for_rows(height, 1, [&](int64_t y, int64_t, nn::Scratch&) {
      float* values = map.at(y, 0);
      for (int64_t i = 0; i < width * map.channels; ++i) values[i] = std::log(std::max(values[i], kLeast));
    });
    return map;
  }

 private:
  std::unique_ptr<nn::SegmentationNetwork> network_;
  nn::SegmentationPlan plan_;
  SemanticKind kind_;
};

class EomtTeacher : public SemanticTeacher {
 public:
  EomtTeacher(nn::Compute& compute, const std::filesystem::path& file, bool panoptic)
      : panoptic_(panoptic),
        network_(compute, nn::eomt_weights(WeightFile::open(file)), nn::eomt_options_beside(file)) {}

  int64_t classes() const override { return network_.classes(); }
  SemanticKind kind() const override { return SemanticKind::kScores; }
  int short_side() const override { return network_.window(); }
  nn::FeatureMap map(nn::Compute& compute, const Image<uint8_t>& rgb, int width, int height) const override {
    return nn::eomt_scores(compute, network_, rgb, height, width);
  }
  std::optional<SegmentMap> segments(nn::Compute& compute, const Image<uint8_t>& rgb) const override {
    if (!panoptic_) return std::nullopt;
    const nn::EomtPadded padded = nn::eomt_padded(rgb, network_.window());
    const int width = std::min(padded.width, rgb.width), height = std::min(padded.height, rgb.height);
    const nn::PanopticOptions options;
    return segment_map_of(nn::panoptic_map(compute, network_(compute, padded.image), padded, width, height, options),
                          options.stuff);
  }

 private:
  bool panoptic_;
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

nn::SegmentationPlan linear_plan(bool) { return nn::linear_plan(); }
nn::SegmentationPlan mask2former_plan(bool) { return nn::mask2former_plan(); }

void add_eomt(MemoryBudget& budget, const TeacherFiles& files, const nn::SegmentationPlan&,
              const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  double longest = 1;  // long side per short side
  for (const NetworkInput& photo : photos) {
    longest = std::max(longest, double(std::max(photo.width, photo.height)) /
                                    double(std::max<int64_t>(std::min(photo.width, photo.height), 1)));
  }
  add_eomt_memory(budget, nn::eomt_weights(WeightFile::open(files.file)), longest, options);
}
std::unique_ptr<SemanticTeacher> load_eomt(nn::Compute& compute, const TeacherFiles& files, const nn::SegmentationPlan&,
                                           int mask2former_heads) {
  return std::make_unique<EomtTeacher>(compute, files.file, false);
}

/// Masks of all queries at the size of the window and once more: at most so many are kept.
void add_panoptic(MemoryBudget& budget, const TeacherFiles& files, const nn::SegmentationPlan& plan,
                  const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  add_eomt(budget, files, plan, photos, options);
  const nn::Weights weights = nn::eomt_weights(WeightFile::open(files.file));
  const nn::Weights backbone = weights.sub("encoder.backbone.");
  const nn::Shape table = backbone.shape("pos_embed");
  const auto patch = uint64_t(backbone.dimension("patch_embed.proj.weight", 2));
  const uint64_t pixels = uint64_t(table[table.size() - 2]) * patch * patch;
  budget.add("masks of the segments of one photo", pixels * uint64_t(weights.dimension("q.weight", 0)) * sizeof(float));
}
std::unique_ptr<SemanticTeacher> load_panoptic(nn::Compute& compute, const TeacherFiles& files,
                                               const nn::SegmentationPlan&, int mask2former_heads) {
  return std::make_unique<EomtTeacher>(compute, files.file, true);
}

void add_lingbot(MemoryBudget& budget, const TeacherFiles& files, const nn::SegmentationPlan&,
                 const std::vector<NetworkInput>&, const NetworkMemoryOptions& options) {
  add_lingbot_memory(budget, nn::lingbot_weights(WeightFile::open(files.file)), {nn::kLingbotSize, nn::kLingbotSize},
                     options);
}
std::unique_ptr<SemanticTeacher> load_lingbot(nn::Compute& compute, const TeacherFiles& files,
                                              const nn::SegmentationPlan&, int mask2former_heads) {
  return std::make_unique<LingbotTeacher>(compute, files.file);
}

/// The largest image that a plan makes of the photos.
NetworkInput largest_image(const nn::SegmentationPlan& plan, const std::vector<NetworkInput>& photos) {
  NetworkInput image;
  for (const NetworkInput& photo : photos) {
    const NetworkInput planned = largest_planned_image(plan, int(photo.width), int(photo.height));
    if (planned.width * planned.height > image.width * image.height) image = planned;
  }
  return image;
}

void add_mask2former(MemoryBudget& budget, const TeacherFiles& files, const nn::SegmentationPlan& plan,
                     const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  const NetworkInput image = largest_image(plan, photos);
  const nn::Weights head = nn::Weights::open(files.file);
  add_mask2former_memory(budget, head, planned_window(plan, image), options);
  add_sliding_memory(budget, plan, image, head.dimension("decode_head.cls_embed.weight", 0) - 1);
}
std::unique_ptr<SemanticTeacher> load_mask2former(nn::Compute& compute, const TeacherFiles& files,
                                                  const nn::SegmentationPlan& plan, int mask2former_heads) {
  nn::Mask2FormerOptions options;
  options.heads = mask2former_heads;
  return std::make_unique<WindowedTeacher>(
      std::make_unique<nn::Mask2Former>(compute, nn::Weights::open(files.file), options), plan, SemanticKind::kScores);
}

void add_head(MemoryBudget& budget, const TeacherFiles& files, const nn::SegmentationPlan& plan,
              const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  const NetworkInput image = largest_image(plan, photos);
  const nn::Weights head = nn::Weights::open(files.file), backbone = nn::Weights::open(files.backbone.value());
  add_bn_head_memory(budget, backbone, head, planned_window(plan, image), options);
  add_sliding_memory(budget, plan, image, head.dimension("decode_head.conv_seg.weight", 0));
}
std::unique_ptr<SemanticTeacher> load_head(nn::Compute& compute, const TeacherFiles& files,
                                           const nn::SegmentationPlan& plan, int mask2former_heads) {
  return std::make_unique<WindowedTeacher>(
      std::make_unique<nn::BnHeadNetwork>(compute, nn::Weights::open(files.backbone.value()),
                                          nn::Weights::open(files.file)),
      plan, SemanticKind::kLogits);
}

const SemanticFamily& semantic_family(const PublishedModel& model) {
  const Teacher* const row = find_teacher(model.name);
  if (row && row->classes) return *row->classes;
  throw_usage(model.name + " is no network for classes", "see `aligngs priors --help` for the names");
}

TeacherFiles files_of(const ModelStore& store, const PublishedModel& model) {
  TeacherFiles files{store.require(model).at(0), {}};
  if (!model.needs.empty()) files.backbone = store.require(published_model(model.needs.at(0))).at(0);
  return files;
}

}  // namespace

const SemanticFamily kMask2FormerClasses = {mask2former_plan, add_mask2former, load_mask2former};
const SemanticFamily kEomtClasses = {linear_plan, add_eomt, load_eomt};
const SemanticFamily kPanopticClasses = {linear_plan, add_panoptic, load_panoptic, true};
const SemanticFamily kLingbotClasses = {linear_plan, add_lingbot, load_lingbot};
const SemanticFamily kMultiScaleClasses = {nn::multi_scale_plan, add_head, load_head};
const SemanticFamily kLinearClasses = {linear_plan, add_head, load_head};

std::optional<SegmentMap> SemanticTeacher::segments(nn::Compute&, const Image<uint8_t>&) const { return std::nullopt; }

SegmentMap segment_map_of(const nn::PanopticMap& panoptic, const std::vector<int>& stuff) {
  SegmentMap out;
  out.width = panoptic.width;
  out.height = panoptic.height;
  std::vector<size_t> order(panoptic.list.size());  // by class, then id
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return panoptic.list[a].category < panoptic.list[b].category; });
  std::vector<uint16_t> index(panoptic.list.size());
  for (const size_t i : order) {
    const auto label = static_cast<uint16_t>(panoptic.list[i].category);
    const bool together = std::find(stuff.begin(), stuff.end(), int(label)) != stuff.end();
    const bool follows = !out.list.empty() && out.list.back().label == label;
    const auto number = static_cast<uint16_t>(together ? Segment::kStuff : follows ? out.list.back().number + 1 : 0);
    if (!together && number >= Segment::kStuff)
      throw Error({ErrorKind::kFailed, "the network finds more things of one class than a file holds", {}, {}, {}});
    index[i] = static_cast<uint16_t>(out.list.size());
    out.list.push_back({label, number});
  }
  out.of_pixel.reserve(panoptic.segments.size());
  for (const int id : panoptic.segments) out.of_pixel.push_back(id < 0 ? SegmentMap::kNone : index[size_t(id)]);
  return out;
}

TeacherMapSize SemanticTeacher::map_size(int photo_width, int photo_height) const {
  constexpr double kStride = 8;
  const double scale = short_side() / kStride / std::min(photo_width, photo_height);
  const auto side = [&](int pixels) { return std::max(1, int(std::lround(pixels * scale))); };
  return {side(photo_width), side(photo_height)};
}

nn::SegmentationPlan semantic_plan(const PublishedModel& model, bool augment) {
  return semantic_family(model).plan(augment);
}

bool makes_segments(const PublishedModel& model) { return semantic_family(model).segments; }

void add_semantic_memory(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model, bool augment,
                         const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  const SemanticFamily& family = semantic_family(model);
  family.add_memory(budget, files_of(store, model), family.plan(augment), photos, options);
}

std::unique_ptr<SemanticTeacher> load_semantic_teacher(nn::Compute& compute, const ModelStore& store,
                                                       const PublishedModel& model, bool augment,
                                                       int mask2former_heads) {
  const SemanticFamily& family = semantic_family(model);
  return family.load(compute, files_of(store, model), family.plan(augment), mask2former_heads);
}

}  // namespace aligngs
