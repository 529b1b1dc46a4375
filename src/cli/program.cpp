#include "cli/program.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>
#include <string_view>

#include "cli/batch_command.h"
#include "cli/command.h"
#include "cli/given_options.h"
#include "cli/print_json.h"
#include "core/edit_distance.h"
#include "core/error.h"
#include "core/log.h"
#include "core/shell_word.h"
#include "core/standard_streams.h"
#include "core/stop_signal.h"
#include "core/version.h"
#include "io/file_system_error.h"

namespace aligngs {
namespace {

/// CLI11's exit codes are its own; ours has one for every usage error.
constexpr int kUsageStatus = static_cast<int>(ErrorKind::kUsage);

/// `aligngs` alone prints this start instead of all commands.
constexpr const char* kStart =
    "aligngs turns photos of a room into labelled Gaussian splats and a labelled mesh.\n\n"
    "  aligngs demo                                                    reconstruct a synthetic room\n"
    "  aligngs run PHOTOS -o RUN --method colmap --semantics none      your photos, without network weights\n"
    "  aligngs import CAPTURE -o SCENE, then aligngs run SCENE -o RUN  a posed capture or an RGB-D scan\n"
    "  aligngs view RUN                                                look at a run in the browser\n"
    "  aligngs doctor                                                  check this machine\n\n"
    "`aligngs --help` lists all commands. `aligngs COMMAND --help` shows options and examples.\n";

std::string join(int argc, char** argv) {
  std::string text = "aligngs";
  for (int i = 1; i < argc; ++i) text += " " + quote_word(argv[i]);
  return text;
}

void add_global_options(CLI::App& program, GlobalOptions& global) {
  program.add_flag("--json", global.json, "print the results as one JSON document on standard output")
      ->group("Everywhere");
  program.add_flag("-q,--quiet", global.quiet, "warnings and errors only")->group("Everywhere");
  program.add_flag("-v,--verbose", global.verbose, "debug messages")->group("Everywhere");
  program.add_flag("--offline", global.offline, "forbid all network access")->group("Everywhere");
  program.add_option("--threads", global.threads, "worker threads (default: one per hardware thread)")
      ->check(CLI::Range(0, 1024))
      ->group("Everywhere");
}

/// The status, unless what was printed did not arrive: a full disk shows at any earlier flush, or at the last one.
int finish_output(int status) {
  errno = 0;
  std::cout.flush();
  const bool lost = std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout;
  if (!lost || status != 0) return status;
  log_error("standard output cannot be written{}{}", errno != 0 ? ": " : "", errno != 0 ? std::strerror(errno) : "");
  return static_cast<int>(ErrorKind::kResources);
}

std::vector<std::string> command_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* sub : program.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  return names;
}

/// The same on standard output for programs. Parsing ended early, so that the flag may not have been read yet.
void print_usage_error(const std::string& message, const std::string& remedy, int argc, char** argv) {
  if (std::find(argv, argv + argc, std::string_view("--json")) == argv + argc) return;
  const nlohmann::json document = {
      {"error", {{"status", kUsageStatus}, {"message", message}, {"path", ""}, {"field", ""}, {"remedy", remedy}}}};
  print_json(document);
}

int report_usage_error(const CLI::App& program, const CLI::ParseError& error, int argc, char** argv) {
  std::string hint;
  if (argc > 1 && argv[1][0] != '-') {
    const std::vector<std::string> names = command_names(program);
    if (std::find(names.begin(), names.end(), argv[1]) == names.end()) {
      const std::string message = fmt::format("there is no command \"{}\"", argv[1]);
      print_usage_error(message, "`aligngs --help` lists the commands", argc, argv);
      log_error("{}", message);
      const std::string near = nearest_word(argv[1], names);
      if (!near.empty()) std::fprintf(stderr, "  did you mean: aligngs %s\n", near.c_str());
      std::fputs("  remedy: `aligngs --help` lists the commands\n", stderr);
      return kUsageStatus;
    }
    hint = std::string(" ") + argv[1];
  }
  const std::string remedy = "`aligngs" + hint + " --help` shows the options and an example";
  std::string message = error.what();
  const UnknownOption unknown = find_unknown_option(program, {argv + 1, argv + argc});
  if (!unknown.name.empty()) message = fmt::format("there is no option \"{}\"", unknown.name);
  print_usage_error(message, remedy, argc, argv);
  log_error("{}", message);
  if (!unknown.nearest.empty()) std::fprintf(stderr, "  did you mean: %s\n", unknown.nearest.c_str());
  std::fprintf(stderr, "  remedy: %s\n", remedy.c_str());
  return kUsageStatus;
}

int report_error(const Error& error, bool json) {
  if (json) {
    const Error::Details& d = error.details();
    const nlohmann::json document = {{"error",
                                      {{"status", error.exit_status()},
                                       {"message", d.message},
                                       {"path", d.path.string()},
                                       {"field", d.field},
                                       {"remedy", d.remedy}}}};
    print_json(document);
  }
  log_error("{}", error.what());
  return error.exit_status();
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best;
  size_t best_distance = word.size() / 3 + 1;
  for (const std::string& candidate : candidates) {
    const size_t distance = edit_distance(word, candidate);
    if (distance <= best_distance && (best.empty() || distance < best_distance)) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

void add_all_commands(CLI::App& program, CommandContext& context) {
  add_global_options(program, context.global);
  for (const AddCommand add :
       {&add_run_command,    &add_demo_command,   &add_batch_command,   &add_import_command, &add_synth_command,
        &add_refine_command, &add_data_command,   &add_models_command,  &add_poses_command,  &add_priors_command,
        &add_train_command,  &add_render_command, &add_mesh_command,    &add_room_command,   &add_scale_command,
        &add_eval_command,   &add_report_command, &add_compare_command, &add_edit_command,   &add_export_command,
        &add_view_command,   &add_info_command,   &add_bench_command,   &add_doctor_command, &add_completion_command,
        &add_manual_command}) {
    add(program, context);
  }
}

int run_program(int argc, char** argv) {
  reserve_standard_streams();
  if (argc <= 1) {
    std::fputs(kStart, stderr);
    return kUsageStatus;
  }
  install_stop_handlers();  // before the options of all commands are set up, which takes milliseconds
  CommandContext context;
  context.command_line = join(argc, argv);
  CLI::App program(
      "aligngs turns photos of a room into a labelled 3D scene: Gaussian splats, a mesh,\n"
      "class labels, and measurements of all of them.\n\n"
      "Example: aligngs demo",
      "aligngs");
  program.set_version_flag("--version", std::string("aligngs ") + version());
  program.require_subcommand(1);
  program.fallthrough();
  program.get_formatter()->column_width(36);
  // Options are parsed completely before any command runs, so that --json after the command counts.
  program.parse_complete_callback([&context, &program] {
    require_given_values(program);
    if (context.global.quiet) set_log_level(LogLevel::kWarning);
    if (context.global.verbose > 0) set_log_level(LogLevel::kDebug);
  });
  add_all_commands(program, context);

  try {
    program.parse(argc, argv);
    return finish_output(0);
  } catch (const CLI::Success& request) {  // --help, --version
    return finish_output(program.exit(request));
  } catch (const CLI::ParseError& error) {
    return report_usage_error(program, error, argc, argv);
  } catch (const Error& error) {
    return report_error(error, context.global.json);
  } catch (const std::bad_alloc&) {
    return report_error(
        Error(
            {ErrorKind::kResources,
             "out of memory",
             {},
             {},
             "free memory, or raise the limit (ulimit -v); training needs less with fewer Gaussians or smaller images "
             "(--set densify.max_gaussians=100000, --set data.scale=0.5)"}),
        context.global.json);
  } catch (const std::filesystem::filesystem_error& error) {
    return report_error(error_of(error), context.global.json);
  } catch (const nlohmann::json::exception& error) {
    return report_error(Error({ErrorKind::kBadInput,
                               std::string("a JSON file does not have the expected form: ") + error.what(),
                               {},
                               {},
                               {}}),
                        context.global.json);
  } catch (const std::exception& error) {
    return report_error(Error({ErrorKind::kFailed, error.what(), {}, {}, {}}), context.global.json);
  }
}

}  // namespace aligngs
