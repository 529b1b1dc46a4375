// Sofas, armchairs, chairs, stools.
#include <cmath>

#include "core/angles.h"
#include "synth/furniture.h"

namespace aligngs {
namespace {

void four_legs(MeshBuilder& b, double x, double y0, double y1, double height, double side) {
  for (const double sx : {-x, x - side}) {
    for (const double y : {y0, y1 - side}) b.box({sx, y, 0}, {sx + side, y + side, height});
  }
}

}  // namespace

void add_sofa(MeshBuilder& b, const RoomStyle& s, double width) {
  Random& r = b.random();
  const double w = width / 2, depth = r.uniform(0.86, 0.95), arm = 0.17, seat = 0.43, back = r.uniform(0.78, 0.88);
  const int seats = width > 1.9 ? 3 : 2;
  b.occupy({-w, 0, 0}, {w, depth, 0.6});
  const Material cloth = another(s.upholstery, r);
  b.begin("sofa");
  b.use(s.second_wood);
  four_legs(b, w - 0.05, 0.06, depth - 0.04, 0.09, 0.05);
  b.use(cloth);
  b.rounded_box({{-w + 0.02, 0.03, 0.08}, {w - 0.02, depth - 0.02, 0.29}, 0.03, 0, 0});
  b.rounded_box({{-w + 0.03, 0.02, 0.1}, {w - 0.03, 0.22, back - 0.06}, 0.05, 0, 0});
  for (const double x : {-w, w - arm}) b.rounded_box({{x, 0.02, 0.085}, {x + arm, depth, 0.62}, 0.06, 0.015, 0.004});
  const double inner = width - 2 * arm, each = inner / seats;
  for (int i = 0; i < seats; ++i) {
    const double x = -w + arm + i * each;
    b.use(another(cloth, r));
    b.rounded_box({{x + 0.004, 0.18, 0.27}, {x + each - 0.004, depth + 0.01, seat}, 0.05, 0.03, 0.004});
    b.nested(tilt({x + each / 2, 0.33, 0.42}, 100, 0), [&] {
      b.rounded_box({{-each / 2 + 0.006, 0, -0.085}, {each / 2 - 0.006, back - 0.36, 0.085}, 0.06, 0.03, 0.006});
    });
  }
  const int cushions = 2 + r.below(2);
  for (int i = 0; i < cushions; ++i) {
    b.begin("cushion");
    b.use(another(i == 0 ? s.cushion_a : (i == 1 ? s.cushion_b : s.cushion_c), r));
    const double x = i == 0 ? -w + arm + 0.24 : (i == 1 ? w - arm - 0.24 : r.uniform(-0.2, 0.1));
    const double lean = r.uniform(62, 70), roll = r.uniform(-8, 8);
    b.nested(tilt({x, 0.49, seat + 0.21}, -lean, roll), [&] { b.pillow({}, 0.21, 0.21, 0.075); });
  }
  if (r.chance(0.5)) {  // a throw over one arm
    b.begin("blanket");
    b.use(another(s.throw_cloth, r));
    const double x = r.chance(0.5) ? -w : w - arm;
    b.rounded_box({{x - 0.02, 0.3, 0.3}, {x + arm + 0.02, 0.66, 0.655}, 0.07, 0.015, 0.01});
  }
}

void add_armchair(MeshBuilder& b, const RoomStyle& s) {
  Random& r = b.random();
  const double w = 0.39, depth = 0.8, arm = 0.13;
  b.occupy({-w, 0, 0}, {w, depth, 0.6});
  b.begin("armchair");
  b.use(s.second_wood);
  four_legs(b, w - 0.04, 0.06, depth - 0.03, 0.13, 0.045);
  const Material cloth = another(s.second_upholstery, r);
  b.use(cloth);
  b.rounded_box({{-w + 0.02, 0.04, 0.12}, {w - 0.02, depth - 0.02, 0.3}, 0.04, 0, 0});
  for (const double x : {-w, w - arm})
    b.rounded_box({{x, 0.05, 0.125}, {x + arm, depth - 0.01, 0.58}, 0.055, 0.012, 0.004});
  b.nested(tilt({0, 0.28, 0.3}, 98, 0), [&] {
    b.rounded_box({{-w + 0.05, 0, -0.02}, {w - 0.05, 0.62, 0.15}, 0.07, 0.02, 0.004});
  });
  b.use(another(cloth, r));
  b.rounded_box({{-w + arm + 0.004, 0.14, 0.28}, {w - arm - 0.004, depth + 0.005, 0.44}, 0.05, 0.03, 0.004});
  b.begin("cushion");
  b.use(another(s.cushion_c, r));
  const double x = r.uniform(-0.03, 0.03), roll = r.uniform(-6, 6);
  b.nested(tilt({x, 0.38, 0.63}, -72, roll), [&] { b.pillow({}, 0.2, 0.18, 0.065); });
}

void add_chair(MeshBuilder& b, const RoomStyle& s) {
  Random& r = b.random();
  const double w = 0.21, depth = 0.44, seat = 0.45;
  b.occupy({-w, 0, 0}, {w, depth, 0.9});
  b.begin("chair");
  const Material wood = another(s.second_wood, r);
  b.use(wood);
  b.box({-w, 0.0, seat - 0.03}, {w, depth, seat});
  four_legs(b, w, 0.0, depth, seat - 0.03, 0.036);
  for (const double x : {-w, w - 0.036}) b.box({x, 0, seat}, {x + 0.036, 0.03, 0.9});
  const bool slats = r.chance(0.5);
  if (slats) {
    for (const double z : {0.58, 0.69, 0.8}) b.box({-w + 0.036, 0.004, z}, {w - 0.036, 0.024, z + 0.06});
  } else {
    b.box({-w + 0.036, 0.004, 0.82}, {w - 0.036, 0.026, 0.9});
    for (double x = -w + 0.08; x < w - 0.06; x += 0.075) b.box({x, 0.008, seat}, {x + 0.018, 0.022, 0.82});
  }
  for (const double x : {-w + 0.005, w - 0.03}) b.box({x, 0.036, 0.2}, {x + 0.024, depth - 0.036, 0.226});
  b.use(another(s.cushion_c, r));
  b.rounded_box({{-w + 0.02, 0.04, seat}, {w - 0.02, depth - 0.015, seat + 0.045}, 0.02, 0.008, 0});
}

void add_swivel_chair(MeshBuilder& b, const RoomStyle& s) {
  Random& r = b.random();
  const double cy = 0.28, seat = 0.47;
  b.occupy({-0.29, 0, 0}, {0.29, 0.58, 0.98});
  b.begin("swivel chair");
  b.use(s.dark_metal);
  for (int i = 0; i < 5; ++i) {
    const double a = 2 * kPi * i / 5 + 0.3;
    const Vec3d tip{0.27 * std::cos(a), cy + 0.27 * std::sin(a), 0.065};
    b.bar({0, cy, 0.095}, tip, 0.018);
    b.use(s.black_plastic);
    b.bar({tip.x - 0.02, tip.y, 0.03}, {tip.x + 0.02, tip.y, 0.03}, 0.03);
    b.use(s.dark_metal);
  }
  b.cylinder({0, cy, 0.08}, 0.026, seat - 0.13);
  b.use(another(s.upholstery, r));
  b.rounded_box({{-0.25, cy - 0.24, seat - 0.07}, {0.25, cy + 0.27, seat + 0.02}, 0.04, 0.012, 0});
  b.nested(tilt({0, 0.07, 0.56}, 95, 0), [&] {
    b.rounded_box({{-0.23, 0, -0.035}, {0.23, 0.46, 0.035}, 0.03, 0.015, 0});
  });
  b.use(s.black_plastic);
  b.box({-0.03, 0.005, 0.44}, {0.03, 0.03, 0.75});
  for (const double x : {-0.29, 0.24}) {
    b.box({x, cy - 0.1, 0.66}, {x + 0.05, cy + 0.14, 0.69});
    b.box({x + 0.01, cy, 0.44}, {x + 0.04, cy + 0.05, 0.66});
  }
}

void add_stool(MeshBuilder& b, const RoomStyle& s) {
  Random& r = b.random();
  b.occupy({-0.18, 0, 0}, {0.18, 0.36, 0.46});
  b.begin("stool");
  b.use(another(s.wood, r));
  b.turned({0, 0.18, 0.42}, {{0, 0}, {0.17, 0}, {0.175, 0.02}, {0.165, 0.04}, {0, 0.04}}, false);
  for (int i = 0; i < 4; ++i) {
    const double a = kPi / 4 + kPi / 2 * i;
    b.bar({0.16 * std::cos(a), 0.18 + 0.16 * std::sin(a), 0}, {0.1 * std::cos(a), 0.18 + 0.1 * std::sin(a), 0.42},
          0.016);
  }
}

void add_ottoman(MeshBuilder& b, const RoomStyle& s) {
  Random& r = b.random();
  b.occupy({-0.3, 0, 0}, {0.3, 0.5, 0.42});
  b.begin("ottoman");
  b.use(s.second_wood);
  four_legs(b, 0.26, 0.05, 0.45, 0.1, 0.04);
  b.use(another(s.cushion_b, r));
  b.rounded_box({{-0.3, 0, 0.1}, {0.3, 0.5, 0.4}, 0.06, 0.02, 0.004});
}

}  // namespace aligngs
