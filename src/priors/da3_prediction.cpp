#include "priors/da3_prediction.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/log.h"
#include "io/image_file.h"
#include "nn/da3/ray_pose.h"
#include "nn/preprocess/da3_images.h"
#include "scene/photo_fit.h"

namespace aligngs {
namespace {

std::vector<nn::FeatureMap> network_images(Da3Inputs& inputs) {
  std::vector<nn::FeatureMap> images;
  for (Image<uint8_t>& image : inputs.images) {
    images.push_back(nn::da3_input(image));
    image = {};
  }
  return images;
}

/// A camera of a photo in pixels of the network's input.
nn::NetworkCamera network_camera(const Camera& camera, const nn::ImagePlacement& placement) {
  nn::NetworkCamera out;
  for (size_t i = 0; i < 9; ++i) out.rotation[i] = camera.world_to_camera.rotation.m[i];
  const Vec3d& t = camera.world_to_camera.translation;
  out.translation = {t.x, t.y, t.z};
  out.fx = camera.fx * placement.scale_x;
  out.fy = camera.fy * placement.scale_y;
  out.cx = camera.cx * placement.scale_x + placement.offset_x;
  out.cy = camera.cy * placement.scale_y + placement.offset_y;
  return out;
}

uint64_t weight_bytes(const nn::Weights& weights, uint64_t matrix_bytes) {
  uint64_t bytes = 0;
  for (const std::string& name : weights.names()) {
    uint64_t count = 1;
    for (const int64_t n : weights.shape(name)) count *= uint64_t(n);
    bytes += count * (name.rfind("cam_", 0) == 0 ? 4 : matrix_bytes);  // the camera branch is float32
  }
  return bytes;
}

constexpr uint64_t kDensePerFeature = 9;  // bytes per pixel: the widest maps of a dense head

/// Sky has no depth.
void leave_out_sky(nn::FeatureMap& depth, const nn::FeatureMap& metric) {
  for (int64_t i = 0; i < depth.places(); ++i) {
    if (!(metric.data[size_t(2 * i + 1)] < nn::kDa3SkyThreshold)) depth.data[size_t(2 * i)] = 0;
  }
}

void scale_views(std::vector<PredictedView>& views, double scale) {
  for (PredictedView& view : views) {
    for (float& z : view.depth.data) z = float(double(z) * scale);
    view.camera.world_to_camera.translation = view.camera.world_to_camera.translation * scale;
  }
}

nn::NetworkCamera camera_from_rays(const Photo& photo, const nn::Da3Frame& frame) {
  try {
    return nn::pose_from_rays(frame.rays, frame.depth.width, frame.depth.height).camera;
  } catch (const Error& error) {
    Error::Details details = error.details();
    details.path = photo.file;
    details.remedy = "leave out --camera-from-rays";
    throw Error(details);
  }
}

}  // namespace

Da3Inputs da3_inputs(const std::vector<Photo>& photos, ThreadPool& pool) {
  Da3Inputs inputs;
  inputs.images.resize(photos.size());
  inputs.placements.resize(photos.size());
  pool.parallel_for(photos.size(), 1, [&](size_t i, size_t, int) {
    inputs.images[i] =
        nn::da3_image(read_photo_of_size(photos[i].file, photos[i].width, photos[i].height), {}, &inputs.placements[i]);
  });
  std::vector<double> pixels;
  for (const Image<uint8_t>& image : inputs.images) pixels.push_back(double(image.pixels()));
  nn::da3_common_size(inputs.images, &inputs.placements);
  constexpr double kWorthALine = 0.75;  // of a photo
  size_t cut = 0;
  for (size_t i = 0; i < photos.size(); ++i) cut += double(inputs.images[i].pixels()) < kWorthALine * pixels[i];
  if (cut > 0) {
    log_warning(
        "the network sees only the middle of {} of {} photos, because their shapes differ; vggt sees all of them", cut,
        photos.size());
  }
  return inputs;
}

void add_da3_memory(MemoryBudget& budget, const nn::Weights& file, nn::Precision precision, size_t frames, int width,
                    int height) {
  const nn::Weights weights = nn::da3_part(file, "da3");
  budget.add("weights of the network", weight_bytes(weights, nn::bytes_of_weight(precision)));
  const auto channels = uint64_t(weights.dimension("backbone.pretrained.cls_token", 2));
  const auto features = uint64_t(weights.dimension("head.scratch.layer1_rn.weight", 0));
  const auto token = uint64_t(weights.dimension("head.projects.0.weight", 1));
  const uint64_t pixels = uint64_t(width) * uint64_t(height);
  const uint64_t patches = pixels / (nn::kDa3Patch * nn::kDa3Patch), tokens = frames * (patches + 1);
  constexpr uint64_t kKept = 4, kStream = 2;  // layers for the dense head; copies of the stream
  budget.add("tokens kept for the dense head", kKept * tokens * token * 4);
  // The head begins when the tokens are done: the larger of the two counts.
  const uint64_t in_work = tokens * channels * (kStream * 4 + 3 * nn::bytes_of_operand(precision) + 4);
  const uint64_t dense = kDensePerFeature * features * pixels;
  budget.add(in_work > dense ? "tokens in work" : "one view in the dense head", std::max(in_work, dense));
  constexpr uint64_t kMapsPerPixel = 3 + 12 + 8;  // input as bytes and as floats; depth and confidence
  budget.add("photos and their maps", frames * kMapsPerPixel * pixels);
}

void add_da3_metric_memory(MemoryBudget& budget, const nn::Weights& file, nn::Precision precision, size_t frames,
                           int width, int height) {
  const nn::Weights weights = nn::da3_part(file, "da3_metric");
  const uint64_t pixels = uint64_t(width) * uint64_t(height);
  budget.add("weights of the metric network", weight_bytes(weights, nn::bytes_of_weight(precision)));
  budget.add("one photo in its dense head",
             kDensePerFeature * uint64_t(weights.dimension("head.scratch.layer1_rn.weight", 0)) * pixels);
  constexpr uint64_t kMapsPerPixel = 3 + 8;  // input as bytes; depth and sky as floats
  budget.add("photos and their metric depth", frames * kMapsPerPixel * pixels);
}

void add_metric_depth(nn::Compute& compute, const nn::Da3Metric& network, Da3Inputs& inputs,
                      const ProgressStyle& style) {
  Progress progress(style, "metres (Depth Anything 3)", inputs.images.size());
  inputs.metric.clear();
  for (const Image<uint8_t>& image : inputs.images) {
    inputs.metric.push_back(network(compute, nn::da3_input(image)));
    progress.update(inputs.metric.size());
  }
  nn::fill_da3_sky(inputs.metric);
}

PredictedViews predict_da3_views(nn::Compute& compute, const nn::Da3& network, const std::vector<Photo>& photos,
                                 Da3Inputs inputs, const ViewPredictionOptions& options) {
  const std::vector<nn::FeatureMap> images = network_images(inputs);
  PredictedViews out;
  std::vector<PredictedView>& views = out.views;
  views.resize(photos.size());
  std::vector<double> log_metres;
  Progress progress(options.progress, "Depth Anything 3", photos.size());
  nn::Da3Request request;
  request.rays = options.from_rays;
  network(compute, images, request, [&](int64_t frame, nn::Da3Frame predicted) {
    const auto i = size_t(frame);
    if (options.from_rays) predicted.camera = camera_from_rays(photos[i], predicted);
    if (!inputs.metric.empty()) {
      if (const auto found = log_metres_of_photo(predicted, inputs.metric[i])) log_metres.push_back(*found);
      leave_out_sky(predicted.depth, inputs.metric[i]);
    }
    views[i] = view_of_photo(photos[i], predicted.camera, predicted.depth, inputs.placements[i]);
    progress.update(i + 1);
  });
  finish_views(views, options);
  out.metres = metres_estimate(std::move(log_metres));
  if (out.metres) scale_views(views, out.metres->scale);
  return out;
}

std::vector<PredictedView> da3_depth_of_cameras(nn::Compute& compute, const nn::Da3& network,
                                                const std::vector<Photo>& photos, const std::vector<Camera>& cameras,
                                                Da3Inputs inputs, const ProgressStyle& style) {
  nn::Da3Request request;
  for (size_t i = 0; i < cameras.size(); ++i)
    request.cameras.push_back(network_camera(cameras[i], inputs.placements[i]));
  const std::vector<nn::FeatureMap> images = network_images(inputs);
  std::vector<PredictedView> views(photos.size());
  std::vector<nn::NetworkCamera> predicted(photos.size());
  Progress progress(style, "Depth Anything 3", photos.size());
  network(compute, images, request, [&](int64_t frame, nn::Da3Frame found) {
    const auto i = size_t(frame);
    predicted[i] = found.camera;
    PhotoMaps maps = maps_of_photo(found.depth, inputs.placements[i], photos[i].width, photos[i].height);
    views[i] = {cameras[i], std::move(maps.depth), std::move(maps.confidence)};
    progress.update(i + 1);
  });
  const nn::CameraAlignment fit = nn::align_given_cameras(request.cameras, predicted);
  if (!(fit.scale > 0) || !std::isfinite(fit.scale)) {
    throw Error({ErrorKind::kFailed,
                 "the network's cameras have no common scale with the given ones",
                 {},
                 "depth",
                 "use depth of single photos, e.g. --depth dpt-s; check the weights with `aligngs models verify`"});
  }
  for (PredictedView& view : views) {
    for (float& z : view.depth.data) z = float(double(z) / fit.scale);
  }
  return views;
}

}  // namespace aligngs
