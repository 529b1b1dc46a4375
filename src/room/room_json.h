// room.json: the description of a room for other programs. docs/room.md has its fields.
#pragma once

#include <filesystem>
#include <string>

#include "room/measured_room.h"

namespace aligngs {

/// Raised when a field changes its meaning or goes; new fields do not raise it.
inline constexpr int kRoomSchema = 1;

/// The whole file, with a line break at its end.
std::string room_json(const MeasuredRoom& room);

/// Writes room.json, whole or not at all.
void write_room(const std::filesystem::path& file, const MeasuredRoom& room);

/// Writes a room that has another scale than before; the factor on all lengths. The same scale again leaves the file,
/// whose last digits rounding would change.
double write_scale(const std::filesystem::path& file, const MeasuredRoom& before, const MeasuredRoom& after);

/// Reads what write_room() wrote. Error{kBadInput} for a file that is none, is of a later schema, or holds walls that
/// are not closed and numbers that are not finite.
MeasuredRoom read_room(const std::filesystem::path& file);

}  // namespace aligngs
