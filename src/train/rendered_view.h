// Rendered training view, between steps.
#pragma once

#include "engine/engine.h"
#include "refine/plane_depth.h"
#include "train/training_set.h"

namespace aligngs {

/// The view from `camera` (that of `view`, resized or not) with its near plane, depth and labels included.
Rendering render_labelled(const Engine& engine, const GuideView& view, const Camera& camera, RenderOptions options);

/// A rendering as planes are found in it: median depth, certain where alpha is above 0.9, and the labels drawn.
PlaneView plane_view_of(const Camera& camera, const Rendering& seen);

}  // namespace aligngs
