// The last word on labels, when geometry is done: the training photos vote anew, and objects are named as wholes.
#pragma once

#include "gaussians/object_naming.h"
#include "gaussians/placed_neighbours.h"
#include "train/photo_opinions.h"

namespace aligngs {

struct PhotoLabelInputs {
  std::vector<TrainingView> views;  ///< all classes, cameras in place
  std::vector<float> near_planes;   ///< of the views, scene units
  RasterSettings raster;
  double extent = 1;  ///< of the scene, scene units
  NamingOptions naming;
  bool calibrate = false;  ///< weigh opinions by how often such ones agree with others, too
};

struct PhotoLabelReport {
  size_t regions = 0;           ///< connected, of one class
  size_t renamed = 0;           ///< that got another name than most votes have
  size_t moved = 0;             ///< Gaussians that outlines gave another label than most of their votes have
  PlacedNeighbours neighbours;  ///< that the labels were smoothed over
};

/// Replaces the semantic rows of every Gaussian that a photo shows; the others keep theirs. The row is the logarithm of
/// nine tenths of a decision and one tenth of its votes' shares. A photo's pixel counts with the square of its sum of
/// scores. The decision is made in three steps. Regions of one class get their names (name_regions). Votes for other
/// names that some photo has for a region become votes for its name, so that it is sharpened as a whole. Gaussians
/// settle the outlines (label_outlines): a class may go to a Gaussian if two photos give it or a neighbour has it.
/// Nothing happens without semantics or Gaussians. The same for any number of threads.
PhotoLabelReport vote_label_rows(GaussianModel& model, PhotoLabelInputs inputs, ThreadPool& pool);

}  // namespace aligngs
