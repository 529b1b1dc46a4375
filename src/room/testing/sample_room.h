// A small room with one of everything, for tests.
#pragma once

#include "room/measured_room.h"

namespace aligngs::sample_room {

/// 4 m x 3 m x 2.5 m with a door, a window, a picture, a sofa on the floor and a lamp on it. The wall at x = 0 is
/// assumed.
inline MeasuredRoom make() {
  MeasuredRoom room;
  room.metric = true;
  room.scale_source = ScaleSource::kNetwork;
  room.to_room = {1, Mat3d{{1, 0, 0, 0, 0, 1, 0, -1, 0}}, {0.5, 0.25, 1.25}};
  const Vec2d corners[4] = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
  const Vec3d normals[4] = {{0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 0, 0}};
  for (size_t i = 0; i < 4; ++i)
    room.walls.push_back({corners[i], corners[(i + 1) % 4], normals[i], 2.5, 0.9, 0.8, false});
  room.walls[3].assumed = true;
  room.walls[3].seen = room.walls[3].confidence = 0;
  room.openings = {{OpeningKind::kDoor, "door", 0, 0.5, 1.4, 0, 2.0, 1, 0.9},
                   {OpeningKind::kWindow, "windowpane", 1, 1, 2.2, 0.9, 2.1, 1, 0.9},
                   {OpeningKind::kPicture, "painting", 2, 1, 1.5, 1.4, 1.8, 1, 0.9}};
  room.boxes = {{"sofa", 1, {2, 2.4}, 2, 0.9, 0, 0.8, 0, "floor", 0.6, 0.95},
                {"lamp", 1, {2.5, 2.5}, 0.2, 0.2, 0.8, 1.2, 30, "sofa.1", 0.7, 0.8}};
  room.ceiling = {{{0, 0, -1}, 2.5}};
  room.height = room.lowest = 2.5;
  room.floor_seen = 0.7;
  room.ceiling_seen = 0.9;
  return room;
}

}  // namespace aligngs::sample_room
