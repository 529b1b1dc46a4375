// The four kinds of furnished rooms.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "synth/room_model.h"

namespace aligngs {

struct RoomOptions {
  std::string kind = "bedroom";  ///< bedroom, living, kitchen or office
  uint64_t seed = 1;
  bool glossy = true;         ///< polished floor and table tops
  bool strong_gloss = false;  ///< gloss.h: also dark tables, a mirror, and windows that one looks through
};

/// Names that RoomOptions::kind may take.
const std::vector<std::string>& room_kinds();

/// A room in its own frame: floor at z = 0, z up, a corner at the origin; metres. The same options give the same
/// room. Throws Error{kUsage} for an unknown kind.
RoomModel build_room(const RoomOptions& options);

}  // namespace aligngs
