// The scale of a run, set on its page from a length that the user knows.
#pragma once

#include <filesystem>
#include <functional>

#include "room/measured_room.h"
#include "serve/view_server.h"

namespace aligngs {

/// Adds POST /api/scale. {"from": [x, y, z], "to": [x, y, z], "metres": length} makes the distance of two places of the
/// scene so long, in RUN/room.json. {"reset": true} takes a given scale back, by `without_given`, which may throw Error.
/// The answer is {"factor": number on all lengths}. Error{kBadInput} that names the field for places that are no three
/// finite numbers, and for a length that is no number. Error{kUsage} without a room.json, and as scaled_to().
void serve_scale(const std::filesystem::path& run, std::function<MeasuredRoom(const MeasuredRoom&)> without_given,
                 ViewServerOptions& options);

}  // namespace aligngs
