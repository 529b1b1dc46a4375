#include "cli/photo_options.h"

#include <CLI/App.hpp>

#include <fmt/format.h>

#include "cli/choice_option.h"
#include "core/error.h"
#include "core/log.h"
#include "priors/teacher_list.h"
#include "priors/video_frames.h"

namespace aligngs {

void add_photo_options(CLI::App& command, const std::shared_ptr<PhotoCommandOptions>& options) {
  ScenePhotosOptions& poses = options->poses;
  const char* const group = "Cameras of photos";
  std::vector<std::string> weights;
  std::string defaults;  // of the methods, in their order
  for (const PosesMethod method : camera_network_methods())
    defaults += std::string(defaults.empty() ? "" : ", ") + default_camera_teacher(method).model;
  for (const Teacher* teacher : camera_teachers()) weights.emplace_back(teacher->model);
  const std::string networks = camera_method_words(", ");
  add_choice_option(command, "--method", options->method,
                    fmt::format("auto (the best network that is installed, as doctor lists them), {} (networks), "
                                "colmap (a program, needs overlap) or given (your own cameras)",
                                camera_method_words(" or ")))
      ->group(group);
  command.add_option("--max-size", poses.max_side, "longer side of the photos in pixels; larger photos are shrunk")
      ->check(CLI::Range(64, 65535))
      ->capture_default_str()
      ->group(group);
  command
      .add_option(
          "--views", poses.video_views,
          fmt::format("frames to take of a video; at most {} a second of a longer clip are looked at", kMostVideoRate))
      ->check(CLI::Range(3, 10000))
      ->capture_default_str()
      ->group(group);
  command.add_option("--test-every", poses.test_every, "keep every n-th photo for testing (default: all photos train)")
      ->check(CLI::Range(2, 1000000))
      ->group(group);
  command.add_option("--poses-model", options->model, networks + ": weights (default: " + defaults + ")")
      ->check(CLI::IsMember(weights))
      ->group(group);
  command
      .add_option("--drop-percent", poses.drop_percent,
                  networks + ": percentage of the depth to leave out, lowest confidence first")
      ->check(CLI::Range(0.0, 99.0))
      ->capture_default_str()
      ->group(group);
  command
      .add_flag("--shared-focal", poses.shared_focal,
                networks + ": one focal length for all photos (one camera, no zoom)")
      ->group(group);
  command
      .add_flag("--camera-from-rays", options->camera_from_rays,
                "da3: cameras from the predicted rays, with a principal point of their own")
      ->group(group);
  add_choice_option(command, "--metres", options->metres,
                    fmt::format("da3: network that tells metres: {}, none, or auto (if installed)", kMetricModel))
      ->group(group);
  command.add_option("--max-points", poses.max_points, networks + ": largest number of points")
      ->check(CLI::Range(1000, 10000000))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--cameras", options->cameras,
                  "given: COLMAP model or transforms.json (default: the one beside the photos)")
      ->group(group);
  command.add_flag("--per-photo-camera", options->per_photo_camera, "colmap: a camera of its own for each photo")
      ->group(group);
  add_precision_option(command, options->precision, group);
}

nn::Precision precision_of(const std::string& name) {
  return choice_named<nn::Precision>(name).value_or(nn::fastest_precision());
}

void add_precision_option(CLI::App& command, std::string& precision, const std::string& group) {
  std::vector<std::string> names = choice_list<nn::Precision>();
  names.insert(names.begin(), "auto");
  command
      .add_option(
          "--precision", precision,
          "numbers of the networks: auto, bfloat16, float16 (of weights, else float32; not on a device) or float32")
      ->check(CLI::IsMember(names))
      ->capture_default_str()
      ->group(group);
}

void warn_of_terms(const PublishedModel& model, const char* purpose) {
  if (const std::string terms = terms_of_choice(model, purpose); !terms.empty()) log_warning("{}", terms);
}

void choose_method(PhotoCommandOptions& options, const ModelStore& store) {
  const CameraChoice choice = choose_cameras(options, store);
  options.method = choice.method;
  options.model = choice.model;
  if (!choice.chosen) return;
  log_info("{}", choice.reason);
  warn_of_terms(published_model(choice.model), "cameras");
}

ScenePhotosOptions photo_options(const PhotoCommandOptions& options, const CommandContext& context) {
  ScenePhotosOptions poses = options.poses;
  poses.camera_from_rays = options.camera_from_rays;
  poses.metres = options.metres;
  poses.method = options.method;
  poses.cameras = options.cameras;
  poses.model = options.model;
  poses.shared_camera = !options.per_photo_camera;
  poses.precision = precision_of(options.precision);
  poses.memory_limit = static_cast<uint64_t>(options.memory_gigabytes * 1e9);
  poses.threads = context.global.threads;
  poses.progress = context.progress();
  return poses;
}

ModelStore model_store(const CommandContext& context) {
  return ModelStore(ModelStoreOptions::from_environment(context.global.offline));
}

ScenePhotosReport run_poses(const std::string& photos, const std::string& scene, const ScenePhotosOptions& options,
                            const ModelStore& store) {
  const ScenePhotosReport report = make_scene_from_photos(photos, scene, store, options);
  warn_left_out(report.placed, report.unplaced, "photos");
  return report;
}

}  // namespace aligngs
