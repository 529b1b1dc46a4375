// The description of a run's room: room.json.
#pragma once

#include <string>

#include "cli/stages/loaded_run.h"
#include "edit/apply_edit.h"
#include "room/find_room.h"

namespace aligngs {

/// Describes the room of a run as its training views show it after training, with `objects` as its furniture. A run
/// without labels has walls, floor and ceiling alone. Errors as find_room's and find_unlabelled_room's.
MeasuredRoom describe_room(LoadedRun& run, std::vector<ObjectPoints> objects);

/// RUN/room.json. Error{kBadInput} for a folder that is no run or has no room.json.
MeasuredRoom read_run_room(const std::filesystem::path& run);

/// The room with the scale of the run's own scene, without what the user gave. Error{kUsage} where none was given.
MeasuredRoom with_scale_of_scene(const MeasuredRoom& room, const std::filesystem::path& run);

/// describe_room() of a run with its edits, written to RUN/room.json. A scale that the user gave before (`aligngs
/// scale`) stays.
MeasuredRoom room_run(LoadedRun& run);

/// The measures in lines of text, for people.
std::string room_summary(const MeasuredRoom& room);

}  // namespace aligngs
