#include "cli/photo_options.h"

#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include "core/error.h"
#include "core/log.h"
#include "core/memory_budget.h"
#include "priors/camera_networks.h"
#include "priors/model_sets.h"

namespace aligngs {
namespace {

PosesMethod method_of(const std::string& name) {
  if (name == "da3") return PosesMethod::kDa3;
  if (name == "colmap") return PosesMethod::kColmap;
  return name == "given" ? PosesMethod::kGiven : PosesMethod::kVggt;
}

}  // namespace

void add_photo_options(CLI::App& command, const std::shared_ptr<PhotoCommandOptions>& options) {
  ScenePhotosOptions& poses = options->poses;
  const char* const group = "Cameras of photos";
  command
      .add_option("--method", options->method,
                  "auto (the best network that is installed, as doctor lists them), vggt or da3 (networks), colmap (a "
                  "program, needs overlap) or given (your own cameras)")
      ->check(CLI::IsMember({"auto", "vggt", "da3", "colmap", "given"}))
      ->capture_default_str()
      ->group(group);
  command.add_option("--max-size", poses.max_side, "longer side of the photos in pixels; larger photos are shrunk")
      ->check(CLI::Range(64, 65535))
      ->capture_default_str()
      ->group(group);
  command.add_option("--views", poses.video_views, "frames to take of a video")
      ->check(CLI::Range(3, 10000))
      ->capture_default_str()
      ->group(group);
  command.add_option("--test-every", poses.test_every, "keep every n-th photo for testing (default: all photos train)")
      ->check(CLI::Range(2, 1000000))
      ->group(group);
  command.add_option("--poses-model", options->model, "vggt, da3: weights (default: vggt-1b, da3-base)")
      ->check(CLI::IsMember(
          {"vggt-1b", "vggt-1b-commercial", "lingbot-map", "da3-small", "da3-base", "da3-large", "da3-giant"}))
      ->group(group);
  command
      .add_option("--drop-percent", poses.drop_percent,
                  "vggt, da3: percentage of the depth to leave out, lowest confidence first")
      ->check(CLI::Range(0.0, 99.0))
      ->capture_default_str()
      ->group(group);
  command
      .add_flag("--shared-focal", poses.shared_focal,
                "vggt, da3: one focal length for all photos (one camera, no zoom)")
      ->group(group);
  command
      .add_flag("--camera-from-rays", poses.camera_from_rays,
                "da3: cameras from the predicted rays, with a principal point of their own")
      ->group(group);
  command
      .add_option("--metres", options->metric_model,
                  "da3: network that tells metres: da3metric-large, none, or auto (if installed)")
      ->check(CLI::IsMember({"auto", "none", "da3metric-large"}))
      ->capture_default_str()
      ->group(group);
  command.add_option("--max-points", poses.max_points, "vggt, da3: largest number of points")
      ->check(CLI::Range(1000, 10000000))
      ->capture_default_str()
      ->group(group);
  command
      .add_option("--cameras", options->cameras,
                  "given: COLMAP model or transforms.json (default: the one beside the photos)")
      ->group(group);
  command.add_flag("--per-photo-camera", options->per_photo_camera, "colmap: a camera of its own for each photo")
      ->group(group);
  command.add_option("--precision", options->precision, "numbers of the networks: auto, bfloat16 or float32")
      ->check(CLI::IsMember({"auto", "bfloat16", "float32"}))
      ->capture_default_str()
      ->group(group);
}

nn::Precision default_precision() {
#if defined(__x86_64__) && !defined(ALIGNGS_SCALAR_ONLY)
  __builtin_cpu_init();
  // Networks were published for bfloat16; without instructions for it float32 is faster.
  if (__builtin_cpu_supports("avx512bf16")) return nn::Precision::kBfloat16;
#endif
  return nn::Precision::kFloat32;
}

nn::Precision precision_of(const std::string& name) {
  if (name == "float32") return nn::Precision::kFloat32;
  if (name == "bfloat16") return nn::Precision::kBfloat16;
  return default_precision();
}

void warn_of_terms(const PublishedModel& model, const char* purpose) {
  const ModelLicence& licence = model.licence;
  if (licence.commercial && licence.question.empty()) return;
  log_warning("{} by {}, as no other network for them is installed: licence {}, {}", purpose, model.name, licence.id,
              licence.question.empty() ? licence.note : licence.question);
}

void choose_method(PhotoCommandOptions& options, const ModelStore& store) {
  if (options.method != "auto") return;
  if (!options.cameras.empty()) {
    options.method = "given";
    return;
  }
  if (options.model.empty() && (options.poses.camera_from_rays || options.metric_model == "da3metric-large")) {
    options.method = "da3";
    return;
  }
  if (options.model.empty()) {
    const CameraNetwork* const best = best_camera_network(store);
    if (!best) {
      const auto size = [](const char* set) {
        uint64_t bytes = 0;
        for (const PublishedModel* model : models_of({set})) bytes += download_bytes(*model);
        return format_bytes(bytes);
      };
      throw Error({ErrorKind::kWeights,
                   "no network that finds cameras is installed",
                   {},
                   "method",
                   fmt::format("aligngs models download recommended   ({}), or light ({}); weights that anyone may use",
                               size("recommended"), size("light"))});
    }
    options.model = best->model;
    log_info("cameras by {}: {}", best->model, best->reason);
    warn_of_terms(published_model(best->model), "cameras");
  }
  options.method = method_of_camera_network(options.model);
}

const PublishedModel* installed_camera_network(const PhotoCommandOptions& options, const ModelStore& store) {
  const bool named = !options.model.empty() || options.method == "vggt" || options.method == "da3";
  const CameraNetwork* const best = named ? nullptr : best_camera_network(store);
  if (!named && !best) return nullptr;
  const PublishedModel& model = published_model(!named                   ? best->model
                                                : !options.model.empty() ? options.model
                                                                         : poses_model(options));
  return store.installed(model) ? &model : nullptr;
}

std::string poses_model(const PhotoCommandOptions& options) {
  const bool da3 = options.method == "da3";
  if (options.model.empty()) return da3 ? "da3-base" : "vggt-1b";
  if ((method_of_camera_network(options.model) == "da3") != da3) {
    throw_usage(options.model + " is no network of --method " + options.method,
                std::string("with it goes --method ") + (da3 ? "vggt" : "da3"));
  }
  return options.model;
}

ScenePhotosOptions photo_options(const PhotoCommandOptions& options, const CommandContext& context) {
  if (!options.cameras.empty() && options.method != "given")
    throw_usage("--cameras goes with --method given", "add --method given, or leave --cameras out");
  if (options.poses.camera_from_rays && options.method != "da3")
    throw_usage("--camera-from-rays goes with --method da3", "add --method da3, or leave --camera-from-rays out");
  if (options.metric_model == "da3metric-large" && options.method != "da3")
    throw_usage("--metres goes with --method da3", "add --method da3, or leave --metres out");
  ScenePhotosOptions poses = options.poses;
  if (options.metric_model == "none") poses.metric_model.clear();
  poses.metric_model_needed = options.metric_model == "da3metric-large";
  poses.method = method_of(options.method);
  poses.cameras = options.cameras;
  if (uses_network(poses.method)) poses.model = poses_model(options);
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
