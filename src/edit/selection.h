// Gaussians of a selection.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "edit/selection_text.h"
#include "gaussians/instances.h"
#include "gaussians/soft_labels.h"

namespace aligngs {

/// The Gaussians of a room with all that selecting needs; rows of the parts correspond.
struct LabelledGaussians {
  GaussianModel model;
  SoftLabels soft;        ///< smoothed; empty without labels
  GaussianLabels labels;  ///< with instances; without labels kNoLabel everywhere
  double extent = 1;      ///< robust extent of the scene, scene units

  bool named = false;  ///< the labels were read from scene.labels.ply: the model has no semantic rows

  bool has_labels() const { return named || model.semantic_channels > 0; }
};

/// Smooths, labels and numbers the objects; crumbs join their neighbours (crumbs.h). A model that was trained without
/// semantics has none. It can be exported and edited as a whole, but nothing of it is selected by name.
LabelledGaussians label_objects(GaussianModel model, const LabelSet& labels, double extent, ThreadPool& pool);

struct SelectionOptions {
  int neighbours = 12;  ///< that vote on each Gaussian
  int rounds = 2;
  double join = 0.65;   ///< a Gaussian joins when at least this share of its neighbours (by opacity) is selected
  double leave = 0.3;   ///< and leaves when at most this share is: no halo, no hole, no lone speck
  double reach = 0.02;  ///< / extent: crumbs farther than this from every object of the class are left out
};

/// The selected part of one object.
struct SelectedObject {
  int label = -1;    ///< class number; -1: Gaussians without a class
  int instance = 0;  ///< 0: crumbs of the class
  size_t gaussians = 0;
};

struct GaussianSelection {
  std::vector<uint8_t> mask;  ///< per Gaussian
  size_t count = 0;
  std::vector<SelectedObject> objects;  ///< by class, then number
  double threshold = 0;                 ///< that was used; of the first class where it is automatic; 0 for argmax
};

/// Error{kBadInput} when nothing is selected, naming what the room holds, and for names where the room has no labels.
GaussianSelection select_gaussians(const LabelledGaussians& room, const SelectionQuery& query,
                                   const ThresholdRule& rule, const LabelSet& labels, const SelectionOptions& options,
                                   ThreadPool& pool);

/// The split of values in (0, 1] into two groups with the largest variance between them (Otsu 1979). 0.5 when there are
/// fewer than two different values.
double otsu_threshold(const std::vector<float>& values);

}  // namespace aligngs
