// Shared parts of all subcommands: global options, results on standard output, the text it was started with.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/progress.h"

namespace CLI {
class App;
}

namespace aligngs {

struct GlobalOptions {
  bool json = false;     ///< results as one JSON document on standard output
  bool quiet = false;    ///< warnings and errors only, no progress
  bool offline = false;  ///< never touch the network
  int verbose = 0;       ///< 1: debug messages
  int threads = 0;       ///< 0: all hardware threads
};

struct CommandContext {
  GlobalOptions global;
  std::string command_line;  ///< as typed, for run.json
  ProgressStyle progress() const {
    ProgressStyle style = ProgressStyle::detect();
    style.enabled = !global.quiet;
    return style;
  }
};

/// Adds one subcommand to the program; its callback does the work and throws Error on failure.
using AddCommand = void (*)(CLI::App& program, CommandContext& context);

void add_run_command(CLI::App& program, CommandContext& context);
void add_demo_command(CLI::App& program, CommandContext& context);
void add_import_command(CLI::App& program, CommandContext& context);
void add_refine_command(CLI::App& program, CommandContext& context);
void add_synth_command(CLI::App& program, CommandContext& context);
void add_data_command(CLI::App& program, CommandContext& context);
void add_models_command(CLI::App& program, CommandContext& context);
void add_poses_command(CLI::App& program, CommandContext& context);
void add_priors_command(CLI::App& program, CommandContext& context);
void add_train_command(CLI::App& program, CommandContext& context);
void add_render_command(CLI::App& program, CommandContext& context);
void add_mesh_command(CLI::App& program, CommandContext& context);
void add_room_command(CLI::App& program, CommandContext& context);
void add_scale_command(CLI::App& program, CommandContext& context);
void add_eval_command(CLI::App& program, CommandContext& context);
void add_report_command(CLI::App& program, CommandContext& context);
void add_compare_command(CLI::App& program, CommandContext& context);
void add_edit_command(CLI::App& program, CommandContext& context);
void add_export_command(CLI::App& program, CommandContext& context);
void add_view_command(CLI::App& program, CommandContext& context);
void add_info_command(CLI::App& program, CommandContext& context);
void add_bench_command(CLI::App& program, CommandContext& context);
void add_doctor_command(CLI::App& program, CommandContext& context);
void add_completion_command(CLI::App& program, CommandContext& context);
void add_manual_command(CLI::App& program, CommandContext& context);

/// Global options and all subcommands, in the order of the help.
void add_all_commands(CLI::App& program, CommandContext& context);

/// The word of `candidates` nearest to `word` by edit distance, or empty when none is near (more than a third
/// of the letters differ).
std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace aligngs
