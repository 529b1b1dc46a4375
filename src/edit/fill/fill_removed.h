// Closes the holes that removed objects leave: the surfaces of the room behind and under them continue, and nothing
// else.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "edit/fill/surface_patch.h"
#include "scene/camera.h"
#include "scene/label_set.h"

namespace aligngs {

struct FillInput {
  const LabelledGaussians& room;
  const LabelSet& labels;
  const std::vector<uint8_t>& selected;  ///< rows that go
  std::optional<Vec3d> up;               ///< unit, world
  const std::vector<Camera>& cameras;    ///< of the photos; may be empty
  ThreadPool* pool = nullptr;            ///< may be null: the work is then done by the calling thread
};

/// Lengths are shares of the extent, which is about 3 m in a room.
struct FillSettings {
  double touch = 0.05;       ///< an object that comes this near to a plane touches it (15 cm)
  double behind = 0.3;       ///< a surface this far behind an object is looked at all over its shadow (90 cm)
  double tolerance = 0.010;  ///< distance from a plane within which a Gaussian lies on it (3 cm)
  double overhang = 0.12;    ///< the floor is in the shade of parts that are no higher above it (36 cm)
  double halo = 0.013;       ///< colours nearer to the removed object are not used: its shade and its blur (4 cm)
  double unsure = 0.15;      ///< this near to it, only colours that some photo shows are used (45 cm)
  double shade = 0.06;       ///< an object's shade reaches this far on a surface (18 cm)
  float shaded = 0.85f;      ///< brightness of a shade, relative to the dark colours of the surface farther off
  double beside = 0.02;      ///< debris is this near to the object (6 cm)
  double blur = 0.033;       ///< standard deviation of a Gaussian that no photo has bounded (10 cm)
  float unlike = 0.1f;       ///< sRGB distance (norm over 3 channels) of a colour that a surface does not have
  double gap = 0.1;          ///< edge of the largest gap in a fill that is closed, as a square (30 cm)
  double opening = 0.08;     ///< a window or door this near to a wall is an opening in it (25 cm)
  double cell_min = 0.005, cell_max = 0.012;  ///< edge of a cell (1.5 to 4 cm)
  double cube = 0.013;                        ///< edge of the cubes that tell what hides what (4 cm)
  float covered = 0.6f;                       ///< accumulated opacity of a place that has a surface
  float thin = 2;          ///< accumulated opacity below which the black behind the room shines through
  double plate = 0.5;      ///< share of the shown part of a furniture's rectangle that has a surface: legs are no plate
  float shadow = 0.2f;     ///< accumulated opacity of a place that the object covers
  double shade_gap = 0.1;  ///< an object this near to a surface shades it (30 cm)
  double shade_reach = 0.2;  ///< and at most this far around itself (60 cm)
  double light_cell = 0.04;  ///< edge of the squares whose mean colour tells the light on a surface (12 cm)
};

struct Filling {
  std::vector<SupportPatch> patches;
  /// Per row: 1 for Gaussians of walls, floor and ceiling that go with the object. It hid them from all photos, so that
  /// nobody knows their colour, or they are beside it and have its colour.
  std::vector<uint8_t> debris;
  /// Per row: 1 for Gaussians that `lighter` has again, without the shade of the object.
  std::vector<uint8_t> shaded;
  SupportPatch lighter;  ///< without a mesh
};

/// One patch per surface. Walls, floor and ceiling continue where the object touched them or hid them from most photos.
/// Rugs stay within their rectangle, and furniture that carried it within its own bounds.
Filling fill_removed(const FillInput& input, const FillSettings& settings = {});

}  // namespace aligngs
