// One view as training sees it: its pixels and priors, and maps derived from them once.
#pragma once

#include "engine/loss_catalogue.h"
#include "scene/view_data.h"

namespace aligngs {

struct TrainingView {
  ViewData data;
  ImageF depth_weight;     ///< H x W, confidence of the prior depth in [0, 1]; empty: 1 where depth is given
  ImageF prior_normal;     ///< H x W x 3, camera frame, turned to the camera, (0,0,0) = none; empty when absent
  ImageF semantic_weight;  ///< H x W, omega (engine/prepare_view.h) for the coupling gradient; empty: 1 everywhere
  /// H x W, 1 = excluded from L_d (paper: one-sided 1 px; default: symmetric 2 px band); empty without semantics
  Image<uint8_t> label_edge;
};

/// Those inputs of losses that the view has.
inline GivenInputs given_inputs(const TrainingView& view) {
  return {!view.data.prior_depth.empty(), !view.prior_normal.empty(), !view.data.labels.empty()};
}

}  // namespace aligngs
