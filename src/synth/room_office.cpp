#include <algorithm>

#include "synth/room_builders.h"

namespace aligngs {

void furnish_office(RoomSite& site) {
  MeshBuilder& b = site.builder;
  const RoomStyle& s = site.style;
  Random& r = site.random;
  RoomPlan& plan = site.plan;
  plan.width = r.uniform(4.2, 5.2);
  plan.depth = r.uniform(3.7, 4.6);
  plan.height = r.uniform(2.5, 2.75);
  const int window_wall = r.chance(0.5) ? 1 : 3, case_wall = 4 - window_wall;
  plan.walls[case_wall].feature = true;
  const WallOpening window = window_opening(plan.depth / 2, r.uniform(1.5, 1.9), 0.9, 2.2, true);
  plan.walls[window_wall].openings.push_back(window);
  const double door_s = window_wall == 1 ? plan.width - 0.8 : 0.8;
  plan.walls[2].openings.push_back(door_opening(door_s));
  build_shell(b, s, plan);
  dress_window(site, window_wall, window, r.chance(0.6), true);

  // Two desks along wall 0.
  const double desk = std::min(1.6, (plan.width - 0.5) / 2);
  for (const double side : {-1.0, 1.0}) {
    const double x = plan.width / 2 + side * (desk / 2 + 0.12);
    site.at_wall(
        0, x, [&] { add_desk(b, s, desk, true); }, 0.018);
    // The chair's back is away from the desk; it is pulled out and turned a little.
    const double chair_x = x + r.uniform(-0.12, 0.05), chair_y = 1.25 + r.uniform(0.0, 0.2), turn = r.uniform(-30, 30);
    site.at({chair_x, chair_y, 0}, 180 + turn, [&] { add_swivel_chair(b, s); });
  }
  site.at_wall(0, plan.width / 2 - desk / 2, [&] { add_bulletin_board(b, s, 1.0, 0.7, 1.62); });
  site.at_wall(0, plan.width / 2 + desk / 2, [&] { add_wall_shelf(b, s, 1.0, 1.5); });

  // Bookcases on the feature wall, a cabinet and pictures on wall 2.
  const double case_width = r.uniform(0.85, 1.0);
  const int cases = plan.depth > 4.4 ? 2 : 1;
  for (int i = 0; i < cases + 1; ++i) {
    const double from_far = 0.1 + case_width / 2 + i * (case_width + 0.02);
    const double s_case = case_wall == 1 ? plan.depth - from_far : from_far;
    site.at_wall(
        case_wall, s_case, [&] { add_bookcase(b, s, case_width, i == cases ? 1.25 : 2.0); }, 0.018);
  }
  const double cabinet = r.uniform(1.0, 1.25);
  const double cabinet_s = window_wall == 1 ? 0.12 + cabinet / 2 + 0.35 : plan.width - 0.47 - cabinet / 2;
  site.at_wall(
      2, cabinet_s,
      [&] {
        add_cabinet(b, s, cabinet, 0.95);
        add_painting(b, s, r.uniform(0.8, 1.0), 0.6, 1.65);
        b.nested(placement({-0.3, 0.22, 0}, 0), [&] { add_vase(b, s, 0.95); });
        add_books(b, 0.0, 0.35, 0.95, 0.3, 0.3);
      },
      0.016);
  const double mid = plan.width / 2 + (window_wall == 1 ? 0.35 : -0.35);
  site.at_wall(2, plan.width - mid, [&] { add_clock(b, s, 2.0); });
  const double rug_width = r.uniform(1.9, 2.3), rug_depth = r.uniform(1.3, 1.5);
  site.at({plan.width / 2, plan.depth * 0.62, 0}, 0, [&] { add_rug(b, s, rug_width, rug_depth); });
  site.at({plan.width / 2, plan.depth / 2, 0}, 0, [&] { add_ceiling_light(b, s, plan.height, 1.2); });
  scatter_along_walls(b, s, plan,
                      {{0.5, 0.5, [](MeshBuilder& m, const RoomStyle& t) { add_plant(m, t, 1.2); }},
                       {0.8, 0.82, add_armchair},
                       {0.32, 0.32, add_waste_bin},
                       {0.44, 0.42,
                        [](MeshBuilder& m, const RoomStyle& t) {
                          m.occupy({-0.2, 0, 0}, {0.2, 0.34, 0.4});
                          add_box_pile(m, t);
                        }}},
                      4);
}

}  // namespace aligngs
