// Boxes of things of which photos show a part alone: the front of a wardrobe, the shade of a floor lamp.
#pragma once

#include <string>
#include <vector>

#include "room/measured_room.h"
#include "room/seen_rays.h"

namespace aligngs {

struct UnseenPartsSettings {
  double most_depth = 0.75;  ///< metres from a wall to the front of a case: wardrobes and kitchens have 0.6
  double beside = 0.8;       ///< share of a case's length that is before the wall
  double least_gap = 0.10;   ///< metres behind a front: a smaller gap is room for a skirting board
  double most_free = 0.2;    ///< share of the space behind a front that photos may look through
  double cell = 0.10;        ///< metres: cubes of that space
  double to_floor = 0.15;    ///< metres from the floor within which a surface below is the floor
  double least_foot = 0.05;  ///< share of the pixels below a lamp that show its foot, in the middle half of the height
  size_t least_rays = 20;    ///< pixels below a lamp that show what it is on
};

/// Cases (cabinets, wardrobes, shelves, large kitchen appliances) of which photos show the front reach back to the wall
/// behind it. The front runs along the wall, and the space between both is seen by no photo. `rays` and boxes are in
/// the room's frame, in metres. Without rays nothing changes.
void reach_walls(std::vector<MeasuredBox>& boxes, const std::vector<MeasuredWall>& walls,
                 const std::vector<SeenRay>& rays, const UnseenPartsSettings& settings = {});

/// False for furniture and lamps: something below carries them even where they touch a wall.
bool can_hang_on_wall(const std::string& class_name);

/// Things with the support "unknown" reach down. Furniture with feet reaches the floor. A lamp reaches the lowest
/// surface that photos show below it, if they show its foot as well. Supports are not changed.
void reach_down(std::vector<MeasuredBox>& boxes, const std::vector<SeenRay>& rays,
                const UnseenPartsSettings& settings = {});

}  // namespace aligngs
