// Furniture as upright boxes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "room/measured_room.h"
#include "room/unseen_parts.h"

namespace aligngs {

/// Surface points of one object.
struct ObjectPoints {
  std::string class_name;
  int instance = 0;
  std::vector<Vec3d> points;
  double confidence = 0;  ///< mean probability of the class
};

struct FurnitureSettings {
  double tail = 0.01;         ///< share of the points on each side that a box leaves out: strays
  double square_gain = 0.10;  ///< a box turned against the walls must fit better by this share
  /// metres from a side of a box within which a point is on it: thickness of a trained surface
  double near_side = 0.02;
  double to_floor = 0.15;    ///< metres from the floor within which a box is on it: shadow and rugs hide its foot
  double to_support = 0.12;  ///< metres within which another box or a wall supports a box
  /// metres that a box may reach into a wall and is cut back: trained surfaces near walls are thick
  double in_wall = 0.20;
  double through_wall = 0.03;  ///< metres that a turned box may reach through a wall
  double cell = 0.10;          ///< metres: squares of a box's faces that are counted as seen
  /// metres, of the longest side: smaller ones are mostly confusions of a teacher, and so are beds shorter than a metre
  double least_size = 0.25;
  size_t least_points = 30;
  UnseenPartsSettings unseen;
};

/// The largest connected part of each object, of cubes with side `link` metres. Points of a class elsewhere in the room
/// go to the nearest object, and do not belong to it. Then pieces of one bed or sofa, which blankets and cushions
/// divide, are made one object. They are pieces of a class in a row with gaps below `gap` metres. Other classes side by
/// side are things of their own. The first piece keeps its number; empty objects are left out.
std::vector<ObjectPoints> join_pieces(std::vector<ObjectPoints> objects, double link = 0.12, double gap = 0.2);

/// One box, turned so that the points lie close to its sides (closeness of Zhang et al. 2017, "Efficient L-shape
/// fitting"). Photos show two sides of a wardrobe in a corner, for which the smallest box is wrong. Points that are not
/// finite are ignored. Returns false, with nothing written, for too few points or too small a box.
bool fit_box(const ObjectPoints& object, const FurnitureSettings& settings, MeasuredBox& box);

/// The room around the furniture, in the frame of the objects and in metres.
struct FurnitureSurroundings {
  std::vector<MeasuredWall> walls;
  std::vector<SeenRay> rays;  ///< pixels of the photos: parts that they do not show are added by room/unseen_parts.h
  double height = 0;          ///< of the ceiling
};

/// Boxes of all objects in the order given, each with its support. They are cut back where they reach into walls, and
/// extended by parts that no photo shows.
std::vector<MeasuredBox> find_boxes(const std::vector<ObjectPoints>& objects, const FurnitureSurroundings& around,
                                    const FurnitureSettings& settings = {});

}  // namespace aligngs
