// Depth and class priors of a scene's training views by networks, written into the scene folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "nn/compute.h"
#include "priors/model_store.h"
#include "priors/network_memory.h"
#include "priors/predicted_view.h"
#include "scene/scene.h"

namespace aligngs {

struct ScenePriorsOptions {
  nn::Precision precision = nn::Precision::kBfloat16;
  nn::DeviceFactory make_device = {};         ///< where networks run; empty: the processor
  bool overwrite = false;                     ///< replace priors that are there
  bool augment = false;                       ///< multi-scale head: five sizes, mirrored as well (ten passes)
  int mask2former_heads = 0;                  ///< of its attention; 0: from the tensors, with 4 points per level
  double drop_percent = kUnsureDepthPercent;  ///< VGGT: depth of the lowest confidence that is left out
  uint64_t memory_limit = 0;                  ///< bytes; 0: 80 % of what is free
  int threads = 0;
  ProgressStyle progress;
};

struct ScenePriorsReport {
  std::string model;
  size_t written = 0;         ///< views
  bool was_there = false;     ///< every training view had it already, and it was kept
  int width = 0, height = 0;  ///< of the last map
  bool makes_segments = false;
  size_t segments = 0;  ///< of all photos
};

/// Memory of a network for depth or cameras and of what it makes of `photos` (pixels), item by item. Reads the headers
/// of its weight files only. Error{kWeights} when they are missing, Error{kUsage} for another network.
void add_depth_memory(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model,
                      const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options);

/// Writes pred_depths/<view>.npy (float16) and priors.json with the scale of the network's design (depth_teacher.h).
/// VGGT has one of its own, Depth Anything 3 that of the cameras, and heads on DINOv2 give metres. Training lays the
/// first and the last on the scene. Error{kUsage} when other priors are there and overwrite is not set.
ScenePriorsReport fill_depth(const std::filesystem::path& scene, const ModelStore& store, const PublishedModel& model,
                             const ScenePriorsOptions& options);

/// Writes segmentation_logits/<view>.npz (float16 [150, h, w], one value per 8 pixels of the network's input), and
/// segments/<view>.png by a network that makes_segments(). Writes priors.json with the kind: logits of the linear
/// heads, scores of Mask2Former. Error{kBadInput} when the scene has other classes than ADE20K's.
ScenePriorsReport fill_semantics(const std::filesystem::path& scene, const ModelStore& store,
                                 const PublishedModel& model, const ScenePriorsOptions& options);

}  // namespace aligngs
