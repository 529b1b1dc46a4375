// From semantic rows to objects: a class per Gaussian, and which of the class's objects it is part of.
#pragma once

#include "core/thread_pool.h"
#include "gaussians/gaussian_model.h"
#include "gaussians/gaussian_ply.h"
#include "gaussians/placed_neighbours.h"
#include "gaussians/soft_labels.h"
#include "scene/label_set.h"

namespace aligngs {

/// soft_labels() smoothed over neighbours (label_smoothing.h), once; `extent` as below, `known` as for LabelSmoother.
SoftLabels smoothed_labels(const GaussianModel& model, double extent, ThreadPool& pool,
                           const PlacedNeighbours& known = {});

struct ObjectLabels {
  SoftLabels soft;        ///< smoothed over neighbours
  GaussianLabels labels;  ///< best class, its probability, and the object's number
};

/// Smooths (soft_labels.h), labels and numbers the objects (instances.h). `extent` is that of the scene, scene units;
/// 0:
/// measured on the model. Error{kBadInput} for a model without semantic channels. The same for any number of threads.
ObjectLabels object_labels(const GaussianModel& model, const LabelSet& labels, double extent, ThreadPool& pool);

}  // namespace aligngs
