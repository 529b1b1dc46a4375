#include <algorithm>

#include "synth/room_builders.h"

namespace aligngs {

void furnish_living(RoomSite& site) {
  MeshBuilder& b = site.builder;
  const RoomStyle& s = site.style;
  Random& r = site.random;
  RoomPlan& plan = site.plan;
  plan.width = r.uniform(4.8, 5.8);
  plan.depth = r.uniform(4.2, 5.0);
  plan.height = r.uniform(2.6, 2.8);
  const int window_wall = r.chance(0.5) ? 1 : 3, other_wall = 4 - window_wall;
  plan.walls[2].feature = true;
  const double middle = plan.depth / 2 + r.uniform(-0.2, 0.2);
  const WallOpening window = window_opening(middle, r.uniform(1.8, 2.3), 0.8, 2.3, true);
  plan.walls[window_wall].openings.push_back(window);
  // The door is on the other side wall, at the end near the television.
  const double door_s = other_wall == 1 ? plan.depth - 0.75 : 0.75;
  plan.walls[other_wall].openings.push_back(door_opening(door_s));
  build_shell(b, s, plan);
  dress_window(site, window_wall, window, true, r.chance(0.5));

  const double sofa = r.uniform(1.95, 2.3), sofa_x = plan.width / 2 + r.uniform(-0.2, 0.2);
  site.at_wall(
      0, sofa_x, [&] { add_sofa(b, s, sofa); }, 0.05);
  site.at_wall(0, sofa_x, [&] {
    if (r.chance(0.5)) {
      const double w = r.uniform(1.2, 1.5), h = r.uniform(0.6, 0.75);
      add_painting(b, s, w, h, 1.6);
    } else {
      for (const double x : {-0.65, 0.0, 0.65}) {
        b.nested(placement({x, 0, 0}, 0), [&] { add_painting(b, s, 0.5, 0.62, 1.6); });
      }
    }
  });
  const double lamp_side = window_wall == 1 ? -1 : 1;  // away from the window
  site.at_wall(
      0, sofa_x + lamp_side * (sofa / 2 + 0.3), [&] { add_floor_lamp(b, s, 1.2); }, 0.05);

  const double table_y = 1.45 + r.uniform(0, 0.15);
  site.at({sofa_x, table_y, 0.012}, 0, [&] { add_coffee_table(b, s, r.uniform(1.0, 1.2), 0.6); });
  site.at({sofa_x, table_y + 0.3, 0}, 0, [&] { add_rug(b, s, r.uniform(2.4, 2.8), 1.9); });

  const double stand = r.uniform(1.5, 1.8);
  site.at_wall(
      2, plan.width - sofa_x, [&] { add_tv_stand(b, s, stand); }, 0.02);
  site.at_wall(2, plan.width - sofa_x, [&] { add_wall_shelf(b, s, 1.1, 1.85); });

  // Bookcase beside the television on the window's side, armchairs turned to the table.
  const double case_width = r.uniform(0.8, 1.0);
  const double case_s = window_wall == 1 ? case_width / 2 + 0.08 : plan.width - case_width / 2 - 0.08;
  site.at_wall(
      2, case_s, [&] { add_bookcase(b, s, case_width, r.uniform(1.8, 2.1)); }, 0.02);
  const double chair_x = sofa_x + (window_wall == 1 ? 1 : -1) * 1.5;
  const double turn = window_wall == 1 ? 90 + r.uniform(10, 25) : -90 - r.uniform(10, 25);
  const Vec3d chair{std::clamp(chair_x, 0.75, plan.width - 0.75), table_y + 0.55, 0.012};
  site.at({chair.x + (window_wall == 1 ? 0.35 : -0.35), chair.y, 0.012}, turn, [&] { add_armchair(b, s); });

  site.at_wall(
      other_wall, other_wall == 1 ? 1.3 : plan.depth - 1.3,
      [&] {
        if (r.chance(0.5)) {
          add_cabinet(b, s, 1.0, 0.85);
          add_painting(b, s, 0.7, 0.5, 1.55);
          b.nested(placement({0.2, 0.2, 0}, 0), [&] { add_vase(b, s, 0.85); });
        } else {
          add_bookcase(b, s, 1.0, 1.3);
          add_painting(b, s, 0.6, 0.45, 1.85);
        }
      },
      0.018);
  site.at({plan.width / 2, plan.depth / 2, 0}, 0, [&] { add_ceiling_light(b, s, plan.height, 1.3); });
  scatter_along_walls(b, s, plan,
                      {{0.6, 0.6, [](MeshBuilder& m, const RoomStyle& t) { add_plant(m, t, 1.4); }},
                       {0.64, 0.52, add_ottoman},
                       {0.44, 0.42, add_basket},
                       {0.5, 0.5, [](MeshBuilder& m, const RoomStyle& t) { add_plant(m, t, 0.9); }}},
                      4);
}

}  // namespace aligngs
