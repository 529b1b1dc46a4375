// The multi-view terms: the pixels of a step against a neighbouring view; the twin of
// engine/losses/multi_view_geometric.h
// and multi_view_photometric.h, whose values and degenerate cases they have.
#pragma once

#include <cstdint>

#include "engine/cuda/training_maps.h"
#include "engine/cuda/view_spans.h"
#include "engine/formulas/two_views.h"
#include "engine/loss_terms.h"
#include "engine/settings.h"

namespace aligngs::cuda {

/// The other view of a step, constant in it.
struct NeighbourSpans {
  TwoViews<float> views;          ///< its camera relative to that of the step
  TrainingMapSpans view;          ///< its photo
  DeviceSpan<const float> depth;  ///< [H W] of its camera, from keep_neighbour_depth; empty: the step has no neighbour
  uint64_t seed = 0;              ///< draws the pixels of the photometric term

  ALIGNGS_HD bool empty() const { return depth.empty(); }
};

/// depth [H W] gets the plane depth of a neighbour's blended maps where it is kDepthTight and the mask keeps the pixel,
/// else 0.
void keep_neighbour_depth(const DeviceContext& context, const RenderMapSpans& maps, const TrainingMapSpans& view,
                          bool paper_normals, DeviceSpan<float> depth);

struct MultiViewInputs {
  RenderMapSpans maps;
  TrainingMapSpans view;
  LossSettings settings;
  NeighbourSpans neighbour;
  DeviceSpan<const float> depth;       ///< [H W] plane depth of `maps`
  DeviceSpan<const uint8_t> validity;  ///< [H W] DepthValidity
};

/// How the terms of a step are normalised; zero where a term does not act.
struct MultiViewSteps {
  double share = 0;     ///< of the agreeing pixels that are compared (draws_patch)
  float geometric = 0;  ///< factors of the gradients
  float photometric = 0;
};

/// Gradients before their factors; spans are empty where the term has no weight.
struct MultiViewGradients {
  DeviceSpan<const float> depth;           ///< [H W] w dphi / dz
  DeviceSpan<const float> plane;           ///< [4][H W] by the blended normal and distance; 0 where no patch is used
  DeviceSpan<const MultiViewSteps> steps;  ///< [1]; empty: the step has no multi-view terms
};

/// Adds values and total to `terms` [1]. Everything returned comes from the arena: multi_view_bytes.
MultiViewGradients multi_view_losses(DeviceArena& arena, const MultiViewInputs& in, DeviceSpan<LossTerms> terms);

/// For a step and a neighbour of so many pixels each.
uint64_t multi_view_bytes(const LossSettings& settings, size_t pixels);

}  // namespace aligngs::cuda
