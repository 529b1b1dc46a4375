// The last touch to a trained room: walls, floor and ceiling where no photo shows them (refine/unseen_layout.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/thread_pool.h"
#include "engine/engine.h"
#include "scene/label_set.h"
#include "train/training_set.h"

namespace aligngs {

/// The most Gaussians that a model may have once its room is closed: more than the cap on growth, which has usually
/// filled that up. Unseen walls, floor and ceiling of an ordinary room are 5 000 to 20 000 squares; a small model is
/// not more than doubled.
constexpr size_t most_in_closed_room(size_t cap) { return cap + std::min<size_t>(cap, 50000); }

struct ClosedRoomRequest {
  const std::vector<GuideView>& views;  ///< what they show is rendered and not made up
  const LabelSet& labels;
  double extent = 1;          ///< robust scene extent, scene units
  size_t most_gaussians = 0;  ///< that the model may have afterwards
  RenderOptions render;       ///< near planes are those of the views
};

/// Adds Gaussians for the unseen parts of planes that the training views' rendered labels call wall, floor or ceiling.
/// They have the colour and the label of the seen parts. Nothing is added where a Gaussian already lies, so a second
/// call changes little. Nothing that a training view shows is covered. Returns the number added. It is 0 for a model
/// without semantics or a room without planes, or, with a log line, if too many Gaussians would be needed.
size_t close_room(Engine& engine, const ClosedRoomRequest& request, ThreadPool& pool);

}  // namespace aligngs
