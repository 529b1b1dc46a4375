// The forward and the backward visit to every tile of a view.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "engine/cpu/blend_backward.h"
#include "engine/cpu/blend_forward.h"
#include "engine/cpu/row_batches.h"
#include "engine/cpu/semantic_visit.h"
#include "engine/maps.h"

namespace aligngs::cpu {

/// Scratch of one thread.
struct TileScratch {
  TileWeights weights;
  TileForward forward;
  TileGradients gradients;
  SemanticScratch semantic;
  double semantic_seconds = 0;  ///< time spent in the semantic products and losses
};

/// Everything a pass over tiles reads.
struct ViewTiles {
  const ProjectedView& view;
  const TileLists& lists;
  const RasterSettings& raster;
};

/// Blends all maps, or only colour and alpha (the others are then zero), or only the median depth. `record` may be
/// nullptr, and is with the median depth alone.
void forward_pass(const ViewTiles& tiles, BlendedMaps blended, ThreadPool& pool, std::vector<TileScratch>& scratch,
                  RenderMaps<float>& maps, BlendRecord* record);

/// Inputs of the backward pass from the maps, planar as in engine/maps.h.
struct BackwardMaps {
  const MapGradients<float>& gradients;
  const float* residual = nullptr;  ///< [H * W] with density
  const float* prior = nullptr;     ///< [H * W] prior depth with density, nullptr = none
  float prior_scale = 1;            ///< the prior depth is multiplied by it (LossSettings::prior_depth_scale)
};

/// Sums per (Gaussian, tile) at the slots of the lists; valid where BlendRecord::seen[slot] is 1.
using SlotGradients = AlignedArray<CoupledSplatGradient>;

/// `record` is that of the forward pass; `semantics` may be nullptr.
void backward_pass(const ViewTiles& tiles, const BlendRecord& record, const BackwardMaps& maps, bool geometry,
                   bool density, SemanticPass* semantics, ThreadPool& pool, std::vector<TileScratch>& scratch,
                   RowBatches& batches, SlotGradients& out);

/// Adds to sums[row of the model][padded] the teacher's probabilities times the blending weights of this view.
/// sums starts anywhere; rows are valid where written[row] is 1.
void lift_pass(const ViewTiles& tiles, const SemanticStep& step, ThreadPool& pool, std::vector<TileScratch>& scratch,
               RowBatches& batches, float* sums, std::vector<uint8_t>& written);

}  // namespace aligngs::cpu
