// The labels that the photos show on each wall, square by square.
#pragma once

#include <array>
#include <vector>

#include "room/measured_room.h"
#include "room/room_classes.h"
#include "room/seen_rays.h"

namespace aligngs {

struct WallVoteSettings {
  double cell = 0.02;     ///< metres, side of a square: two pixels of a photo 320 wide at 2.5 m
  double on_wall = 0.12;  ///< metres from the wall within which a surface is on it
  double proud = 0.25;    ///< for doors, whose leaves are open a little, and pictures
  double beyond = 0.06;   ///< metres: what lies farther behind the wall is seen through it
};

/// Votes on the squares of one wall's rectangle, row-major from its first corner on the floor.
struct WallVotes {
  double cell = 1;
  int columns = 0, rows = 0;
  std::array<std::vector<float>, 4> kinds;  ///< per OpeningKind
  std::array<std::vector<float>, 4> depth;  ///< metres behind the wall, summed over the votes of each kind
  std::vector<float> wall;                  ///< the wall itself, and what is on it without being an opening
  std::vector<float> beyond;                ///< seen through it
  std::vector<int> labels;                  ///< per opening vote the last class, -1 without
  size_t index(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
  }
  float total(size_t i) const { return kinds[0][i] + kinds[1][i] + kinds[2][i] + kinds[3][i] + wall[i] + beyond[i]; }
};

/// A ray votes on the first wall that it meets from inside, unless something hides that wall. Rectangles of more than a
/// few million squares have none.
std::vector<WallVotes> wall_votes(const std::vector<MeasuredWall>& walls, const std::vector<SeenRay>& rays,
                                  const std::vector<RoomClass>& classes, const WallVoteSettings& settings = {});

/// Share of a wall's squares with votes; closed over gaps of one square, as distant pixels are wider apart.
double seen_share(const WallVotes& votes);

}  // namespace aligngs
