// Test views: between training views, and far from all of them.
#pragma once

#include <vector>

#include "synth/training_views.h"
#include "synth/view_planner.h"

namespace aligngs {

/// A view between two neighbouring training views.
struct NearView {
  size_t after = 0;  ///< comes after this training view in the walk
  Camera camera;
};

std::vector<NearView> plan_near(const ViewPlanner& planner, const std::vector<Station>& training, int count);

/// Views that pass kFarMetres or kFarDegrees against every training view and see what they saw, furnished corners
/// first. Draws from the planner's random numbers; fewer than `count` where the room has no more.
std::vector<Camera> plan_far(ViewPlanner& planner, const std::vector<Station>& training, int count);

}  // namespace aligngs
