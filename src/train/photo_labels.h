// The last word on labels, when geometry is done: the training photos vote anew, and objects are named as wholes.
#pragma once

#include "gaussians/object_naming.h"
#include "train/photo_opinions.h"

namespace aligngs {

struct PhotoLabelInputs {
  std::vector<TrainingView> views;  ///< all classes, cameras in place
  std::vector<float> near_planes;   ///< of the views, scene units
  RasterSettings raster;
  double extent = 1;                ///< of the scene, scene units
  NamingOptions naming;
  bool calibrate = true;            ///< weigh opinions by how often such ones agree with others
};

struct PhotoLabelReport {
  size_t regions = 0;  ///< connected, of one class
  size_t renamed = 0;  ///< that got another name than most votes have
};

/// Replaces the semantic rows of every Gaussian that a photo shows by the logarithms of its votes' shares; the others keep theirs. Where a region gets
/// another name than its commonest, its Gaussians' votes for both become votes for that name: it is sharpened as a whole, with the
/// outline that all its names have together. Rows stay soft, so that whoever draws them smooths and sharpens them as before. Nothing
/// happens without semantics or Gaussians. The same for any number of threads.
PhotoLabelReport vote_label_rows(GaussianModel& model, PhotoLabelInputs inputs, ThreadPool& pool);

}  // namespace aligngs
