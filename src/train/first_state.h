// The state of a training before its first step.
#pragma once

#include <string>
#include <vector>

#include "core/memory_budget.h"
#include "core/thread_pool.h"
#include "engine/engine.h"
#include "train/checkpoint.h"
#include "train/training_scene.h"

namespace aligngs {

struct FirstStateInputs {
  const TrainingScene& scene;
  const TrainConfig& config;
  const std::vector<TrainingView>& views;
  const std::vector<float>& depth_scales;  ///< one per view: prior depth times this is in scene units
};

struct FirstState {
  TrainingState state;
  std::string warning;  ///< where memory allows fewer Gaussians than the settings ask for; else empty
};

/// The start model, in Morton order where the settings ask for it, and the most Gaussians that fit into `budget` with
/// this engine. Error{kBadInput} for a scene without points and depth, Error{kResources} where even the start does not
/// fit.
FirstState first_state(const FirstStateInputs& in, const Engine& engine, MemoryBudget& budget, ThreadPool& pool);

}  // namespace aligngs
