#include <algorithm>

#include "synth/room_builders.h"

namespace aligngs {

void furnish_bedroom(RoomSite& site) {
  MeshBuilder& b = site.builder;
  const RoomStyle& s = site.style;
  Random& r = site.random;
  RoomPlan& plan = site.plan;
  plan.width = r.uniform(4.1, 4.9);
  plan.depth = r.uniform(3.7, 4.4);
  plan.height = r.uniform(2.5, 2.7);
  const double bed_width = r.uniform(1.45, 1.7), bed_length = r.uniform(1.98, 2.1), stand = 0.44;
  // The window is on one side wall, the wardrobe on the other; the bed leans to the window.
  const int window_wall = r.chance(0.5) ? 1 : 3, closet_wall = 4 - window_wall;
  const double lean = r.uniform(0.0, 0.2) * (window_wall == 1 ? 1 : -1);
  const double bed = plan.width / 2 + lean;

  plan.walls[0].feature = true;
  const double middle = plan.wall_length(window_wall) / 2 + r.uniform(-0.2, 0.2);
  const WallOpening window = window_opening(middle, r.uniform(1.3, 1.7), 0.88, 2.2, true);
  plan.walls[window_wall].openings.push_back(window);
  // Wall 2 is seen from the bed: the door is at its end near the window wall (s grows towards x = 0).
  const double door_s = window_wall == 1 ? 0.75 : plan.width - 0.75;
  plan.walls[2].openings.push_back(door_opening(door_s));
  build_shell(b, s, plan);
  dress_window(site, window_wall, window, true, true);

  site.at_wall(
      0, bed, [&] { add_bed(b, s, bed_width, bed_length); }, 0.01);
  for (const double side : {-1.0, 1.0}) {
    site.at_wall(
        0, bed + side * (bed_width / 2 + 0.09 + stand / 2), [&] { add_nightstand(b, s, stand); }, 0.01);
  }
  const double picture = r.uniform(0.9, 1.3), picture_height = r.uniform(0.5, 0.65);
  site.at_wall(0, bed, [&] { add_painting(b, s, picture, picture_height, 1.72); });

  // Wardrobe at the far end of its wall. Wall 1 runs from the bed's wall away from it, wall 3 towards it.
  const double wardrobe = r.uniform(1.2, 1.6), along = plan.depth - wardrobe / 2 - 0.06;
  site.at_wall(
      closet_wall, closet_wall == 1 ? along : plan.depth - along, [&] { add_wardrobe(b, s, wardrobe); }, 0.01);

  // Opposite the bed: chest of drawers with a picture above it.
  const double chest = r.uniform(0.9, 1.2);
  const double free_end = 0.62 + chest / 2 + r.uniform(0.1, 0.25);
  const double chest_s = window_wall == 1 ? plan.width - free_end : free_end;
  site.at_wall(
      2, chest_s, [&] { add_chest_of_drawers(b, s, chest); }, 0.016);
  const double chest_top = b.room().footprints.back().top;
  site.at_wall(2, chest_s, [&] {
    const double w = r.uniform(0.6, 0.8), h = r.uniform(0.45, 0.6);
    add_painting(b, s, w, h, 1.6);
    b.nested(placement({-0.25 * chest, 0.22, 0}, 0), [&] { add_vase(b, s, chest_top); });
    add_books(b, 0.1 * chest, 0.42 * chest, chest_top, 0.3, 0.28);
  });

  // A shelf or a picture on the free part of the wardrobe's wall.
  const double free_s = closet_wall == 1 ? 0.95 : plan.depth - 0.95;
  site.at_wall(closet_wall, free_s, [&] {
    if (r.chance(0.5))
      add_painting(b, s, 0.45, 0.6, 1.55);
    else
      add_wall_shelf(b, s, 0.8, 1.4);
  });
  site.at({plan.width / 2, plan.depth / 2, 0}, 0, [&] { add_ceiling_light(b, s, plan.height, 1.0); });
  const double rug_width = bed_width + r.uniform(0.7, 1.0), rug_depth = r.uniform(1.3, 1.6);
  site.at({bed, bed_length - 0.1, 0}, 0, [&] { add_rug(b, s, rug_width, rug_depth); });
  scatter_along_walls(b, s, plan,
                      {{0.8, 0.82, add_armchair},
                       {0.5, 0.5, [](MeshBuilder& m, const RoomStyle& t) { add_plant(m, t, 1.1); }},
                       {0.44, 0.42, add_basket},
                       {0.38, 0.38, add_stool}},
                      4);
}

}  // namespace aligngs
