#include "priors/vggt_prediction.h"

#include <algorithm>

#include "io/image_file.h"
#include "scene/photo_fit.h"

namespace aligngs {
namespace {

nn::FeatureMap unit_image(const Image<uint8_t>& image) {
  nn::FeatureMap map(image.height, image.width, 3);
  for (size_t i = 0; i < image.data.size(); ++i) map.data[i] = float(image.data[i]) / 255.f;
  return map;
}

}  // namespace

VggtInputs vggt_inputs(const std::vector<Photo>& photos, ThreadPool& pool) {
  bool all_landscape = true;
  for (const Photo& photo : photos) all_landscape = all_landscape && photo.width >= photo.height;
  const nn::VggtFit fit = all_landscape ? nn::VggtFit::kCrop : nn::VggtFit::kPad;
  VggtInputs inputs;
  inputs.images.resize(photos.size());
  inputs.placements.resize(photos.size());
  pool.parallel_for(photos.size(), 1, [&](size_t i, size_t, int) {
    inputs.images[i] = nn::vggt_image(read_photo_of_size(photos[i].file, photos[i].width, photos[i].height), fit,
                                      &inputs.placements[i]);
  });
  nn::vggt_common_size(inputs.images, &inputs.placements);
  return inputs;
}

void add_vggt_memory(MemoryBudget& budget, const nn::Weights& weights, nn::Precision precision, size_t frames,
                     int width, int height) {
  uint64_t weight_bytes = 0;
  for (const std::string& name : weights.names()) {
    if (name.rfind("track_head.", 0) == 0) continue;
    uint64_t count = 1;
    for (const int64_t n : weights.shape(name)) count *= uint64_t(n);
    weight_bytes += count * (name.rfind("camera_head.", 0) == 0 ? 4 : nn::bytes_of_weight(precision));
  }
  budget.add("weights of the network", weight_bytes);
  const auto channels = uint64_t(weights.dimension("aggregator.camera_token", 3));
  const auto registers = uint64_t(weights.dimension("aggregator.register_token", 2));
  const uint64_t patches = uint64_t(width / nn::kVggtPatch) * uint64_t(height / nn::kVggtPatch);
  const uint64_t tokens = frames * (patches + 1 + registers);
  constexpr uint64_t kKept = 4, kStream = 3;  // layers for the dense heads; copies of the stream
  budget.add("tokens kept for the dense heads", kKept * tokens * 2 * channels * 4);
  // The heads begin when the tokens are done: the larger of the two counts.
  const uint64_t in_work = tokens * channels * (kStream * 4 + 3 * nn::bytes_of_operand(precision) + 4);
  constexpr uint64_t kDensePerPixel = 2200;  // bytes: the widest maps of a dense head
  const uint64_t dense = kDensePerPixel * uint64_t(width) * uint64_t(height);
  budget.add(in_work > dense ? "tokens in work" : "one frame in the dense head", std::max(in_work, dense));
  constexpr uint64_t kMapsPerPixel = 12 + 12 + 8;  // input, its copy, depth and confidence
  budget.add("photos and their maps", frames * kMapsPerPixel * uint64_t(width) * uint64_t(height));
}

std::vector<PredictedView> predict_vggt_views(nn::Compute& compute, const nn::Vggt& network,
                                              const std::vector<Photo>& photos, VggtInputs inputs,
                                              const ViewPredictionOptions& options) {
  std::vector<nn::FeatureMap> images;
  for (Image<uint8_t>& image : inputs.images) {
    images.push_back(unit_image(image));
    image = {};
  }
  std::vector<PredictedView> views(photos.size());
  Progress progress(options.progress, "VGGT", photos.size());
  network(compute, std::move(images), {true, false}, [&](int64_t frame, nn::VggtFrame predicted) {
    const auto i = size_t(frame);
    views[i] = view_of_photo(photos[i], predicted.camera, predicted.depth, inputs.placements[i]);
    Rigidd& pose = views[i].camera.world_to_camera;
    if (options.camera_to_world) pose = pose.inverse();
    progress.update(i + 1);
  });
  finish_views(views, options);
  return views;
}

}  // namespace aligngs
