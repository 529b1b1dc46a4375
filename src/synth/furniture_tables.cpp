// Tables and desks with what lies on them.
#include "synth/furniture.h"

namespace aligngs {
namespace {

void plate(MeshBuilder& b, const RoomStyle& s, double x, double y, double z) {
  b.begin("plate");
  b.use(another(s.white_plastic, b.random()));
  b.turned({x, y, z}, {{0, 0}, {0.07, 0}, {0.125, 0.016}, {0.125, 0.021}, {0.07, 0.007}, {0, 0.007}}, false);
}

void glass(MeshBuilder& b, const RoomStyle& s, double x, double y, double z) {
  b.begin("glass");
  b.use(s.ceramic);
  b.turned({x, y, z}, {{0, 0}, {0.03, 0}, {0.038, 0.1}, {0.033, 0.1}, {0.027, 0.01}, {0, 0.01}}, false);
}

}  // namespace

void add_table(MeshBuilder& b, const RoomStyle& s, double width, double depth) {
  Random& r = b.random();
  const double w = width / 2, top = 0.74;
  b.occupy({-w, 0, 0}, {w, depth, top});
  b.begin("table");
  b.use(another(s.wood, r));
  b.box({-w, 0, top - 0.035}, {w, depth, top});
  for (const double x : {-w + 0.04, w - 0.1}) {
    for (const double y : {0.04, depth - 0.1}) b.box({x, y, 0}, {x + 0.06, y + 0.06, top - 0.035});
  }
  for (const double y : {0.06, depth - 0.085}) b.box({-w + 0.1, y, top - 0.12}, {w - 0.1, y + 0.025, top - 0.035});
  for (const double x : {-w + 0.06, w - 0.085}) b.box({x, 0.1, top - 0.12}, {x + 0.025, depth - 0.1, top - 0.035});
  plate(b, s, -w * 0.5, depth * 0.27, top);
  plate(b, s, w * 0.5, depth * 0.73, top);
  glass(b, s, -w * 0.22, depth * 0.3, top);
  glass(b, s, w * 0.25, depth * 0.64, top);
  b.nested(placement({r.uniform(-0.08, 0.08), depth / 2, 0}, 0), [&] { add_vase(b, s, top); });
}

void add_coffee_table(MeshBuilder& b, const RoomStyle& s, double width, double depth) {
  Random& r = b.random();
  const double w = width / 2, top = 0.42;
  b.occupy({-w, 0, 0}, {w, depth, top});
  b.begin("coffee table");
  b.use(another(s.wood, r));
  b.box({-w, 0, top - 0.04}, {w, depth, top});
  b.box({-w + 0.06, 0.06, 0.14}, {w - 0.06, depth - 0.06, 0.16});
  for (const double x : {-w + 0.02, w - 0.075}) {
    for (const double y : {0.02, depth - 0.075}) b.box({x, y, 0}, {x + 0.055, y + 0.055, top - 0.04});
  }
  b.begin("book");
  double z = top;
  for (int i = 0; i < 3; ++i) {
    b.use(book_material(r));
    const double t = r.uniform(0.018, 0.03);
    b.nested(placement({-w * 0.45, depth * 0.5, z}, r.uniform(-20, 20)), [&] {
      b.box({-0.14, -0.1, 0}, {0.14, 0.1, t});
    });
    z += t;
  }
  b.nested(placement({w * 0.4, depth * 0.5, 0}, 0), [&] { add_vase(b, s, top); });
  b.begin("book");
  b.use(book_material(r));
  b.nested(placement({0.02, depth * 0.35, 0.16}, 12), [&] { b.box({-0.15, -0.11, 0}, {0.15, 0.11, 0.03}); });
}

void add_desk(MeshBuilder& b, const RoomStyle& s, double width, bool computer) {
  Random& r = b.random();
  const double w = width / 2, depth = r.uniform(0.62, 0.72), top = 0.74;
  b.occupy({-w, 0, 0}, {w, depth, top});
  b.begin("desk");
  b.use(another(s.wood, r));
  b.box({-w, 0.01, top - 0.03}, {w, depth, top});
  const double side = r.chance(0.5) ? 1 : -1;
  const double d0 = side > 0 ? w - 0.42 : -w + 0.02;  // drawers at one end, legs at the other
  b.box({d0, 0.03, 0.08}, {d0 + 0.4, depth - 0.05, top - 0.03});
  b.use(s.dark_metal);
  for (const double y : {0.05, depth - 0.09})
    b.box({-side * (w - 0.03) - 0.02, y, 0}, {-side * (w - 0.03) + 0.02, y + 0.04, top - 0.03});
  b.box({d0 + 0.02, 0.06, 0}, {d0 + 0.38, depth - 0.09, 0.08});
  b.use(another(s.second_wood, r));
  for (int i = 0; i < 3; ++i) {
    const double z = 0.1 + i * 0.2;
    b.box({d0 + 0.012, depth - 0.05, z}, {d0 + 0.388, depth - 0.034, z + 0.19});
  }
  b.use(s.metal);
  for (int i = 0; i < 3; ++i)
    b.bar({d0 + 0.14, depth - 0.022, 0.22 + i * 0.2}, {d0 + 0.26, depth - 0.022, 0.22 + i * 0.2}, 0.007);
  if (computer) {
    const double x = -side * 0.12;
    b.begin("monitor");
    b.use(s.black_plastic);
    b.rounded_box({{x - 0.12, 0.14, top}, {x + 0.12, 0.32, top + 0.012}, 0.005, 0, 0});
    b.box({x - 0.025, 0.19, top + 0.012}, {x + 0.025, 0.21, top + 0.2});
    b.box({x - 0.29, 0.21, top + 0.1}, {x + 0.29, 0.245, top + 0.45});
    Material screen = picture_material(TextureKind::kScreen, r);
    screen.emission = 0.2f;
    screen.unreliable_depth = true;
    b.use(screen);
    b.rectangle({x + 0.277, 0.2463, top + 0.113}, {-0.554, 0, 0}, {0, 0, 0.324}, true);
    b.begin("computer");
    b.use(s.black_plastic);
    b.box({x - 0.21, 0.42, top}, {x + 0.21, 0.55, top + 0.016});
    b.use(picture_material(TextureKind::kKeys, r));
    b.rectangle({x - 0.207, 0.423, top + 0.0168}, {0.414, 0, 0}, {0, 0.124, 0}, true);
    b.use(s.black_plastic);
    b.rounded_box({{x - side * 0.3 - 0.03, 0.44, top}, {x - side * 0.3 + 0.03, 0.54, top + 0.03}, 0.013, 0.004, 0});
  } else {
    b.begin("book");
    b.use(book_material(r));
    b.nested(placement({0, depth * 0.6, top}, r.uniform(-15, 15)), [&] { b.box({-0.13, -0.1, 0}, {0.13, 0.1, 0.02}); });
  }
  b.nested(placement({side * (w - 0.2), 0.2, 0}, 0), [&] { add_table_lamp(b, s, top, 0.8); });
  add_books(b, -side * (w - 0.04) - (side > 0 ? 0 : 0.24), -side * (w - 0.04) + (side > 0 ? 0.24 : 0), top, 0.24, 0.26);
}

}  // namespace aligngs
