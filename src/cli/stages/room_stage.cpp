#include "cli/stages/room_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/log.h"
#include "edit/edit_session.h"
#include "edit/export/furniture_points.h"
#include "edit/room_up.h"
#include "room/room_json.h"
#include "room/unlabelled_room.h"
#include "serve/export_file.h"
#include "train/opened_run.h"
#include "train/rendered_view.h"

namespace aligngs {
namespace {

constexpr int kLongestSide = 640;  // pixels of a rendering: a square of 2 cm at 4 m is 2 pixels of it

ScaleSource scale_source_of(const Scene& scene) {
  if (!scene.metric) return ScaleSource::kUnknown;
  if (scene.units_estimate) return ScaleSource::kNetwork;
  if (is_sensor_depth(scene.prior_source)) return ScaleSource::kSensor;
  return scene.prior_source == "exact" ? ScaleSource::kTruth : ScaleSource::kNetwork;
}

/// `trained`: the number of a training view in their order.
PlaneView look(LoadedRun& run, size_t trained) {
  Camera camera = run.working_camera(run.scene().train[trained]);
  const double shrink = std::min(1.0, static_cast<double>(kLongestSide) / std::max(camera.width, camera.height));
  camera = camera.resized(std::max(1, static_cast<int>(std::lround(camera.width * shrink))),
                          std::max(1, static_cast<int>(std::lround(camera.height * shrink))));
  if (trained < run.looks.size() && shrink == 1) return run.looks[trained];
  // As for the mesh, with the near plane of training.
  RenderOptions options = run.render_options();
  options.raster.near_plane = run.near_planes()[trained];
  return plane_view_of(camera, run.engine->render(camera, options));
}

}  // namespace

MeasuredRoom describe_room(LoadedRun& run, std::vector<ObjectPoints> objects) {
  RoomInputs inputs;
  for (size_t i = 0; i < run.scene().train.size(); ++i) inputs.views.push_back(look(run, i));
  inputs.labels = &run.scene().labels;
  inputs.up = run.scene().up;
  inputs.objects = std::move(objects);
  if (run.scene().metric) inputs.metres_per_unit = 1;
  inputs.scale_source = scale_source_of(run.scene());
  if (run.has_labels()) return find_room(inputs, {}, *run.pool);
  inputs.up = up_of_room(run.scene(), {});
  return find_unlabelled_room(inputs, {}, *run.pool);
}

MeasuredRoom read_run_room(const std::filesystem::path& run) {
  require_run_folder(run);
  if (!std::filesystem::exists(run / "room.json")) refuse_missing_room(run);
  return read_room(run / "room.json");
}

MeasuredRoom with_scale_of_scene(const MeasuredRoom& room, const std::filesystem::path& run) {
  if (room.scale_source != ScaleSource::kGiven)
    throw_usage("the scale of this run was not given by hand", "there is nothing to take back");
  const OpenedRun opened = open_run(run, {});
  MeasuredRoom out = rescaled(room, 1 / room.to_room.scale);
  out.metric = opened.scene.metric;
  out.scale_source = scale_source_of(opened.scene);
  return out;
}

MeasuredRoom room_run(LoadedRun& run) {
  std::vector<ObjectPoints> objects;
  if (run.has_labels()) {
    EditSession session(run.opened, {{}, run.pool->size()});
    objects = furniture_points(session.room(), session.pool());
  }
  MeasuredRoom room = describe_room(run, std::move(objects));
  const std::filesystem::path file = run.folder() / "room.json";
  if (std::filesystem::exists(file)) {
    const MeasuredRoom before = read_room(file);
    if (before.scale_source == ScaleSource::kGiven) {
      const double factor = before.to_room.scale / room.to_room.scale;
      room = rescaled(std::move(room), factor);
      room.metric = true;
      room.scale_source = ScaleSource::kGiven;
    }
  }
  write_room(file, room);
  for (const std::string& warning : room.warnings) log_warning("room: {}", warning);
  return room;
}

std::string room_summary(const MeasuredRoom& room) {
  const char* unit = room.metric ? "m" : "scene units";
  const char* square = room.metric ? "m²" : "square scene units";
  std::string lengths;
  for (const MeasuredWall& wall : room.walls)
    lengths += fmt::format("{}{:.2f}{}", lengths.empty() ? "" : ", ", wall.length(), wall.assumed ? " (assumed)" : "");
  std::string text =
      fmt::format("ceiling      {:.2f} {}{}\nfloor area   {:.2f} {}\nperimeter    {:.2f} {}\nwalls        {} {}\n",
                  room.height, unit, room.floor_assumed || room.ceiling_assumed ? " (assumed)" : "", room.area(),
                  square, room.perimeter(), unit, lengths, unit);
  if (room.lowest < room.height) text += fmt::format("lowest       {:.2f} {}\n", room.lowest, unit);
  for (size_t i = 0; i < room.openings.size(); ++i) {
    const MeasuredOpening& o = room.openings[i];
    text += fmt::format("{:<12} {:.2f} x {:.2f} {} at {:.2f} on {}\n", opening_name(room, i), o.right - o.left,
                        o.top - o.bottom, unit, o.bottom, wall_name(static_cast<size_t>(o.wall)));
  }
  text += fmt::format("furniture    {} boxes\nscale        {}\n", room.boxes.size(), name_of(room.scale_source));
  return text;
}

}  // namespace aligngs
