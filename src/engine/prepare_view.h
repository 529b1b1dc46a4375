// Turns the pixels and priors of a view into inputs of training: masks, weights and prior normals. They depend on the
// view alone and are computed once.
#pragma once

#include "core/image.h"
#include "engine/training_view.h"

namespace aligngs {

struct PrepareOptions {
  /// label_edge as printed: the left or top pixel of each differing pair. Off: two pixels on either side.
  bool paper = false;
  bool prior_normals = true;     ///< fill prior_normal (needs a prior depth)
  bool depth_weights = true;     ///< fill depth_weight (needs a prior depth)
  bool semantic_weights = true;  ///< fill semantic_weight (needs semantics)

  double depth_jump = 0.05;      ///< |dz| / z between neighbours that is a discontinuity
  double color_edge = 0.08;      ///< sRGB difference between neighbours that is a colour edge: five sigma of
                                 ///< sensor noise (1.5 / 255, two pixels), above soft shading
  int label_edge_radius = 2;     ///< pixels on either side of a label edge that L_d leaves out
  int edge_radius = 3;           ///< pixels on either side of an edge that count as close to it
  double confidence_low = 0.2;   ///< quantile of the confidence below which a depth weighs 0
  double confidence_high = 0.6;  ///< quantile above which it weighs 1; linear between the two
};

/// Derives the maps of TrainingView; those whose input is missing stay empty. `prior_confidence` is null or H x W at
/// the camera's size, larger is better, any scale. Throws Error{kBadInput} when the prior depth, the labels, the mask
/// or the confidence do not have the camera's size. Also thrown when the semantic target is inconsistent.
TrainingView prepare_view(ViewData data, const PrepareOptions& options = {}, const ImageF* prior_confidence = nullptr);

/// 1 at the pixels that L_d leaves out: next to a place where two known labels differ.
Image<uint8_t> label_edge_map(const Image<uint16_t>& labels, const PrepareOptions& options);

/// 0 without a depth or close to a discontinuity of it, else the rank of the confidence between its two quantiles. 1
/// everywhere without a confidence or when it is constant.
ImageF depth_weight_map(const ImageF& depth, const ImageF* confidence, const PrepareOptions& options);

/// omega: the teacher's confidence times 1 - H(t) / log C, sampled bilinearly from its own resolution. It is 0 close to
/// a label edge unless a colour edge or a depth discontinuity is close as well. The teacher's outlines are pixels off.
ImageF semantic_weight_map(const ViewData& data, const PrepareOptions& options);

}  // namespace aligngs
