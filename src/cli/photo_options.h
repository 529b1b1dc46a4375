// Command-line options of everything that begins with photos: `poses`, `priors` and `run` share them.
#pragma once

#include <memory>
#include <string>

#include "cli/command.h"
#include "priors/scene_from_photos.h"
#include "priors/scene_priors.h"

namespace aligngs {

struct PhotoCommandOptions {
  std::string method = "auto", precision = "auto", cameras, device = "auto";
  std::string model;  ///< empty: the method's own, see poses_model()
  std::string metric_model = "auto";
  bool per_photo_camera = false;
  double memory_gigabytes = 0;
  ScenePhotosOptions poses;
};

/// Adds --method, --max-size, --test-every, --drop-percent, --shared-focal, ... to a command.
void add_photo_options(CLI::App& command, const std::shared_ptr<PhotoCommandOptions>& options);
ScenePhotosOptions photo_options(const PhotoCommandOptions& options, const CommandContext& context);

/// The weights that find the cameras, with method vggt or da3: the requested ones, else the method's default.
/// Error{kUsage} when it is none of the method's.
std::string poses_model(const PhotoCommandOptions& options);

/// Makes "auto" a method: given where cameras are named, else that of --poses-model. Else that of the best installed
/// network, which is reported with the reason. Error{kWeights} when there is none.
void choose_method(PhotoCommandOptions& options, const ModelStore& store);

/// A warning where a network that nobody named may not be used in every way.
void warn_of_terms(const PublishedModel& model, const char* purpose);

/// The network of the cameras, for depth of photos that have cameras: named by an option, or the best installed one.
/// Null without one, or if its weights are missing.
const PublishedModel* installed_camera_network(const PhotoCommandOptions& options, const ModelStore& store);

/// bfloat16 where the processor multiplies it fast, else float32.
nn::Precision default_precision();
/// "float32", "bfloat16", or "auto": the default.
nn::Precision precision_of(const std::string& name);

ModelStore model_store(const CommandContext& context);

/// Makes the scene and says what came of it, photos without a camera with their reasons.
ScenePhotosReport run_poses(const std::string& photos, const std::string& scene, const ScenePhotosOptions& options,
                            const ModelStore& store);

}  // namespace aligngs
