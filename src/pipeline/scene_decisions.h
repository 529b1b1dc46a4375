// The work that a scene gets before it is trained, decided from its files, the settings and the installed weights. Nothing
// is changed. Every decision has its reason, for the plan of a run and for its log.
#pragma once

#include <string>

#include "priors/camera_choice.h"
#include "priors/teacher_list.h"
#include "scene/scene.h"
#include "train/config.h"

namespace aligngs {

/// How a run tells that it leaves a step out.
enum class Notice { kNone, kInfo, kWarning };

struct Decision {
  bool wanted = false;
  std::string reason = {};  ///< one sentence without a final stop
  Notice notice = Notice::kNone;
  const PublishedModel* network = nullptr;  ///< that does the step
  std::string terms = {};                   ///< of a network that nobody named; empty where it may be used in every way
};

/// The request for priors that a scene lacks.
struct PriorRequest {
  PriorChoice depth, semantics;
};

/// Depth by a network. Depth that can be measured in the photos is not left to networks that see one photo at a time.
Decision decide_depth(const Scene& scene, const PriorRequest& priors, const CameraRequest& cameras,
                      const TrainConfig& config, const ModelStore& store);
/// The same for a scene that is still to be made of photos, without depth. `measurable`: depth can be measured in it.
Decision decide_depth(bool measurable, const PriorRequest& priors, const CameraRequest& cameras,
                      const ModelStore& store);

/// Class labels by a network.
Decision decide_classes(const Scene& scene, const PriorRequest& priors, const ModelStore& store);
/// The same for a scene without labels.
Decision decide_classes(const PriorRequest& priors, const ModelStore& store);

/// Depth measured in the photos: data.measure_depth asks for it, prior depth is wanted, and the scene has points and no
/// prior depth.
Decision decide_measure(const Scene& scene, const TrainConfig& config);
/// Whether the settings allow it, whatever the scene is.
Decision may_measure(const TrainConfig& config);

/// Cameras and prior depth corrected: data.refine_cameras asks for it. Every training view has metric prior depth that
/// training will use and that no sensor made. The scene has not been refined before.
Decision decide_refine(const Scene& scene, const TrainConfig& config);
Decision may_refine(const TrainConfig& config);

/// Exposures measured (data.sensor_exposure and data.exposure), and holes of the depth filled (data.fill_depth). Every
/// training view needs depth in scene units, of a sensor or given. Refining and measuring depth do such work themselves.
Decision decide_complete(const Scene& scene, const TrainConfig& config);
Decision may_complete(const TrainConfig& config);

}  // namespace aligngs
