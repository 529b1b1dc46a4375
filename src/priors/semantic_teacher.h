// Segmentation networks as teachers: which network a model is, and its map of a photo.
#pragma once

#include <cstdint>
#include <memory>

#include "nn/segmentation.h"
#include "priors/model_store.h"
#include "priors/network_memory.h"
#include "scene/scene.h"

namespace aligngs {

struct SemanticTeacher {
  std::unique_ptr<nn::SegmentationNetwork> network;
  nn::SegmentationPlan plan;
  SemanticKind kind = SemanticKind::kLogits;
};

/// How a photo is shown to the network of a model.
nn::SegmentationPlan semantic_plan(const PublishedModel& model, bool augment);

/// Memory for load_semantic_teacher() and the largest of `photos` (pixels). Reads the headers
/// of the weight files only; Error{kWeights} when they are missing.
void add_semantic_memory(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model,
                         bool augment, const std::vector<NetworkInput>& photos,
                         const NetworkMemoryOptions& options);

/// Loads the network from the store. Error{kWeights} when its weights are missing. `augment`: of
/// the multi-scale heads; `mask2former_heads`: of attention in Mask2Former's head, which its
/// tensors do not tell; 0: as many as its deformable attention has.
SemanticTeacher load_semantic_teacher(nn::Compute& compute, const ModelStore& store,
                                      const PublishedModel& model, bool augment,
                                      int mask2former_heads = 0);

/// Values [height, width, classes] of a photo (RGB): logits, scores, or with several ratios or
/// mirrored the logarithm of the averaged probabilities (which softmax turns back into them).
nn::FeatureMap teacher_map(nn::Compute& compute, const SemanticTeacher& teacher,
                           const Image<uint8_t>& rgb, int width, int height);

/// Size of the stored map: one value per 8 pixels of what the network is shown; linear heads see
/// patches of 14, Mask2Former decides at 1/4.
struct TeacherMapSize {
  int width = 0, height = 0;
};
TeacherMapSize teacher_map_size(const SemanticTeacher& teacher, int photo_width, int photo_height);

}  // namespace aligngs
