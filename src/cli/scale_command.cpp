// `aligngs scale RUN`: the scale of a run from a known length.
#include <CLI/App.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "cli/stages/room_stage.h"
#include "core/error.h"
#include "room/room_json.h"
#include "room/room_scale.h"

namespace aligngs {
namespace {

/// "x,y,z".
Vec3d point_of(const std::string& text) {
  Vec3d p;
  int end = 0;
  const bool whole = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &p.x, &p.y, &p.z, &end) == 3 &&
                     static_cast<size_t>(end) == text.size();
  if (!whole || !std::isfinite(dot(p, p)))
    throw_usage("\"" + text.substr(0, 40) + "\" is no point", "write three numbers with commas: \"0.5,1.2,-3\"");
  return p;
}

double number_of(const std::string& text) {
  double x = 0;
  int end = 0;
  if (std::sscanf(text.c_str(), "%lf%n", &x, &end) != 1 || static_cast<size_t>(end) != text.size()) {
    throw_usage("\"" + text.substr(0, 40) + "\" is no length", "give metres, for example 0.9");
  }
  return x;
}

}  // namespace

void add_scale_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("scale", "Set the scale of a run from a length that you know");
  command->group("Measure");
  command->footer(help_footer({.reads = "RUN/room.json, which aligngs room writes",
                               .writes = "RUN/room.json, whose scale exports and plans use",
                               .example = "aligngs scale demo_run --object door.1 --height 2.0",
                               .advanced = "aligngs scale demo_run --between \"0,1,2\" \"0.5,1,2\" 0.90",
                               .notes = "Points are places of the scene, as in scene.ply. A new `aligngs room` keeps "
                                        "the scale. --reset takes it back."}));
  struct Options {
    std::string run, object;
    std::vector<std::string> between;
    std::optional<double> height, width, depth, length;
    bool reset = false;
  };
  auto options = std::make_shared<Options>();
  command->add_option("run", options->run, "run folder with room.json")->required();
  CLI::Option* object =
      command->add_option("--object", options->object, "a name of room.json: door.1, wall.2, ceiling, sofa.1");
  CLI::Option* sides[] = {command->add_option("--height", options->height, "its height, metres"),
                          command->add_option("--width", options->width, "its width, metres"),
                          command->add_option("--depth", options->depth, "its depth, metres"),
                          command->add_option("--length", options->length, "its length, metres")};
  for (CLI::Option* side : sides) side->needs(object);
  CLI::Option* between =
      command->add_option("--between", options->between, "two points \"x,y,z\" and the metres between them")
          ->expected(3);
  CLI::Option* reset = command->add_flag("--reset", options->reset, "take a given scale back");
  object->excludes(between)->excludes(reset);
  between->excludes(reset);
  command->callback([&context, options] {
    const std::filesystem::path file = std::filesystem::path(options->run) / "room.json";
    const MeasuredRoom before = read_run_room(options->run);
    MeasuredRoom room;
    if (options->reset) {
      room = with_scale_of_scene(before, options->run);
    } else if (!options->between.empty()) {
      const Vec3d a = point_of(options->between[0]), b = point_of(options->between[1]);
      room = scaled_between(before, a, b, number_of(options->between[2]));
    } else if (!options->object.empty()) {
      const std::pair<KnownSide, std::optional<double>> given[] = {{KnownSide::kHeight, options->height},
                                                                   {KnownSide::kWidth, options->width},
                                                                   {KnownSide::kDepth, options->depth},
                                                                   {KnownSide::kLength, options->length}};
      const auto is_given = [](const auto& side) { return side.second.has_value(); };
      const auto chosen = std::find_if(std::begin(given), std::end(given), is_given);
      const auto count = std::count_if(std::begin(given), std::end(given), is_given);
      if (count > 1) throw_usage("two lengths may say two scales", "give one of --height, --width, --depth, --length");
      if (chosen == std::end(given))
        throw_usage("the length is missing", "give one of --height, --width, --depth, --length");
      room = scaled_to(before, measured_side(before, options->object, chosen->first), *chosen->second);
    } else {
      throw_usage("nothing says what the scale is",
                  "give --object NAME --height METRES, or --between A B METRES, or --reset");
    }
    const double factor = write_scale(file, before, room);
    if (context.global.json) {
      const nlohmann::json document = {{"factor", factor},
                                       {"units_per_scene_unit", room.to_room.scale},
                                       {"source", name_of(room.scale_source)},
                                       {"file", file.string()}};
      print_json(document);
    } else {
      std::printf("lengths are multiplied by %.6g; scale %s\n%s", factor, name_of(room.scale_source),
                  room_summary(room).c_str());
    }
  });
}

}  // namespace aligngs
