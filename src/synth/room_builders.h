// Shared parts of the four room builders (internal to src/synth).
#pragma once

#include "synth/furniture.h"
#include "synth/layout.h"

namespace aligngs {

/// Everything one builder works on.
struct RoomSite {
  MeshBuilder& builder;
  const RoomStyle& style;
  RoomPlan plan;
  Random& random;

  /// Runs `add` in the frame of a wall at distance s along it.
  template <class Add>
  void at_wall(int wall, double s, const Add& add, double gap = 0.0) {
    builder.set_frame(wall_frame(plan, wall, s, gap));
    add();
    builder.set_frame({});
  }
  template <class Add>
  void at(const Vec3d& origin, double degrees, const Add& add) {
    builder.set_frame(placement(origin, degrees));
    add();
    builder.set_frame({});
  }
};

void furnish_bedroom(RoomSite& site);
void furnish_living(RoomSite& site);
void furnish_kitchen(RoomSite& site);
void furnish_office(RoomSite& site);

/// Window opening centred at s.
WallOpening window_opening(double s, double width, double sill, double top, bool overexposed);
WallOpening door_opening(double s);

/// Curtains, and a radiator when there is room below the sill.
void dress_window(RoomSite& site, int wall, const WallOpening& opening, bool curtains, bool radiator);

}  // namespace aligngs
