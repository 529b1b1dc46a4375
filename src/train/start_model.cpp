#include "train/start_model.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/log.h"
#include "gaussians/initialise.h"
#include "scene/depth_cloud.h"
#include "train/far_shell.h"

namespace aligngs {
namespace {

// each round enlarges the cubes by at least a few per cent; 2 suffice in practice
constexpr int kThinningRounds = 8;
constexpr double kThinningMargin = 1.02;  // so that a round that lands just above the cap is not repeated in vain
// Depths of random points, shares of the extent: from arm's length to across the room.
constexpr double kRandomNear = 0.1, kRandomFar = 2.0;

float opacity_logit(double opacity) { return static_cast<float>(std::log(opacity / (1 - opacity))); }

// Uncertain depth still helps to find the surface. It counts this much in the start (the fusion drops weights below
// 0.05). It fills places without certain depth, and is outvoted elsewhere.
constexpr float kLeastStartWeight = 0.06f;

/// By how much cubes must grow when n points are too many: points of a surface fall with the square of the edge.
double growth(size_t n, int64_t cap) {
  return std::sqrt(static_cast<double>(n) / static_cast<double>(cap)) * kThinningMargin;
}

// of the Gaussians, that a far background may take
constexpr int64_t kShellShare = 8;

/// Points of a far background; none where the settings or the depth ask for none.
PointCloud shell_of(const StartInputs& in) {
  if (!in.config.init.far_shell || !in.sensor_depth) return {};
  const MeasuredHull room = measured_room(in.views, in.depth_scales);
  return far_shell(in.views, room, in.extent, static_cast<size_t>(in.max_gaussians / kShellShare));
}

/// Appends points that one view alone knows.
void append_shell(const PointCloud& shell, DepthCloud& fused) {
  PointCloud& cloud = fused.cloud;
  cloud.positions.insert(cloud.positions.end(), shell.positions.begin(), shell.positions.end());
  cloud.colors.insert(cloud.colors.end(), shell.colors.begin(), shell.colors.end());
  if (!cloud.normals.empty()) cloud.normals.insert(cloud.normals.end(), shell.normals.begin(), shell.normals.end());
  fused.views.insert(fused.views.end(), shell.size(), 1);
}

DepthCloud fuse(const StartInputs& in, size_t most) {
  std::vector<ImageF> depths, weights;  // changed copies
  depths.reserve(in.views.size());
  weights.reserve(in.views.size());
  std::vector<DepthCloudView> sources;
  for (size_t v = 0; v < in.views.size(); ++v) {
    const TrainingView& view = in.views[v];
    depths.push_back(view.data.prior_depth);
    for (float& z : depths.back().data) z *= in.depth_scales[v];
    DepthCloudView source;
    source.camera = view.data.camera;
    source.depth = &depths.back();
    source.color = &view.data.color;
    weights.push_back(view.depth_weight);
    for (float& w : weights.back().data) w = std::max(w, kLeastStartWeight);
    source.confidence = weights.back().empty() ? nullptr : &weights.back();
    sources.push_back(source);
  }
  DepthCloudOptions options;
  options.max_points = most;
  options.voxel_footprints = in.config.init.voxel_footprints;
  options.keep_single_view = in.config.init.single_view_opacity > 0;
  return fuse_depth_cloud(sources, options, in.pool);
}

StartModel start_from_depth(const StartInputs& in) {
  const InitConfig& c = in.config.init;
  const PointCloud shell = shell_of(in);
  DepthCloud fused = fuse(in, static_cast<size_t>(in.max_gaussians) - shell.size());
  StartModel start;
  if (fused.cloud.size() == 0) return start;
  if (shell.size() > 0) {
    append_shell(shell, fused);
    log_info("far background: {} Gaussians behind the room, where the sensor measured nothing", shell.size());
  }
  InitialiseOptions options;
  options.semantic_channels = in.semantic_channels;
  options.opacity = static_cast<float>(c.depth_opacity);
  options.flat_ratio = static_cast<float>(c.depth_flat_ratio);
  options.scale_max = static_cast<float>(c.scale_max * in.extent);
  start.model = initialise_gaussians(fused.cloud, options);
  for (size_t i = 0; i < fused.views.size(); ++i) {
    if (fused.views[i] < 2) start.model.opacity_logits[i] = opacity_logit(c.single_view_opacity);
  }
  start.dense = true;
  start.has_normals = fused.cloud.has_normals();
  return start;
}

StartModel start_from_cloud(const StartInputs& in, PointCloud cloud) {
  const InitConfig& c = in.config.init;
  // A first edge that surely merges something: the extent over the square root of the cap.
  double edge = in.extent / std::sqrt(static_cast<double>(in.max_gaussians));
  const PointCloud all = cloud;
  for (int round = 0; round<kThinningRounds&& static_cast<int64_t>(cloud.size())> in.max_gaussians; ++round) {
    cloud = voxel_thin(all, edge);
    edge *= std::max(growth(cloud.size(), in.max_gaussians), kThinningMargin);
  }
  StartModel start;
  start.has_normals = cloud.has_normals();
  InitialiseOptions options;
  options.semantic_channels = in.semantic_channels;
  options.opacity = static_cast<float>(c.cloud_opacity);
  options.flat_ratio = start.has_normals ? static_cast<float>(c.cloud_flat_ratio) : 1.0f;
  options.use_normals = options.flat_ratio < 1;
  options.scale_max = static_cast<float>(c.scale_max * in.extent);
  start.has_normals = options.use_normals;
  start.model = initialise_gaussians(cloud, options);
  return start;
}

/// Random colours at random depths along random rays of the training views: knows the cameras and nothing else.
PointCloud random_cloud(const StartInputs& in, Random& random) {
  PointCloud cloud;
  const int64_t count = std::min(in.config.init.random_count, in.max_gaussians);
  for (int64_t i = 0; i < count; ++i) {
    const Camera& camera = in.views[static_cast<size_t>(random.below(static_cast<int>(in.views.size())))].data.camera;
    const double u = random.uniform(0, camera.width), v = random.uniform(0, camera.height);
    const double z = in.extent * std::exp(random.uniform(std::log(kRandomNear), std::log(kRandomFar)));
    cloud.positions.push_back(camera.unproject(u, v, z).cast<float>());
    Vec3f color;
    for (int k = 0; k < 3; ++k) color[k] = static_cast<float>(random.uniform());
    cloud.colors.push_back(color);
  }
  return cloud;
}

/// The start of "auto" where prior depth is none.
StartSource start_without_depth(const StartInputs& in) {
  if (in.cloud.size() > 0) return StartSource::kCloud;
  log_warning("there are no points and no depth in scene units: training starts from random points");
  return StartSource::kRandom;
}

}  // namespace

StartModel make_start_model(const StartInputs& in, Random random) {
  StartSource source = in.config.init.start;
  if (source == StartSource::kAuto)
    source = in.prior_depth == PriorDepthKind::kMetric ? StartSource::kDepth : start_without_depth(in);
  if (source == StartSource::kDepth) {
    if (in.prior_depth != PriorDepthKind::kMetric) {
      throw_bad_input({}, "init.start", "there is no metric prior depth to start from",
                      "use init.start=cloud or random");
    }
    StartModel start = start_from_depth(in);
    if (start.model.size() > 0) return start;
    if (in.config.init.start == StartSource::kDepth) {
      throw_bad_input({}, "pred_depths", "no prior depth value can be used", "use init.start=cloud or random");
    }
    source = start_without_depth(in);
    log_warning("no prior depth value can be used as a start: starting from {}",
                source == StartSource::kCloud ? "the cloud" : "random points");
  }
  if (source == StartSource::kRandom) return start_from_cloud(in, random_cloud(in, random));
  if (in.cloud.size() == 0) {
    throw_bad_input({}, "sparse/points3D", "the scene has no points to start from",
                    "add points3D, prior depth (pred_depths/), or use --set init.start=random");
  }
  return start_from_cloud(in, in.cloud);
}

}  // namespace aligngs
