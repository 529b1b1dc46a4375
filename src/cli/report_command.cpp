// `aligngs report RUN`: report.html and overview.jpg from the files of the run folder.
#include <CLI/App.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/report/html_report.h"
#include "io/json_text.h"
#include "train/opened_run.h"

namespace aligngs {

void add_report_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("report", "Write report.html: numbers, pictures, charts, settings");
  command->group("Measure");
  command->footer(help_footer({.reads = "a run folder",
                               .writes = "RUN/report.html and RUN/overview.jpg",
                               .example = "aligngs report demo_run",
                               .advanced = "aligngs report demo_run --json"}));
  auto run = std::make_shared<std::string>();
  command->add_option("run", *run, "run folder")->required();
  command->callback([&context, run] {
    const std::filesystem::path folder = *run;
    require_run_folder(folder);
    write_report(folder);
    const std::string page = (folder / "report.html").string();
    if (context.global.json)
      std::printf("%s\n", json_line(nlohmann::json({{"report", page}})).c_str());
    else
      std::printf("%s\n", page.c_str());
  });
}

}  // namespace aligngs
