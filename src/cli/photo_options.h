// Command-line options of everything that begins with photos: `poses`, `priors` and `run` share them.
#pragma once

#include <memory>
#include <string>

#include "cli/command.h"
#include "priors/camera_choice.h"
#include "priors/scene_from_photos.h"
#include "priors/scene_priors.h"

namespace aligngs {

struct PhotoCommandOptions : CameraRequest {
  std::string precision = "auto", device = "auto";
  bool per_photo_camera = false;
  double memory_gigabytes = 0;
  ScenePhotosOptions poses;
};

/// Adds --method, --max-size, --test-every, --drop-percent, --shared-focal, ... to a command.
void add_photo_options(CLI::App& command, const std::shared_ptr<PhotoCommandOptions>& options);
/// After choose_method().
ScenePhotosOptions photo_options(const PhotoCommandOptions& options, const CommandContext& context);

/// Takes over what choose_cameras() (priors/camera_choice.h) finds, so that method and model are those that run. A choice
/// that nobody made is reported with its reason and its terms.
void choose_method(PhotoCommandOptions& options, const ModelStore& store);

/// A warning where a network that nobody named may not be used in every way.
void warn_of_terms(const PublishedModel& model, const char* purpose);

/// --precision of the commands that run networks.
void add_precision_option(CLI::App& command, std::string& precision, const std::string& group);
/// The precision of that name, or for "auto" nn::fastest_precision().
nn::Precision precision_of(const std::string& name);

ModelStore model_store(const CommandContext& context);

/// Makes the scene and says what came of it, photos without a camera with their reasons.
ScenePhotosReport run_poses(const std::string& photos, const std::string& scene, const ScenePhotosOptions& options,
                            const ModelStore& store);

}  // namespace aligngs
