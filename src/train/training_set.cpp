#include "train/training_set.h"

#include <algorithm>
#include <cmath>

#include "core/is_depth.h"
#include "core/quantile.h"
#include "engine/prepare_view.h"
#include "io/resample.h"
#include "scene/prior_maps.h"
#include "scene/view_data.h"
#include "train/loss_schedule.h"

namespace aligngs {
namespace {

// Per pixel of a prepared view: colour, mask, prior depth, its weight, prior normal (3), semantic weight as floats.
// Labels take 2 bytes, label edges 1.
constexpr uint64_t kColorBytes = 3 * 4, kMaskBytes = 4, kDepthBytes = (1 + 1 + 3) * 4, kSemanticBytes = 4 + 2 + 1;
constexpr uint64_t kPlaneBytes = 2;  // number and weight, train/plane_targets.h

constexpr double kNearQuantile = 0.01;  // of a view's depths: a few wrong pixels do not move the near plane

// Free space is cleared 4 % before metric depth, and L_z pulls at 2 %: depth that is farther off would do harm. Without
// points it is the only start, and coarse surfaces are better than random ones.
constexpr double kSureResidual = 0.05, kStartResidual = 0.2;

void decide_depth(const Scene& scene, PriorDepthUse wanted, PriorUse& use) {
  use.depth = PriorDepthKind::kRelative;
  if (wanted == PriorDepthUse::kRelative) {
    use.depth_note = "its correlation with the rendered depth is used, as data.prior_depth says";
    return;
  }
  const bool forced = wanted == PriorDepthUse::kMetric;
  DepthPlacement placement =
      forced && !scene.depth_scale_stated ? as_given(scene.train.size()) : place_prior_depth(scene);
  use.depth_note = describe(placement);
  const double limit = scene.cloud.size() > 0 ? kSureResidual : kStartResidual;
  const bool fits = placement.placed() > 0 &&
                    (placement.scale == DepthScale::kScene || placement.residual.value_or(limit + 1) <= limit);
  if (!fits && !forced) {
    use.depth_note += "; only its correlation with the rendered depth is used";
    return;
  }
  if (placement.placed() == 0) {
    placement = as_given(scene.train.size());
    use.depth_note += "; it is taken in scene units, as data.prior_depth asks for";
  }
  use.depth = PriorDepthKind::kMetric;
  use.placement = std::move(placement);
}

LoadOptions load_options(const TrainConfig& config, const PriorUse& use, size_t training_view) {
  LoadOptions options;
  options.depth_factor = use.depth_factor(training_view);
  options.scale = config.data.scale;
  options.prior_depth = use.depth != PriorDepthKind::kNone;
  options.semantics = use.semantics;
  options.exposure = config.data.exposure;
  options.scores_as_logits = config.data.scores_as_logits;
  options.score_gamma = config.data.score_gamma;
  options.least_score_sum = config.data.least_score_sum;
  return options;
}

/// Empty when the settings or the scene have none for this view.
std::filesystem::path confidence_path(const Scene& scene, const TrainConfig& config, const PriorUse& use, int view) {
  if (!config.data.prior_confidence || use.depth != PriorDepthKind::kMetric) return {};
  const std::filesystem::path path =
      scene.folder / "pred_confidence" / (scene.views[static_cast<size_t>(view)].name + ".npy");
  return std::filesystem::exists(path) ? path : std::filesystem::path();
}

MapShape confidence_shape(const Scene& scene, const std::vector<int64_t>& shape, const std::filesystem::path& path,
                          int view) {
  const MapShape map = depth_map_shape(shape, path);
  const Camera& camera = scene.views[static_cast<size_t>(view)].camera;
  require_same_aspect(map, camera.width, camera.height, path, "shape");
  return map;
}

ImageF load_confidence(const Scene& scene, const std::filesystem::path& path, int view, const Camera& camera) {
  FloatArray array = read_map(path);
  const MapShape shape = confidence_shape(scene, array.shape, path, view);
  ImageF map;
  map.width = shape.width;
  map.height = shape.height;
  map.channels = 1;
  map.data = std::move(array.data);
  for (float& c : map.data) c = std::isfinite(c) ? c : 0.0f;
  return map.width == camera.width && map.height == camera.height ? map
                                                                  : resize_bilinear(map, camera.width, camera.height);
}

}  // namespace

double PriorUse::depth_factor(size_t training_view) const {
  return training_view < placement.views.size() && !is_unplaced(training_view) ? placement.views[training_view].factor
                                                                               : 1;
}

bool PriorUse::is_unplaced(size_t training_view) const {
  return training_view < placement.views.size() && !(placement.views[training_view].factor > 0);
}

void check_prior_confidence(const Scene& scene, const TrainConfig& config, const PriorUse& use) {
  for (const int view : scene.train) {
    const std::filesystem::path path = confidence_path(scene, config, use, view);
    if (!path.empty()) confidence_shape(scene, read_map_header(path).shape, path, view);
  }
}

PriorUse decide_prior_use(const Scene& scene, const TrainConfig& config) {
  PriorUse use;
  const PriorDepthUse wanted = config.data.prior_depth;
  if (wanted != PriorDepthUse::kNone && scene.has_prior_depth()) {
    decide_depth(scene, wanted, use);
  } else if (wanted != PriorDepthUse::kNone) {
    use.warnings.push_back(
        "not every training view has prior depth (pred_depths/): training goes on without depth terms");
  }
  if (config.data.semantics && scene.has_semantics()) {
    use.semantics = true;
  } else if (config.data.semantics) {
    use.warnings.emplace_back(kWithoutLabels);
  }
  return use;
}

Camera working_camera(const Scene& scene, const TrainConfig& config, int view) {
  const Camera& camera = scene.views[static_cast<size_t>(view)].camera;
  return camera.resized(std::max(1, static_cast<int>(std::lround(camera.width * config.data.scale))),
                        std::max(1, static_cast<int>(std::lround(camera.height * config.data.scale))));
}

std::vector<TrainingView> load_training_views(const Scene& scene, const TrainConfig& config, const PriorUse& use,
                                              ThreadPool& pool) {
  std::vector<TrainingView> views(scene.train.size());
  PrepareOptions prepare;
  prepare.paper = config.loss.paper_normals;
  prepare.prior_normals = use.depth == PriorDepthKind::kMetric && settings_need(config, kNeedsPriorNormal);
  // The control of the bounded coupling pushes as much and where it does, so it has the same omega.
  prepare.semantic_weights = is_balanced(config.semantic.coupling) && config.semantic.coupling_strength > 0;
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      ViewData data = load_view(scene, scene.train[i], load_options(config, use, i));
      const std::filesystem::path path = confidence_path(scene, config, use, scene.train[i]);
      ImageF confidence;
      if (!path.empty()) confidence = load_confidence(scene, path, scene.train[i], data.camera);
      views[i] = prepare_view(std::move(data), prepare, confidence.empty() ? nullptr : &confidence);
    }
  });
  return views;
}

