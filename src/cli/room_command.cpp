// `aligngs room RUN`: the room as data.
#include <CLI/App.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/device_option.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "cli/stages/room_stage.h"
#include "room/room_json.h"

namespace aligngs {

void add_room_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("room", "Measure walls, openings and furniture of a run's room");
  command->group("Measure");
  command->footer(help_footer(
      {.reads = "a run folder, and its scene",
       .writes = "RUN/room.json, whose fields docs/room.md lists",
       .example = "aligngs room demo_run",
       .advanced = "aligngs room demo_run --json --scene ../scene",
       .notes = "Lengths are metres where the scene has a scale. Walls that no photo shows are marked as assumed. "
                "Doors, windows and furniture need a run with labels."}));
  struct Options {
    std::string run, scene, device = "auto";
  };
  auto options = std::make_shared<Options>();
  command->add_option("run", options->run, "run folder")->required();
  command->add_option("--scene", options->scene, "the scene's new place, if it was moved");
  add_device_option(*command, options->device);
  command->callback([&context, options] {
    LoadedRun run = load_run(options->run, {options->scene, context.global.threads, engine_of_device(options->device)});
    const MeasuredRoom room = room_run(run);
    if (context.global.json) {
      std::fputs(room_json(room).c_str(), stdout);
    } else {
      std::fputs(room_summary(room).c_str(), stdout);
      std::printf("written      %s\n", (run.folder() / "room.json").string().c_str());
    }
  });
}

}  // namespace aligngs
