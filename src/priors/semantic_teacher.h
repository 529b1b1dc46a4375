// Segmentation networks as teachers: which network a model is, and its map of a photo.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "nn/eomt/panoptic.h"
#include "nn/segmentation.h"
#include "priors/model_store.h"
#include "priors/network_memory.h"
#include "scene/scene.h"
#include "scene/segment_file.h"

namespace aligngs {

struct TeacherMapSize {
  int width = 0, height = 0;
};

/// A network, and how it is shown a photo.
class SemanticTeacher {
 public:
  virtual ~SemanticTeacher() = default;
  virtual int64_t classes() const = 0;
  /// The kind of the numbers of map().
  virtual SemanticKind kind() const = 0;
  /// Values [height, width, classes] of a photo (RGB).
  virtual nn::FeatureMap map(nn::Compute& compute, const Image<uint8_t>& rgb, int width, int height) const = 0;
  /// The photo's segments (segment_file.h), at the size at which the network sees it and no larger than the photo.
  /// Nothing by a network that does not tell things of one class apart.
  virtual std::optional<SegmentMap> segments(nn::Compute& compute, const Image<uint8_t>& rgb) const;
  /// Pixels of the short side of what the network is shown.
  virtual int short_side() const = 0;

  /// Size of the stored map: one value per 8 pixels of what the network is shown. Linear heads see patches of 14 or 16,
  /// Mask2Former and EoMT decide at 1/4.
  TeacherMapSize map_size(int photo_width, int photo_height) const;
};

/// One network of a design, in the store.
struct TeacherFiles {
  std::filesystem::path file;                     ///< its own weights
  std::optional<std::filesystem::path> backbone;  ///< of a head
};

/// Networks of one design, as the rows of priors/teacher_list.h name them.
struct SemanticFamily {
  /// The windows; unused by a network that takes the photo as a whole.
  nn::SegmentationPlan (*plan)(bool augment);
  void (*add_memory)(MemoryBudget&, const TeacherFiles&, const nn::SegmentationPlan&,
                     const std::vector<NetworkInput>& photos, const NetworkMemoryOptions&);
  std::unique_ptr<SemanticTeacher> (*load)(nn::Compute&, const TeacherFiles&, const nn::SegmentationPlan&,
                                           int mask2former_heads);
  bool segments = false;  ///< tells things of one class apart
};

extern const SemanticFamily kMask2FormerClasses;  ///< ViT-Adapter with Mask2Former
extern const SemanticFamily kEomtClasses;
extern const SemanticFamily kPanopticClasses;  ///< EoMT, things one by one
extern const SemanticFamily kLingbotClasses;
extern const SemanticFamily kMultiScaleClasses;  ///< DINOv2 with a head on four layers
extern const SemanticFamily kLinearClasses;      ///< DINOv2 with a linear head

/// Numbers the segments of a panoptic map within their classes. Error{kFailed} for more things of a class than the file
/// can hold.
SegmentMap segment_map_of(const nn::PanopticMap& panoptic, const std::vector<int>& stuff);

/// Whether its teacher gives segments.
bool makes_segments(const PublishedModel& model);

/// How a photo is shown to the network of a model that slides windows of a plan over it.
nn::SegmentationPlan semantic_plan(const PublishedModel& model, bool augment);

/// Memory for load_semantic_teacher() and the largest of `photos` (pixels). Reads the headers
/// of the weight files only; Error{kWeights} when they are missing.
void add_semantic_memory(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model, bool augment,
                         const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options);

/// Loads the network from the store. Error{kWeights} when its weights are missing. `augment`: of
/// the multi-scale heads; `mask2former_heads`: of attention in Mask2Former's head, which its
/// tensors do not tell; 0: as many as its deformable attention has.
std::unique_ptr<SemanticTeacher> load_semantic_teacher(nn::Compute& compute, const ModelStore& store,
                                                       const PublishedModel& model, bool augment,
                                                       int mask2former_heads = 0);

}  // namespace aligngs
