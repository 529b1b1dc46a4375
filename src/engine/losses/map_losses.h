// Every loss that is a function of the rendered maps of one view: values and hand-derived gradients.
// The semantic loss is not here: it lives in the tile visit (engine/formulas/semantic_loss.h).
#pragma once

#include "core/thread_pool.h"
#include "engine/loss_terms.h"
#include "engine/losses/neighbour_view.h"
#include "engine/losses/workspace.h"
#include "engine/maps.h"
#include "engine/settings.h"
#include "engine/training_view.h"

namespace aligngs {

template <class T>
struct MapLossInputs {
  const RenderMaps<T>& maps;
  const TrainingView& view;
  const LossSettings& settings;
  ThreadPool* pool = nullptr;                   ///< nullptr: on the calling thread; results do not depend on it
  MapLossWorkspace<T>* workspace = nullptr;     ///< nullptr: buffers are allocated for this call
  const NeighbourView<T>* neighbour = nullptr;  ///< nullptr: no multi-view term, whatever its weight
};

/// Adds the terms to `terms` (values unweighted, `total` weighted) and their weighted gradients to `gradients`,
/// which the caller has reset. Terms whose weight is 0 are skipped; the PSNR is always computed. Degenerate
/// inputs (see each loss) give zero loss and zero gradient. Instantiated for float and double.
/// Throws Error{kFailed} when a map of the view does not have the size of the rendered maps.
template <class T>
void map_losses(const MapLossInputs<T>& inputs, LossTerms& terms, MapGradients<T>& gradients);

/// Throws Error{kFailed} when a map of the view that a loss of the maps reads does not have this size.
void require_map_sizes(const TrainingView& view, int width, int height);

/// Mean absolute colour difference of each pixel, 0 under the mask; what density control looks at.
/// `residual` is resized to the number of pixels.
template <class T>
void color_residual(const MapLossInputs<T>& inputs, std::vector<float>& residual);

}  // namespace aligngs
