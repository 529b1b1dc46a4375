// A furnished room as triangles with classes, instances, procedural materials and lights.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/rigid.h"
#include "core/vec.h"
#include "synth/textures.h"

namespace aligngs {

/// One object: what a person would name, count and carry away as a whole.
struct RoomObject {
  uint16_t label = 0;      ///< ADE20K class
  std::string class_name;  ///< its name in scene/label_set.h
};

/// A rectangle that shines to one side: origin + s * edge_u + t * edge_v, s, t in [0, 1].
struct AreaLight {
  Vec3d origin, edge_u, edge_v;
  Vec3d normal;               ///< unit, the side that shines
  Vec3f radiance;             ///< linear RGB, W / (m^2 sr) up to one common factor
  int columns = 1, rows = 1;  ///< sample points when it lights a surface
};

/// The floor area an object takes, for placing furniture and walking around it. Room frame, metres.
struct FurnitureFootprint {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  double top = 0;     ///< height of the object
  double bottom = 0;  ///< > 0 for something that hangs: the floor below is free
};

/// A window's hole in a wall, or a door with its frame. Walls are numbered as in synth/layout.h; lengths along the wall
/// and above the floor, metres.
struct RoomOpening {
  int wall = 0;
  double left = 0, right = 0, bottom = 0, top = 0;
  bool is_door = false;
};

/// Metres; the frame in which it is built has the floor at z = 0, z up and a corner at the origin.
/// Triangles wind counter-clockwise seen from outside an object, or from inside the room.
struct RoomModel {
  std::string name;                         ///< "bedroom", ...
  double width = 0, depth = 0, height = 0;  ///< x, y, z extent in metres
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< per vertex, unit
  std::vector<Vec2f> uvs;      ///< per vertex, texture coordinates in metres
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint16_t> triangle_object;    ///< index into objects
  std::vector<uint16_t> triangle_material;  ///< index into materials
  std::vector<RoomObject> objects;
  std::vector<Material> materials;
  std::vector<AreaLight> lights;
  std::vector<FurnitureFootprint> footprints;
  std::vector<RoomOpening> openings;
  bool strong_gloss = false;  ///< add_gloss() was here: pictures have maps of what is mirrored
  Rigidd room_to_world;       ///< identity until move_to_world

  /// Applies a rigid motion to geometry and lights, so that positions are world coordinates.
  void move_to_world(const Rigidd& motion);
  /// Drops vertices that no triangle uses (poles of turned shapes).
  void remove_unused_vertices();
  double triangle_area(size_t triangle) const;
  /// Share of the surface area whose material is near-white paint without any texture.
  double bare_area_share() const;
};

}  // namespace aligngs
