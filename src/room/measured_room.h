// A room as data: planes of walls, floor and ceiling, openings, furniture boxes and the measures that follow from them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rigid.h"

namespace aligngs {

/// Lengths are in metres where the scale is known, else in scene units. Places are in the room's own frame: z up, the
/// floor at z = 0, the longest wall along x. No corner has a negative x or y.
enum class ScaleSource {
  kUnknown,  ///< the scene has no unit: lengths are scene units
  kNetwork,  ///< a network's estimate of metres
  kSensor,   ///< a depth camera's
  kGiven,    ///< a length that the user gave
  kTruth     ///< of a synthetic room
};

/// How walls, floor and ceiling were told from everything else.
enum class RoomEvidence {
  kLabels,   ///< by classes of the photos
  kGeometry  ///< by their planes alone: nothing is measured behind them
};

/// One straight piece of the outline. Seen from above the outline runs counter-clockwise, so that the room is on the
/// left.
struct MeasuredWall {
  Vec2d from, to;         ///< corners
  Vec3d normal;           ///< unit, into the room, level
  double height = 0;      ///< of the ceiling above it, the mean of both corners
  double seen = 0;        ///< share of its rectangle that photos show, in [0, 1]
  double confidence = 0;  ///< in [0, 1]: share of the votes on it that agree; 0 for an assumed wall
  bool assumed = false;   ///< no photo shows it: it closes the room where the seen surfaces end
  double length() const;
  double along(const Vec2d& p) const;   ///< from the first corner, in the direction of the second
  double before(const Vec2d& p) const;  ///< distance into the room; below 0 behind the wall
  /// The place at `along` from the first corner, at height z.
  Vec3d at(double along, double z) const;
};

enum class OpeningKind { kDoor, kWindow, kPicture, kMirror };

/// An upright rectangle on a wall. A door includes its frame, a window is the hole in the wall.
struct MeasuredOpening {
  OpeningKind kind = OpeningKind::kDoor;
  std::string class_name;
  int wall = 0;                ///< index into walls
  double left = 0, right = 0;  ///< along the wall, from its first corner
  double bottom = 0, top = 0;  ///< heights above the floor; bottom is the sill
  double seen = 0;             ///< share of the rectangle with votes
  double confidence = 0;       ///< share of those votes that agree
};

/// The box of the points of a thing, without parts that no photo shows.
struct ShownBox {
  Vec2d centre;
  double width = 0, depth = 0, bottom = 0, top = 0, turn = 0;  ///< as of MeasuredBox
};

/// An upright box of a piece of furniture.
struct MeasuredBox {
  std::string class_name;
  int instance = 0;  ///< number within its class, from 1
  Vec2d centre;
  double width = 0, depth = 0;         ///< along the box's own x and y
  double bottom = 0, top = 0;          ///< heights above the floor
  double turn = 0;                     ///< degrees from the room's x to the box's x, in [0, 180)
  std::string support;                 ///< "floor", "wall", "ceiling", the name of another box, or "unknown"
  double seen = 0;                     ///< share of the four sides and the top that has points near it
  double confidence = 0;               ///< mean probability of the class
  std::optional<ShownBox> shown = {};  ///< absent in files of earlier programs
};

/// A piece of the ceiling: normal . x + offset = 0 in the room's frame, the normal downwards.
struct CeilingPlane {
  Vec3d normal;
  double offset = 0;
  double height_at(const Vec2d& p) const;  ///< above the floor; not finite for an upright plane
};

struct MeasuredRoom {
  bool metric = false;  ///< lengths are metres
  ScaleSource scale_source = ScaleSource::kUnknown;
  RoomEvidence found_by = RoomEvidence::kLabels;
  Similarity to_room;               ///< from the scene's world to this frame
  std::vector<MeasuredWall> walls;  ///< closed: each begins where the one before ends
  std::vector<MeasuredOpening> openings;
  std::vector<MeasuredBox> boxes;
  std::vector<CeilingPlane> ceiling;        ///< empty: the ceiling is assumed level
  double height = 0;                        ///< of the highest place of the ceiling above the floor
  double lowest = 0;                        ///< and of its lowest place; equal for a level ceiling
  double floor_seen = 0, ceiling_seen = 0;  ///< share of the outline's area that photos show
  bool floor_assumed = false, ceiling_assumed = false;
  std::vector<std::string> warnings;  ///< sentences: what could not be found

  double area() const;  ///< of the floor inside the outline
  double perimeter() const;
  /// Height of the ceiling above a place of the floor.
  double height_at(const Vec2d& p) const;
};

/// Name of the n-th wall, opening or box, as room.json and plans have it: "wall.1", "door.2", "sofa.1".
std::string wall_name(size_t index);
std::string opening_name(const MeasuredRoom& room, size_t index);
std::string box_name(const MeasuredBox& box);

/// Whether a place of the plan is within a closed outline.
bool is_inside(const std::vector<MeasuredWall>& walls, const Vec2d& p);

/// Whether a place of the plan is on a box seen from above.
bool is_within(const MeasuredBox& box, const Vec2d& p);

/// The four corners of a box seen from above, counter-clockwise.
std::vector<Vec2d> footprint(const MeasuredBox& box);

/// All lengths multiplied by `factor` > 0, and to_room with them.
MeasuredRoom rescaled(MeasuredRoom room, double factor);

/// Area within a closed polygon, positive when counter-clockwise.
double signed_area(const std::vector<Vec2d>& polygon);

const char* name_of(OpeningKind kind);       ///< "door", "window", "picture", "mirror"
const char* name_of(ScaleSource source);     ///< "unknown", "network estimate", "sensor", "given", "truth"
const char* name_of(RoomEvidence found_by);  ///< "labels", "geometry"

}  // namespace aligngs
