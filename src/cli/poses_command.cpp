// `aligngs poses PHOTOS -o SCENE`: cameras and a cloud for photos.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/number_checks.h"
#include "cli/photo_options.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "core/shell_word.h"
#include "priors/given_poses.h"
#include "priors/teacher_list.h"
#include "scene/import/capture.h"

namespace aligngs {
namespace {

/// Without its weights a network cannot run: the method without one is worth a line.
[[noreturn]] void offer_colmap(const Error& error, const std::string& photos, const std::string& scene) {
  Error::Details details = error.details();
  if (has_given_cameras(photos)) {
    details.remedy +=
        fmt::format("\n  or use the cameras that lie beside the photos: aligngs poses {} -o {} --method given",
                    quote_word(photos), quote_word(scene));
  }
  details.remedy += fmt::format("\n  or let COLMAP find the cameras: aligngs poses {} -o {} --method colmap",
                                quote_word(photos), quote_word(scene));
  throw Error(details);
}

/// COLMAP was asked for by name, and given cameras lie where --cameras says: both take any folder of photos.
void require_photos_alone(const std::string& photos, const std::string& scene, const PhotoCommandOptions& options) {
  if (options.method == PosesMethod::kColmap || !options.cameras.empty() || !std::filesystem::is_directory(photos))
    return;
  refuse_posed_capture(photos,
                       fmt::format("use them: aligngs import {} -o {}\n  or give the folder of its photos alone",
                                   quote_word(photos), quote_word(scene)));
}

void print_report(const CommandContext& context, const std::string& scene, const ScenePhotosReport& report) {
  if (context.global.json) {
    nlohmann::json unplaced = nlohmann::json::array();
    for (const LeftOut& photo : report.unplaced) unplaced.push_back({{"name", photo.name}, {"reason", photo.reason}});
    nlohmann::json document = {{"scene", scene},
                               {"method", report.method},
                               {"photos", report.photos},
                               {"placed", report.placed},
                               {"train", report.train},
                               {"test", report.test},
                               {"points", report.points},
                               {"reprojection_error", report.reprojection_error},
                               {"seconds", report.seconds},
                               {"unplaced", unplaced}};
    if (report.metres) {
      document["metres"] = {{"scale", report.metres->scale},
                            {"spread", report.metres->spread},
                            {"photos", report.metres->photos},
                            {"source", "network estimate"}};
    }
    print_json(document);
    return;
  }
  std::printf("%s: %zu of %zu photos placed by %s in %s, %zu points%s\n", scene.c_str(), report.placed, report.photos,
              report.method == word_of(PosesMethod::kGiven) ? "the given cameras" : report.method.c_str(),
              format_duration(report.seconds).c_str(), report.points,
              report.reprojection_error > 0
                  ? fmt::format(", reprojection error {:.2f} px", report.reprojection_error).c_str()
                  : "");
  const std::string word = quote_word(scene);
  std::printf("next: aligngs priors %s   then: aligngs run %s -o run\n", word.c_str(), word.c_str());
}

}  // namespace

void add_poses_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("poses", "Find the cameras of photos");
  command->group("Data");
  command->footer(
      help_footer({.reads = "a folder of photos (JPEG, PNG, WebP, HEIC), or a video",
                   .writes = "SCENE: a scene folder with cameras and a cloud",
                   .example = "aligngs poses photos -o scene --method colmap",
                   .advanced = "aligngs poses photos -o scene --method given --cameras sparse/0 --test-every 8",
                   .notes = "Networks need weights: aligngs models download recommended, or light"}));
  auto options = std::make_shared<PhotoCommandOptions>();
  auto photos = std::make_shared<std::string>();
  auto scene = std::make_shared<std::string>();
  command->add_option("photos", *photos, "folder of photos, or a video (needs the program ffmpeg)")->required();
  command->add_option("-o,--output", *scene, "scene folder to write")->required()->group("Output folder");
  command->add_flag("--overwrite", options->poses.overwrite, "replace a scene that aligngs wrote")
      ->group("Output folder");
  command
      ->add_flag("--strict", options->poses.strict,
                 "a photo that cannot be used is an error (status 3); without this it is left out")
      ->group("Cameras of photos");
  command->add_option("--memory", options->memory_gigabytes, "memory budget in GB (default: 80 % of the free memory)")
      ->check(positive_number())
      ->group("Machine");
  add_device_option(*command, options->device);
  add_photo_options(*command, options);
  command->callback([&context, options, photos, scene] {
    try {
      chosen_device(options->device, false);  // a device that is not there is said before weights that are not
      require_photos_alone(*photos, *scene, *options);
      choose_method(*options, model_store(context));
      ScenePhotosOptions poses = photo_options(*options, context);
      if (is_camera_network_method(poses.method)) put_networks_on(options->device, options->precision, true, poses);
      print_report(context, *scene, run_poses(*photos, *scene, poses, model_store(context)));
    } catch (const Error& error) {
      const bool network = options->method == PosesMethod::kAuto || is_camera_network_method(options->method);
      if (error.kind() == ErrorKind::kWeights && network) offer_colmap(error, *photos, *scene);
      throw;
    }
  });
}

}  // namespace aligngs
