#include "synth/layout.h"

#include <algorithm>

namespace aligngs {
namespace {

constexpr double kReveal = 0.16;     // depth of a window niche, metres
constexpr double kPane = 0.11;       // how far behind the wall the glass lies
constexpr double kDoorFrame = 0.07;  // width of a door's frame; the upper one is above the opening

/// The wall's surface around its windows, as rectangles that share the texture coordinates (s, z).
void wall_surface(MeshBuilder& b, const RoomPlan& plan, int wall) {
  const double length = plan.wall_length(wall);
  const WallPlan& w = plan.walls[wall];
  std::vector<double> cuts = {0, length};
  for (const WallOpening& o : w.openings) {
    if (!o.is_door) cuts.insert(cuts.end(), {o.s0, o.s1});
  }
  std::sort(cuts.begin(), cuts.end());
  for (size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double s0 = cuts[i], s1 = cuts[i + 1];
    if (s1 - s0 < 1e-6) continue;
    double below = plan.height;  // lower edge of the opening in this column, or the ceiling
    double above = plan.height;
    for (const WallOpening& o : w.openings) {
      if (!o.is_door && o.s0 <= s0 + 1e-6 && o.s1 >= s1 - 1e-6) below = o.z0, above = o.z1;
    }
    // Facing +y of the wall frame: u runs towards -x. Texture coordinates still follow s.
    const auto patch = [&](double z0, double z1) {
      if (z1 - z0 < 1e-6) return;
      b.rectangle({s1, 0, z0}, {s0 - s1, 0, 0}, {0, 0, z1 - z0}, false, {length - s1, z0});
    };
    patch(0, below);
    patch(above, plan.height);
  }
}

/// The four sides of a window's niche; part of the wall.
void niche(MeshBuilder& b, const RoomStyle& s, const WallOpening& o) {
  const double w = o.s1 - o.s0, h = o.z1 - o.z0;
  b.use(s.bare_paint);
  b.rectangle({o.s0, -kReveal, o.z0}, {0, kReveal, 0}, {0, 0, h});
  b.rectangle({o.s1, 0, o.z0}, {0, -kReveal, 0}, {0, 0, h});
  b.rectangle({o.s0, 0, o.z1}, {0, -kReveal, 0}, {w, 0, 0});
  b.rectangle({o.s1, 0, o.z0}, {0, -kReveal, 0}, {-w, 0, 0});
}

void window(MeshBuilder& b, const RoomStyle& s, const WallOpening& o) {
  Random& r = b.random();
  const double w = o.s1 - o.s0, h = o.z1 - o.z0;
  b.begin("windowpane");
  b.use(s.skirting);
  b.box({o.s0, -0.06, o.z0 - 0.02}, {o.s1, 0, o.z0 + 0.018});  // sill, its nose wider than the niche
  b.box({o.s0 - 0.04, 0, o.z0 - 0.02}, {o.s1 + 0.04, 0.06, o.z0 + 0.018});
  const double rim = 0.05, y0 = -kPane, y1 = -kPane + 0.045;
  b.box({o.s0, y0, o.z0}, {o.s0 + rim, y1, o.z1});
  b.box({o.s1 - rim, y0, o.z0}, {o.s1, y1, o.z1});
  b.box({o.s0 + rim, y0, o.z0}, {o.s1 - rim, y1, o.z0 + rim});
  b.box({o.s0 + rim, y0, o.z1 - rim}, {o.s1 - rim, y1, o.z1});
  const double middle = (o.s0 + o.s1) / 2, bar = 0.03;
  b.box({middle - bar, y0, o.z0 + rim}, {middle + bar, y1 + 0.004, o.z1 - rim});
  Material view = picture_material(TextureKind::kOutside, r);
  view.emission = o.overexposed ? 2.5f : 0.22f;
  view.unreliable_depth = true;
  b.use(view);
  b.rectangle({o.s1, y0 + 0.012, o.z0}, {-w, 0, 0}, {0, 0, h}, true);

  AreaLight light;
  light.origin = b.frame() * Vec3d{o.s0 + rim, y1 + 0.02, o.z0 + rim};
  light.edge_u = b.frame().rotation * Vec3d{w - 2 * rim, 0, 0};
  light.edge_v = b.frame().rotation * Vec3d{0, 0, h - 2 * rim};
  light.normal = b.frame().rotation * Vec3d{0, 1, 0};
  light.radiance = Vec3f{0.86f, 0.94f, 1.0f} * (o.overexposed ? 8.5f : 5.5f);
  light.columns = 7;
  light.rows = 5;
  b.room().lights.push_back(light);
}

void door(MeshBuilder& b, const RoomStyle& s, const WallOpening& o) {
  Random& r = b.random();
  const double frame = kDoorFrame, leaf = 0.022;
  b.begin("door");
  const Material wood = another(r.chance(0.5) ? s.second_wood : s.lacquer, r);
  b.use(wood);
  b.box({o.s0, 0, 0}, {o.s0 + frame, 0.035, o.z1});
  b.box({o.s1 - frame, 0, 0}, {o.s1, 0.035, o.z1});
  b.box({o.s0, 0, o.z1}, {o.s1, 0.035, o.z1 + frame});
  b.use(another(wood, r));
  b.box({o.s0 + frame + 0.004, 0, 0.006}, {o.s1 - frame - 0.004, leaf, o.z1 - 0.004});
  b.use(another(s.second_wood, r));
  const double x0 = o.s0 + frame + 0.12, x1 = o.s1 - frame - 0.12;
  b.box({x0, leaf, 0.2}, {x1, leaf + 0.008, 0.9});
  b.box({x0, leaf, 1.08}, {x1, leaf + 0.008, o.z1 - 0.16});
  b.use(s.metal);
  const double hx = o.s1 - frame - 0.07;
  b.bar({hx, leaf, 1.03}, {hx, leaf + 0.05, 1.03}, 0.011);
  b.bar({hx + 0.01, leaf + 0.048, 1.03}, {hx - 0.11, leaf + 0.048, 1.03}, 0.01);
  b.box({hx - 0.02, leaf, 0.9}, {hx + 0.02, leaf + 0.004, 1.1});
}

}  // namespace

Rigidd wall_frame(const RoomPlan& plan, int wall, double s, double gap) {
  switch (wall) {
    case 0:
      return placement({s, gap, 0}, 0);
    case 1:
      return placement({plan.width - gap, s, 0}, 90);
    case 2:
      return placement({plan.width - s, plan.depth - gap, 0}, 180);
    default:
      return placement({gap, plan.depth - s, 0}, 270);
  }
}

void build_shell(MeshBuilder& b, const RoomStyle& s, const RoomPlan& plan) {
  b.room().width = plan.width;
  b.room().depth = plan.depth;
  b.room().height = plan.height;
  b.set_frame({});
  b.begin("floor");
  b.use(s.floor);
  b.rectangle({0, 0, 0}, {plan.width, 0, 0}, {0, plan.depth, 0});
  b.begin("ceiling");
  b.use(s.bare_paint);
  b.rectangle({0, plan.depth, plan.height}, {plan.width, 0, 0}, {0, -plan.depth, 0});
  for (int wall = 0; wall < 4; ++wall) {
    b.set_frame(wall_frame(plan, wall, 0));
    b.begin("wall");
    b.use(plan.walls[wall].feature ? s.feature_wall : s.bare_paint);
    wall_surface(b, plan, wall);
    b.use(s.skirting);
    double from = 0;  // skirting board between the doors
    for (const WallOpening& o : plan.walls[wall].openings) {
      if (!o.is_door) continue;
      b.box({from, 0, 0}, {o.s0, 0.014, 0.08});
      from = o.s1;
    }
    b.box({from, 0, 0}, {plan.wall_length(wall), 0.014, 0.08});
    for (const WallOpening& o : plan.walls[wall].openings) {
      if (!o.is_door) niche(b, s, o);
    }
    for (const WallOpening& o : plan.walls[wall].openings) {
      b.room().openings.push_back({wall, o.s0, o.s1, o.z0, o.z1 + (o.is_door ? kDoorFrame : 0), o.is_door});
      if (o.is_door)
        door(b, s, o);
      else
        window(b, s, o);
    }
  }
  b.set_frame({});
}

bool is_free(const RoomModel& room, const FurnitureFootprint& f, double margin) {
  if (f.x0 < -1e-6 || f.y0 < -1e-6 || f.x1 > room.width + 1e-6 || f.y1 > room.depth + 1e-6) return false;
  for (const FurnitureFootprint& other : room.footprints) {
    if (other.bottom > 0.5 && other.bottom > f.top) continue;
    if (f.x0 < other.x1 + margin && f.x1 > other.x0 - margin && f.y0 < other.y1 + margin && f.y1 > other.y0 - margin) {
      return false;
    }
  }
  return true;
}

void scatter_along_walls(MeshBuilder& b, const RoomStyle& s, const RoomPlan& plan,
                         const std::vector<LoosePiece>& pieces, int count) {
  Random& r = b.random();
  for (int i = 0; i < count; ++i) {
    const LoosePiece& piece = pieces[static_cast<size_t>(i) % pieces.size()];
    for (int attempt = 0; attempt < 60; ++attempt) {
      const int wall = r.below(4);
      const double half = piece.width / 2 + 0.04, length = plan.wall_length(wall);
      // Corners first, then anywhere.
      const double at = attempt < 24 ? (r.chance(0.5) ? half : length - half) : r.uniform(half, length - half);
      bool at_door = false;
      for (const WallOpening& o : plan.walls[wall].openings) {
        at_door = at_door || (o.is_door && at + half > o.s0 - 0.05 && at - half < o.s1 + 0.05);
      }
      // The neighbouring wall's door needs room as well.
      for (const int other : {(wall + 1) % 4, (wall + 3) % 4}) {
        for (const WallOpening& o : plan.walls[other].openings) {
          if (!o.is_door) continue;
          const bool near_end = other == (wall + 1) % 4 ? length - at < half + 0.3 : at < half + 0.3;
          const double reach = other == (wall + 1) % 4 ? o.s0 : plan.wall_length(other) - o.s1;
          at_door = at_door || (near_end && reach < piece.depth + 0.15);
        }
      }
      if (at_door) continue;
      const Rigidd frame = wall_frame(plan, wall, at, 0.04);
      const Vec3d a = frame * Vec3d{-piece.width / 2, 0, 0}, c = frame * Vec3d{piece.width / 2, piece.depth, 0};
      const FurnitureFootprint f{
          std::min(a.x, c.x), std::min(a.y, c.y), std::max(a.x, c.x), std::max(a.y, c.y), 1.2, 0};
      if (!is_free(b.room(), f, 0.05)) continue;
      b.set_frame(frame);
      piece.add(b, s);
      b.set_frame({});
      break;
    }
  }
}

}  // namespace aligngs
