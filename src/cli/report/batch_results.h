// The rooms of a batch as one table: CSV, JSON, and a page that opens offline.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "batch/batch_status.h"

namespace aligngs {

/// A header line and a line per room, in the order of the list. Figures have full precision and are empty where there
/// are none.
std::string batch_csv(const BatchFolder& folder, const std::vector<RoomStatus>& rooms);

/// {"folder", "rooms": [{"room", "state", "run", "attempts", "exit_status", "message", "path", "field", "remedy",
/// "retry", "figures": {...}}]}
nlohmann::ordered_json batch_json(const BatchFolder& folder, const std::vector<RoomStatus>& rooms);
void write_batch_json(const std::filesystem::path& file, const BatchFolder& folder,
                      const std::vector<RoomStatus>& rooms);

/// Failures first with the commands that try again, then figures, then a view of each room.
std::string batch_page(const BatchFolder& folder, const std::vector<RoomStatus>& rooms);

}  // namespace aligngs
