// Surfaces that mislead stereo and colour: polished floors and tables, screens, a mirror, windows that one looks through.
#pragma once

#include "synth/room_model.h"

namespace aligngs {

/// Look of the surfaces that add_gloss() changes. Reflectance is at a right angle, of a smooth dielectric
/// ((n - 1) / (n + 1))^2; roughness is the largest deviation of a reflected ray, radians.
struct GlossSettings {
  float floor_reflectance = 0.05f;  ///< polyurethane on wood, n = 1.57
  float floor_roughness = 0.02f;    ///< one degree: satin varnish blurs a window frame at two metres by 4 cm
  float table_reflectance = 0.06f;  ///< piano lacquer or a glass top, n = 1.65
  float table_roughness = 0.006f;
  float table_darkness = 0.4f;       ///< factor of the colour: on a dark ground the mirrored room is as bright as it
  float screen_reflectance = 0.04f;  ///< uncoated glass, n = 1.5
  float screen_roughness = 0.002f;
  float pane_reflectance = 0.08f;    ///< both faces of a pane of n = 1.5
  float mirror_reflectance = 0.92f;  ///< silvered glass
  float day = 0.3f;                  ///< brightness of the view outside
  int rays = 4;                      ///< reflected rays of a sample on rough surfaces
};

/// Changes materials, and turns the largest painting into a mirror (class and object). Geometry and lights stay.
/// RoomModel::strong_gloss is true afterwards. The same for the same room.
void add_gloss(RoomModel& room, const GlossSettings& settings = {});

}  // namespace aligngs
