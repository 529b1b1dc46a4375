// A floor plan as lines and texts on layers, before any file format.
#pragma once

#include <string>
#include <vector>

#include "room/measured_room.h"

namespace aligngs {

enum class PlanLayer { kWalls, kOpenings, kFurniture, kDimensions, kText };
inline constexpr PlanLayer kPlanLayers[] = {PlanLayer::kWalls, PlanLayer::kOpenings, PlanLayer::kFurniture,
                                            PlanLayer::kDimensions, PlanLayer::kText};

/// "WALLS", "OPENINGS", "FURNITURE", "DIMENSIONS", "TEXT".
const char* name_of(PlanLayer layer);

/// Places in millimetres of the room, x to the right and y upwards.
struct PlanPath {
  PlanLayer layer = PlanLayer::kWalls;
  std::vector<Vec2d> points;
  bool closed = false;
  bool dashed = false;  ///< assumed, or above the floor
};

enum class PlanAnchor { kLeft, kMiddle };

struct PlanText {
  PlanLayer layer = PlanLayer::kText;
  Vec2d place;        ///< on the base line
  std::string text;   ///< UTF-8
  double height = 0;  ///< millimetres of the room
  double turn = 0;    ///< degrees
  PlanAnchor anchor = PlanAnchor::kMiddle;
};

struct PlanDrawing {
  Vec2d low, high;  ///< box of everything, with a margin
  std::vector<PlanPath> paths;
  std::vector<PlanText> texts;
};

struct PlanSettings {
  double scale = 50;        ///< 1 mm on paper is so many in the room
  double text = 2.2;        ///< mm on paper, height of letters: the smallest that is read at arm's length
  double margin = 8;        ///< mm on paper around the drawing
  double chain = 7;         ///< mm on paper from a wall to its chain of dimensions, and to the next
  double least_name = 300;  ///< mm: furniture smaller than this on its longest side has no name
};

/// Walls, openings, furniture by class with its name, dimension chains, area and a scale bar. Error{kBadInput} for a
/// room whose scale is not known.
PlanDrawing draw_plan(const MeasuredRoom& room, const PlanSettings& settings = {});

}  // namespace aligngs
