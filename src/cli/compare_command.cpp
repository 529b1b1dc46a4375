// `aligngs compare RUN RUN...`: figures side by side, with the noise they carry.
#include <CLI/App.hpp>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "cli/report/comparison.h"
#include "cli/report/same_room.h"
#include "core/log.h"
#include "io/atomic_file.h"
#include "io/output_place.h"
#include "train/run_folder.h"

namespace aligngs {
namespace {

struct CompareOptions {
  std::vector<std::string> runs;
  std::string csv, html;
};

nlohmann::ordered_json comparison_json(const std::vector<RunScores>& runs) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const RunScores& run : runs) {
    nlohmann::ordered_json row = {{"run", run.name}, {"folder", run.folder.string()}};
    for (size_t c = 0; c < kScoreCount; ++c) {
      row[score_columns()[c].csv_name] =
          std::isfinite(run.score[c]) ? nlohmann::ordered_json(run.score[c]) : nlohmann::ordered_json(nullptr);
    }
    if (&run != &runs[0]) {
      row["different_room"] = run.other_room;
      for (const ViewScoreColumn& c : view_score_columns()) {
        const PairedDifference d = view_difference(runs[0], run, c.score);
        if (d.pairs == 0) continue;
        nlohmann::ordered_json& difference = row[std::string(c.csv_name) + "_difference"];
        difference = {{"mean", d.mean}, {"low", nullptr}, {"high", nullptr}, {"views", d.pairs}};
        if (!d.has_interval()) continue;
        difference["low"] = d.low;
        difference["high"] = d.high;
      }
    }
    out.push_back(std::move(row));
  }
  return out;
}

void compare(const CommandContext& context, const CompareOptions& options) {
  require_extension(options.csv, "csv");
  require_extension(options.html, "html");
  const auto require_place = [&](const std::string& file, const std::string& own_beginning) {
    if (file.empty()) return;
    require_output_file(file);
    for (const std::string& run : options.runs) RunFolder(run).require_not_of_run(file, {}, own_beginning);
  };
  require_place(options.csv, comparison_csv({}));  // its header
  require_place(options.html, {});
  std::vector<RunScores> runs;
  for (const std::string& folder : options.runs) runs.push_back(read_run_scores(folder));
  name_apart(runs);
  mark_other_rooms(runs);
  for (const std::string& warning : comparison_warnings(runs)) log_warning("{}", warning);
  if (!options.csv.empty()) write_file_atomically(options.csv, comparison_csv(runs));
  if (!options.html.empty()) write_file_atomically(options.html, comparison_page(runs));
  if (context.global.json) {
    print_json(comparison_json(runs));
  } else {
    std::fputs(comparison_text(runs).c_str(), stdout);
  }
}

}  // namespace

void add_compare_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("compare", "Put the figures and pictures of runs side by side");
  command->group("Measure");
  command->footer(
      help_footer({.reads = "run folders with metrics.json",
                   .writes = "a table on standard output; with --csv and --html also files",
                   .example = "aligngs compare base_run other_run",
                   .advanced = "aligngs compare base_run second_run third_run --html compare.html --csv compare.csv",
                   .notes = "Differences are to the first run, view by view, with a 95 % interval.\n"
                            "Few shared views and runs of different rooms have none.\n"
                            "Figures of a whole run have no interval: geometry, mIoU."}));
  auto options = std::make_shared<CompareOptions>();
  command->add_option("runs", options->runs, "run folders with metrics.json; the first is the one to compare with")
      ->required()
      ->expected(2, 1000);
  command->add_option("--csv", options->csv, "write the table as CSV");
  command->add_option("--html", options->html, "write a page with the table, and the test views side by side");
  command->callback([&context, options] { compare(context, *options); });
}

}  // namespace aligngs