uint64_t predicted_view_bytes(const Scene& scene, const TrainConfig& config, const PriorUse& use) {
  uint64_t bytes = 0;
  const bool planes = config.loss.plane_weight > 0 && use.semantics && use.depth == PriorDepthKind::kMetric;
  for (const int v : scene.train) {
    const Camera camera = working_camera(scene, config, v);
    const uint64_t pixels = uint64_t(camera.width) * static_cast<uint64_t>(camera.height);
    uint64_t per_pixel = kColorBytes + kMaskBytes;
    if (use.depth != PriorDepthKind::kNone) per_pixel += kDepthBytes;
    if (use.depth == PriorDepthKind::kMetric) per_pixel += 2 * 4;  // the copy kept for maintenance
    if (use.semantics) {
      per_pixel += kSemanticBytes;
      const View& view = scene.views[static_cast<size_t>(v)];
      const MapShape shape =
          semantic_map_shape(read_map_header(view.semantics).shape, scene.labels.size(), view.semantics);
      const uint64_t texels = uint64_t(shape.width) * static_cast<uint64_t>(shape.height);
      // float16 probabilities, a confidence, a scale and a sum of scores
      bytes += texels * (2 * static_cast<uint64_t>(shape.channels) + 12);
    }
    bytes += pixels * per_pixel;
    if (planes) bytes += pixels * kPlaneBytes;
  }
  return planes ? 2 * bytes : bytes;  // loaded anew for every fit, while the engine still has the views of the last one
}

float near_plane_of(const ImageF& prior_depth, const TrainConfig& config, double extent) {
  const double global = config.train.near_plane * extent;
  std::vector<float> depths;
  for (const float z : prior_depth.data) {
    if (is_depth(z)) depths.push_back(z);
  }
  if (depths.empty() || config.train.near_share <= 0) return static_cast<float>(global);
  const float low = quantile_of(std::move(depths), kNearQuantile);
  return static_cast<float>(std::max(global, config.train.near_share * low));
}

ImageF placed_prior_depth(const Scene& scene, const TrainConfig& config, const PriorUse& use, size_t training_view) {
  if (use.depth != PriorDepthKind::kMetric || use.is_unplaced(training_view)) return {};
  LoadOptions options = load_options(config, use, training_view);
  options.semantics = false;
  return load_view(scene, scene.train[training_view], options).prior_depth;
}

float near_plane_of_view(const Scene& scene, const TrainConfig& config, const PriorUse& use, int view) {
  const auto trained = std::find(scene.train.begin(), scene.train.end(), view);
  const auto index = static_cast<size_t>(trained - scene.train.begin());
  ImageF depth;
  if (trained != scene.train.end() && config.train.near_share > 0)
    depth = placed_prior_depth(scene, config, use, index);
  return near_plane_of(depth, config, robust_extent(scene));
}

std::vector<float> near_planes_of_training_views(const Scene& scene, const TrainConfig& config, const PriorUse& use,
                                                 ThreadPool& pool) {
  std::vector<float> planes(scene.train.size());
  pool.parallel_for(planes.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) planes[i] = near_plane_of_view(scene, config, use, scene.train[i]);
  });
  return planes;
}

int64_t start_limit(const TrainConfig& config, size_t largest_view_pixels) {
  const double per_pixel = config.init.gaussians_per_pixel * static_cast<double>(largest_view_pixels);
  if (per_pixel <= 0) return config.init.max_gaussians;
  return std::clamp<int64_t>(static_cast<int64_t>(per_pixel), 1, config.init.max_gaussians);
}

std::vector<GuideView> guides_of(const std::vector<TrainingView>& views, const PriorUse& use, const TrainConfig& config,
                                 double extent) {
  std::vector<GuideView> guides;
  for (const TrainingView& view : views) {
    const bool unplaced = use.is_unplaced(guides.size());
    GuideView g;
    g.name = view.data.name;
    g.camera = view.data.camera;
    if (use.depth == PriorDepthKind::kMetric) {
      g.prior_depth = view.data.prior_depth;
      g.depth_weight = view.depth_weight;
    }
    g.near_plane = near_plane_of(unplaced ? ImageF() : g.prior_depth, config, extent);
    guides.push_back(std::move(g));
  }
  return guides;
}

}  // namespace aligngs
