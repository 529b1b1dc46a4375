#include <algorithm>

#include "synth/room_builders.h"

namespace aligngs {

void furnish_kitchen(RoomSite& site) {
  MeshBuilder& b = site.builder;
  const RoomStyle& s = site.style;
  Random& r = site.random;
  RoomPlan& plan = site.plan;
  plan.width = r.uniform(4.2, 5.0);
  plan.depth = r.uniform(3.8, 4.5);
  plan.height = r.uniform(2.5, 2.7);
  plan.walls[0].feature = true;
  // A window above the sink, one on a side wall, the door opposite the run.
  const double sink_s = plan.width * r.uniform(0.36, 0.44);
  const WallOpening over_sink = window_opening(sink_s, 1.0, 1.18, 2.15, false);
  plan.walls[0].openings.push_back(over_sink);
  const int window_wall = r.chance(0.5) ? 1 : 3, other_wall = 4 - window_wall;
  const WallOpening window =
      window_opening(plan.depth * 0.5 + (window_wall == 1 ? 0.3 : -0.3), r.uniform(1.2, 1.5), 0.9, 2.2, true);
  plan.walls[window_wall].openings.push_back(window);
  const double door_s = window_wall == 1 ? 0.8 : plan.width - 0.8;
  plan.walls[2].openings.push_back(door_opening(door_s));

  // The wall behind the run is tiled: small glazed tiles in place of wallpaper.
  RoomStyle tiled = s;
  tiled.feature_wall.kind = TextureKind::kTiles;
  tiled.feature_wall.scale = static_cast<float>(r.uniform(0.4, 0.6));
  tiled.feature_wall.a = s.feature_wall.a * 0.5f + Vec3f{0.35f, 0.35f, 0.33f};
  tiled.feature_wall.b = s.feature_wall.a * 0.6f + Vec3f{0.15f, 0.15f, 0.15f};
  tiled.feature_wall.c = {0.5f, 0.5f, 0.48f};
  tiled.feature_wall.gloss = 0.4f;
  build_shell(b, tiled, plan);
  dress_window(site, window_wall, window, true, true);

  site.at_wall(
      0, plan.width / 2,
      [&] { add_kitchen_run(b, s, plan.width - 0.04, over_sink.s0 - plan.width / 2, over_sink.s1 - plan.width / 2); },
      0.0);

  const double table_w = r.uniform(1.3, 1.55), table_d = r.uniform(0.8, 0.9);
  const Vec3d centre{plan.width / 2 + r.uniform(-0.15, 0.15), 0.6 + (plan.depth - 0.6) * 0.52, 0};
  site.at({centre.x, centre.y, 0}, 0, [&] { add_rug(b, s, table_w + 1.1, table_d + 0.9); });
  site.at({centre.x, centre.y - table_d / 2, 0.012}, 0, [&] { add_table(b, s, table_w, table_d); });
  // Chairs face the table; their backs are away from it.
  for (const double side : {-1.0, 1.0}) {
    const double x = centre.x + side * table_w * 0.24;
    const double near_y = r.uniform(0.2, 0.3), near_turn = r.uniform(-8, 8);
    site.at({x, centre.y - table_d / 2 - near_y, 0.012}, near_turn, [&] { add_chair(b, s); });
    const double far_y = r.uniform(0.2, 0.3), far_turn = r.uniform(-8, 8);
    site.at({x, centre.y + table_d / 2 + far_y, 0.012}, 180 + far_turn, [&] { add_chair(b, s); });
  }
  site.at({centre.x, centre.y, 0}, 0, [&] { add_pendant(b, s, plan.height, 1.65, 1.0); });
  site.at({plan.width / 2, 0.6 + 0.5, 0}, 0, [&] { add_ceiling_light(b, s, plan.height, 0.8); });

  const double free_s = window_wall == 1 ? plan.width - 0.85 : 0.85;
  site.at_wall(
      2, free_s,
      [&] {
        add_cabinet(b, s, r.uniform(1.1, 1.35), 0.92);
        add_painting(b, s, 0.7, 0.5, 1.6);
        b.nested(placement({-0.3, 0.2, 0}, 0), [&] { add_vase(b, s, 0.92); });
        b.nested(placement({0.3, 0.2, 0}, 0), [&] { add_table_lamp(b, s, 0.92, 0.7); });
      },
      0.016);
  const double wall_s = other_wall == 1 ? plan.depth * 0.62 : plan.depth * 0.38;
  site.at_wall(other_wall, wall_s, [&] {
    add_clock(b, s, 1.9);
    if (r.chance(0.6)) b.nested(placement({0.75, 0, 0}, 0), [&] { add_painting(b, s, 0.4, 0.55, 1.55); });
  });
  scatter_along_walls(b, s, plan,
                      {{0.5, 0.5, [](MeshBuilder& m, const RoomStyle& t) { add_plant(m, t, 1.0); }},
                       {0.32, 0.32, add_waste_bin},
                       {0.38, 0.38, add_stool}},
                      3);
}

}  // namespace aligngs
