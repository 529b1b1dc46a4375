// The scene of a training as it is used: checked, without the views that cannot be used, with its priors chosen.
#pragma once

#include <filesystem>
#include <string>

#include "scene/scene.h"
#include "train/config.h"
#include "train/training_set.h"

namespace aligngs {

struct TrainingScene {
  Scene scene;              ///< without views that cannot be used (Scene::left_out)
  PriorUse use;             ///< priors that the training takes
  std::string fingerprint;  ///< of the views that are left
  double extent = 1;        ///< robust extent, scene units
};

struct TrainingSceneRules {
  bool strict = false;           ///< a view that cannot be used is an error instead of being left out
  bool require_priors = false;   ///< missing depth or semantics are Error{kWeights} instead of a warning
  bool labels_unwanted = false;  ///< missing semantics are no warning
};

/// Opens the scene in `folder` and checks every file of it. The log names doubtful ones. Error{kBadInput} for a
/// scene that cannot be trained on, with its first problem.
TrainingScene open_training_scene(const std::filesystem::path& folder, const TrainConfig& config,
                                  const TrainingSceneRules& rules);

}  // namespace aligngs
