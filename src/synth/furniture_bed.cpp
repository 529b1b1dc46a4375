// Beds and the furniture beside them.
#include "synth/furniture.h"

namespace aligngs {

void add_bed(MeshBuilder& b, const RoomStyle& s, double width, double length) {
  Random& r = b.random();
  const double w = width / 2, y0 = 0.09, top = 0.5;
  const bool upholstered = r.chance(0.5);
  const double head = r.uniform(0.95, 1.2);
  b.occupy({-w - 0.03, 0, 0}, {w + 0.03, length + 0.04, 0.62});

  b.begin("bed");
  if (upholstered) {
    b.use(another(s.second_upholstery, r));
    for (int i = 0; i < 3; ++i) {
      const double x = -w + width * i / 3;
      b.rounded_box({{x + 0.003, 0.012, 0.25}, {x + width / 3 - 0.003, 0.095, head}, 0.035, 0, 0.004});
    }
  } else {
    b.use(another(s.wood, r));
    b.box({-w - 0.03, 0.02, 0}, {w + 0.03, 0.065, head});
    b.box({-w - 0.05, 0.01, head}, {w + 0.05, 0.085, head + 0.045});
  }
  b.use(another(s.wood, r));
  b.box({-w - 0.03, y0, 0.16}, {-w, length + 0.03, 0.34});
  b.box({w, y0, 0.16}, {w + 0.03, length + 0.03, 0.34});
  b.box({-w, length, 0.16}, {w, length + 0.03, 0.36});
  for (const double x : {-w - 0.02, w - 0.05}) {
    for (const double y : {y0 + 0.06, length - 0.06}) b.box({x, y, 0}, {x + 0.07, y + 0.07, 0.17});
  }
  b.use(s.linen);
  b.rounded_box({{-w + 0.008, y0 + 0.01, 0.24}, {w - 0.008, length - 0.008, top}, 0.06, 0.012, 0});
  // The duvet hangs over both sides and the foot; its turned-down border lies on top.
  const double fold = 0.62;
  b.use(another(s.bed_cloth, r));
  b.rounded_box({{-w - 0.055, y0 + fold, 0.29}, {w + 0.055, length + 0.06, top + 0.075}, 0.07, 0.02, 0.022});
  b.use(another(s.linen, r));
  b.rounded_box(
      {{-w - 0.05, y0 + fold - 0.1, top - 0.1}, {w + 0.05, y0 + fold + 0.22, top + 0.098}, 0.055, 0.01, 0.012});

  if (r.chance(0.7)) {  // a throw across the foot
    b.begin("blanket");
    b.use(another(s.throw_cloth, r));
    const double y = length - r.uniform(0.62, 0.75);
    b.rounded_box({{-w - 0.085, y, 0.3}, {w + 0.085, y + 0.5, top + 0.122}, 0.06, 0.012, 0.012});
  }
  for (const double x : {-w / 2, w / 2}) {
    b.begin("pillow");
    b.use(another(s.linen, r));
    const double shift = r.uniform(-0.03, 0.03), lean = r.uniform(24, 32), roll = r.uniform(-3, 3);
    b.nested(tilt({x + shift, y0 + 0.27, top + 0.14}, -lean, roll), [&] { b.pillow({}, 0.33, 0.23, 0.085); });
  }
  const int cushions = 1 + r.below(2);
  for (int i = 0; i < cushions; ++i) {
    b.begin("cushion");
    b.use(another(i == 0 ? s.cushion_a : s.cushion_b, r));
    const double x = cushions == 1 ? r.uniform(-0.15, 0.15) : (i == 0 ? -0.26 : 0.26) * (w / 0.8);
    const double lean = r.uniform(48, 58), roll = r.uniform(-5, 5);
    b.nested(tilt({x, y0 + 0.5, top + 0.24}, -lean, roll), [&] { b.pillow({}, 0.21, 0.21, 0.07); });
  }
}

void add_nightstand(MeshBuilder& b, const RoomStyle& s, double width) {
  Random& r = b.random();
  const double w = width / 2, depth = 0.38, height = r.uniform(0.46, 0.54);
  b.occupy({-w, 0, 0}, {w, depth, height});
  b.begin("cabinet");
  b.use(another(s.wood, r));
  b.box({-w, 0.01, 0.1}, {w, depth, height - 0.025});
  b.box({-w - 0.012, 0.005, height - 0.025}, {w + 0.012, depth + 0.015, height});
  for (const double x : {-w + 0.01, w - 0.045}) {
    for (const double y : {0.02, depth - 0.05}) b.box({x, y, 0}, {x + 0.035, y + 0.035, 0.1});
  }
  b.use(another(s.second_wood, r));
  const double middle = 0.1 + (height - 0.125) / 2;
  b.box({-w + 0.02, depth, 0.12}, {w - 0.02, depth + 0.014, middle - 0.006});
  b.box({-w + 0.02, depth, middle + 0.006}, {w - 0.02, depth + 0.014, height - 0.045});
  b.use(s.metal);
  for (const double z : {(0.12 + middle) / 2, (middle + height - 0.045) / 2}) {
    b.bar({-0.045, depth + 0.03, z}, {0.045, depth + 0.03, z}, 0.006);
    for (const double x : {-0.04, 0.04}) b.bar({x, depth + 0.014, z}, {x, depth + 0.03, z}, 0.004);
  }
  b.nested(placement({0, 0.17, 0}, 0), [&] { add_table_lamp(b, s, height, 1.0); });
  if (r.chance(0.7)) {
    b.begin("book");
    double z = height;
    for (int i = 0; i < 2; ++i) {
      b.use(book_material(r));
      const double x = r.uniform(-0.02, 0.02), turn = r.uniform(-15, 15);
      b.nested(placement({x, 0.29, z}, turn), [&] { b.box({-0.09, -0.06, 0}, {0.09, 0.06, 0.024}); });
      z += 0.024;
    }
  }
}

}  // namespace aligngs
