// Networks of the published structure and tiny sizes with random weights, in a store of a test.
#pragma once

#include <filesystem>

#include "nn/random_weights.h"
#include "priors/model_registry.h"
#include "priors/model_store.h"

namespace aligngs::tiny_networks {

inline std::filesystem::path weights_of(const ModelStore& store, const char* model, size_t file = 0) {
  const PublishedModel& published = published_model(model);
  return store.own_path(published, published.files[file]);
}

inline void install(const ModelStore& store, const char* model, const nn::TensorList& tensors, uint64_t seed = 1) {
  std::filesystem::create_directories(weights_of(store, model).parent_path());
  nn::write_random_weights(weights_of(store, model), tensors, seed);
}

inline void install_vggt(const ModelStore& store) {
  nn::VggtSize size;
  size.encoder = {64, 2, false, 4, 5};
  size.depth = 8;
  size.camera_depth = 1;
  size.features = 8;
  size.levels = {8, 8, 8, 8};
  install(store, "vggt-1b", nn::vggt_tensors(size));
}

inline void install_da3(const ModelStore& store, const char* model = "da3-base") {
  nn::Da3Size size;
  size.encoder = {64, 12, false, 0, 5};
  size.heads = 1;
  size.features = 8;
  size.camera_depth = 1;
  size.levels = {8, 8, 8, 8};
  install(store, model, nn::da3_tensors(size));
}

inline void install_da3_metric(const ModelStore& store) {
  nn::Da3MetricSize size;
  size.encoder = {64, 24, false, 0, 5};
  size.features = 8;
  size.levels = {8, 8, 8, 8};
  install(store, "da3metric-large", nn::da3_metric_tensors(size));
}

inline void install_label_networks(const ModelStore& store) {
  nn::EomtSize eomt;
  eomt.encoder = {64, 4, false, 4, 4};  // windows of 64 pixels
  eomt.queries = 6;
  eomt.query_blocks = 2;
  install(store, "eomt-l", nn::eomt_tensors(eomt));
  install(store, "eomt-l-panoptic", nn::eomt_huggingface_tensors(eomt));
  nn::LingbotSize lingbot;
  lingbot.encoder = {64, 2, false, 4, 0};
  lingbot.heads = 1;
  install(store, "lingbot-s", nn::lingbot_tensors(lingbot));
}

/// Heads for classes and depth on the smallest DINOv2.
inline void install_linear(const ModelStore& store) {
  const nn::VitSize size{64, 4, false, 0, 5};
  install(store, "dinov2-s", nn::dinov2_tensors(size));
  install(store, "ade20k-linear-s", nn::bn_head_tensors(size.channels), 2);
  install(store, "nyu-linear4-s", nn::linear_depth_tensors(4 * 2 * size.channels), 3);
}

/// The head on four layers as well.
inline void install_multi_scale(const ModelStore& store) {
  install(store, "ade20k-ms-s", nn::bn_head_tensors(4 * 64), 2);
}

}  // namespace aligngs::tiny_networks
