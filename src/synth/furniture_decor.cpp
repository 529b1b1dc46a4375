// Lamps, plants, rugs, pictures, curtains and other small things.
#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "synth/furniture.h"
#include "synth/noise.h"

namespace aligngs {
namespace {

/// Light sources around a shade: four upright rectangles, and one to either end.
void shade_lights(MeshBuilder& b, const Vec3d& centre, double radius, double height, double brightness) {
  const Vec3f warm = Vec3f{1.0f, 0.86f, 0.66f} * static_cast<float>(brightness);
  const Rigidd& f = b.frame();
  const double r = radius * 1.12;  // just outside the shade, which would otherwise shadow its own light
  for (int i = 0; i < 4; ++i) {
    const double a = kPi / 2 * i;
    const Vec3d out{std::cos(a), std::sin(a), 0}, along{-std::sin(a), std::cos(a), 0};
    AreaLight light;
    light.origin = f * (centre + out * r - along * (radius * 0.6) - Vec3d{0, 0, height / 2});
    light.edge_u = f.rotation * (along * (1.2 * radius));
    light.edge_v = f.rotation * Vec3d{0, 0, height};
    light.normal = f.rotation * out;
    light.radiance = warm;
    light.columns = 1;
    b.room().lights.push_back(light);
  }
  for (const double side : {-1.0, 1.0}) {
    AreaLight light;
    light.origin = f * (centre + Vec3d{-radius * 0.5, -radius * 0.5, side * (height / 2 + 0.02)});
    light.edge_u = f.rotation * Vec3d{radius, 0, 0};
    light.edge_v = f.rotation * Vec3d{0, radius, 0};
    light.normal = f.rotation * Vec3d{0, 0, side};
    light.radiance = warm * 3.0f;  // the open ends show the bulb
    b.room().lights.push_back(light);
  }
}

}  // namespace

void add_table_lamp(MeshBuilder& b, const RoomStyle& s, double z, double brightness) {
  Random& r = b.random();
  b.begin("lamp");
  b.use(another(s.ceramic, r));
  b.turned({0, 0, z},
           {{0, 0}, {0.055, 0}, {0.06, 0.015}, {0.03, 0.05}, {0.055, 0.12}, {0.05, 0.17}, {0.015, 0.21}, {0.012, 0.25}},
           true);
  b.use(s.lampshade);
  b.turned({0, 0, z + 0.22}, {{0.125, 0}, {0.085, 0.17}}, false);
  b.turned({0, 0, z + 0.225}, {{0, 0}, {0.12, 0}}, false);
  b.turned({0, 0, z + 0.385}, {{0.085, 0}, {0, 0}}, false);
  shade_lights(b, {0, 0, z + 0.305}, 0.125, 0.17, 7 * brightness);
}

void add_floor_lamp(MeshBuilder& b, const RoomStyle& s, double brightness) {
  b.occupy({-0.14, 0.02, 0}, {0.14, 0.3, 1.6});
  b.begin("lamp");
  b.use(s.dark_metal);
  b.turned({0, 0.16, 0}, {{0, 0}, {0.13, 0}, {0.13, 0.02}, {0, 0.024}}, false);
  b.bar({0, 0.16, 0.02}, {0, 0.16, 1.35}, 0.012);
  b.use(s.lampshade);
  b.turned({0, 0.16, 1.3}, {{0.19, 0}, {0.14, 0.26}}, false);
  b.turned({0, 0.16, 1.31}, {{0, 0}, {0.185, 0}}, false);
  b.turned({0, 0.16, 1.555}, {{0.14, 0}, {0, 0}}, false);
  shade_lights(b, {0, 0.16, 1.43}, 0.19, 0.26, 6 * brightness);
}

void add_ceiling_light(MeshBuilder& b, const RoomStyle& s, double ceiling, double brightness) {
  b.begin("light");
  Material glow = s.lampshade;
  glow.a = {1.0f, 0.95f, 0.86f};
  glow.emission = 0.6f;
  b.use(glow);
  b.turned({0, 0, ceiling - 0.09}, {{0, 0}, {0.16, 0.015}, {0.24, 0.05}, {0.25, 0.09}}, true);
  AreaLight light;
  light.origin = b.frame() * Vec3d{-0.22, -0.22, ceiling - 0.1};
  light.edge_u = b.frame().rotation * Vec3d{0.44, 0, 0};
  light.edge_v = b.frame().rotation * Vec3d{0, 0.44, 0};
  light.normal = {0, 0, -1};
  light.radiance = Vec3f{1.0f, 0.93f, 0.82f} * static_cast<float>(11 * brightness);
  light.columns = light.rows = 3;
  b.room().lights.push_back(light);
}

void add_pendant(MeshBuilder& b, const RoomStyle& s, double ceiling, double z, double brightness) {
  b.begin("chandelier");
  b.use(s.dark_metal);
  b.bar({0, 0, z + 0.2}, {0, 0, ceiling}, 0.008);
  b.turned({0, 0, ceiling - 0.03}, {{0, 0}, {0.05, 0}, {0.05, 0.03}}, false);
  b.use(s.ceramic);
  b.turned({0, 0, z}, {{0.2, 0}, {0.17, 0.09}, {0.07, 0.19}, {0, 0.21}}, true);
  Material glow = s.lampshade;
  glow.emission = 0.5f;
  b.use(glow);
  b.turned({0, 0, z + 0.004}, {{0, 0}, {0.195, 0}}, false);
  b.occupy({-0.2, -0.2, z}, {0.2, 0.2, z + 0.21});
  AreaLight light;
  light.origin = b.frame() * Vec3d{-0.15, -0.15, z - 0.006};
  light.edge_u = b.frame().rotation * Vec3d{0.3, 0, 0};
  light.edge_v = b.frame().rotation * Vec3d{0, 0.3, 0};
  light.normal = {0, 0, -1};
  light.radiance = Vec3f{1.0f, 0.88f, 0.7f} * static_cast<float>(14 * brightness);
  light.columns = light.rows = 3;
  b.room().lights.push_back(light);
}

void add_plant(MeshBuilder& b, const RoomStyle& s, double height) {
  Random& r = b.random();
  const double pot = std::min(0.17, 0.07 + 0.08 * height);
  b.occupy({-pot * 1.6, 0.0, 0}, {pot * 1.6, pot * 3.2, height});
  const Vec3d centre{0, pot * 1.6, 0};
  b.begin("pot");
  b.use(another(s.ceramic, r));
  b.turned(centre,
           {{0, 0},
            {pot * 0.75, 0},
            {pot, pot * 1.8},
            {pot * 1.06, pot * 1.8},
            {pot * 1.06, pot * 2.0},
            {pot * 0.92, pot * 2.0},
            {pot * 0.9, pot * 1.8}},
           false);
  b.use(s.soil);
  b.turned(centre, {{pot * 0.9, pot * 1.8}, {0, pot * 1.85}}, false);
  b.begin("plant");
  const int leaves = 16 + static_cast<int>(10 * height);
  for (int i = 0; i < leaves; ++i) {
    const double a = 2.4 * i + r.uniform(-0.3, 0.3), t = (i + 0.5) / leaves;
    const double length = (0.35 + 0.3 * r.uniform()) * height * 0.62, width = length * r.uniform(0.2, 0.32);
    const double lift = 0.15 + 1.1 * t, base = pot * 1.85 + (height - pot * 1.85) * 0.45 * t;
    const double reach = std::min(1.0, pot * 1.7 / (length * std::cos(std::min(1.3, lift)) + 1e-6) * 1.5);
    b.use(another(s.leaf, r));
    // A leaf rises along its midrib and droops towards its tip; its halves fold up a little.
    const auto surface = [=](double u, double v) {
      const double l = length * u,
                   w = width * std::pow(std::max(0.0, std::sin(kPi * std::min(1.0, 0.06 + 0.94 * u))), 0.8) * (v - 0.5);
      const double out = l * std::cos(lift) * reach + 0.012;
      const double up = base + l * std::sin(lift) - 0.5 * length * u * u * 0.6 + 0.25 * std::fabs(w);
      return centre + Vec3d{out * std::cos(a) - w * std::sin(a), out * std::sin(a) + w * std::cos(a), up};
    };
    b.sheet(surface, length, width, 0.003);
  }
  b.use(s.leaf);
  b.bar(centre + Vec3d{0, 0, pot * 1.8}, centre + Vec3d{0, 0, pot * 1.85 + (height - pot * 1.85) * 0.5}, 0.012);
}

void add_vase(MeshBuilder& b, const RoomStyle& s, double z) {
  Random& r = b.random();
  b.begin("vase");
  Material m = another(s.ceramic, r);
  m.a = Vec3f{static_cast<float>(r.uniform(0.15, 0.7)), static_cast<float>(r.uniform(0.15, 0.6)),
              static_cast<float>(r.uniform(0.15, 0.6))};
  b.use(m);
  const double k = r.uniform(0.8, 1.1);
  b.turned({0, 0, z},
           {{0, 0},
            {0.035 * k, 0},
            {0.06 * k, 0.06 * k},
            {0.058 * k, 0.1 * k},
            {0.028 * k, 0.16 * k},
            {0.034 * k, 0.19 * k},
            {0.024 * k, 0.185 * k},
            {0, 0.12 * k}},
           true);
}

void add_rug(MeshBuilder& b, const RoomStyle& s, double width, double depth) {
  const double w = width / 2, d = depth / 2, thick = 0.012;
  b.begin("rug");
  Material m = another(s.rug, b.random());
  m.scale = static_cast<float>(std::max(width, depth));
  b.use(m);
  const bool turn = depth > width;  // the pattern's long side follows the rug's
  if (turn)
    b.rectangle({w, -d, thick}, {0, depth, 0}, {-width, 0, 0}, true);
  else
    b.rectangle({-w, -d, thick}, {width, 0, 0}, {0, depth, 0}, true);
  Material edge = m;
  edge.kind = TextureKind::kWeave;
  edge.scale = 1;
  b.use(edge);
  b.rectangle({-w, -d, 0}, {width, 0, 0}, {0, 0, thick});
  b.rectangle({w, d, 0}, {-width, 0, 0}, {0, 0, thick});
  b.rectangle({w, -d, 0}, {0, depth, 0}, {0, 0, thick});
  b.rectangle({-w, d, 0}, {0, -depth, 0}, {0, 0, thick});
}

void add_painting(MeshBuilder& b, const RoomStyle& s, double width, double height, double z_centre) {
  Random& r = b.random();
  const double w = width / 2, h = height / 2, rim = 0.03, z = z_centre;
  b.begin("painting");
  b.use(another(r.chance(0.5) ? s.second_wood : s.dark_metal, r));
  b.box({-w, 0, z - h}, {-w + rim, 0.028, z + h});
  b.box({w - rim, 0, z - h}, {w, 0.028, z + h});
  b.box({-w + rim, 0, z - h}, {w - rim, 0.028, z - h + rim});
  b.box({-w + rim, 0, z + h - rim}, {w - rim, 0.028, z + h});
  b.use(picture_material(TextureKind::kPainting, r));
  b.rectangle({w - rim, 0.016, z - h + rim}, {-width + 2 * rim, 0, 0}, {0, 0, height - 2 * rim}, true);
}

void add_clock(MeshBuilder& b, const RoomStyle& s, double z_centre) {
  b.begin("clock");
  // Turned about the axis that comes out of the wall.
  b.nested({Mat3d{{1, 0, 0, 0, 0, 1, 0, -1, 0}}, {0, 0, z_centre}}, [&] {
    b.use(s.dark_metal);
    b.turned({}, {{0.15, 0}, {0.16, 0.03}, {0.14, 0.04}, {0.14, 0.03}}, false);
    b.use(s.white_plastic);
    b.turned({0, 0, 0.03}, {{0.14, 0}, {0, 0}}, false);
    b.use(s.black_plastic);
    b.box({-0.006, -0.09, 0.032}, {0.006, 0.0, 0.035});
    b.box({0, -0.005, 0.032}, {0.12, 0.005, 0.034});
    for (int i = 0; i < 12; ++i) {
      const double a = kPi / 6 * i;
      b.nested(placement({0.12 * std::cos(a), 0.12 * std::sin(a), 0.0305}, i * 30.0), [&] {
        b.box({-0.012, -0.003, 0}, {0.012, 0.003, 0.002});
      });
    }
  });
}

void add_bulletin_board(MeshBuilder& b, const RoomStyle& s, double width, double height, double z_centre) {
  Random& r = b.random();
  const double w = width / 2, h = height / 2;
  b.begin("bulletin board");
  b.use(another(s.second_wood, r));
  b.box({-w, 0, z_centre - h}, {w, 0.018, z_centre + h});
  Material cork = s.wicker;
  cork.kind = TextureKind::kStone;
  cork.c = cork.b * 0.7f;
  cork.scale = 0.7f;
  b.use(cork);
  b.rectangle({w - 0.02, 0.0192, z_centre - h + 0.02}, {-width + 0.04, 0, 0}, {0, 0, height - 0.04});
  for (double x = -w + 0.12; x < w - 0.1; x += r.uniform(0.2, 0.27)) {
    b.use(picture_material(r.chance(0.5) ? TextureKind::kPainting : TextureKind::kScreen, r));
    const double z = z_centre + r.uniform(-0.4, 0.25) * h;
    b.rectangle({x + 0.07, 0.0215, z - 0.1}, {-0.15, 0, 0}, {0, 0, 0.2}, true);
  }
}

void add_basket(MeshBuilder& b, const RoomStyle& s) {
  b.occupy({-0.2, 0, 0}, {0.2, 0.4, 0.32});
  b.begin("basket");
  b.use(another(s.wicker, b.random()));
  b.turned({0, 0.2, 0},
           {{0, 0}, {0.15, 0}, {0.19, 0.2}, {0.18, 0.3}, {0.165, 0.3}, {0.17, 0.2}, {0.14, 0.02}, {0, 0.02}}, false);
  b.begin("blanket");
  b.use(another(s.throw_cloth, b.random()));
  b.nested({Mat3d::identity(), {0, 0.2, 0.2}}, [&] { b.pillow({}, 0.13, 0.13, 0.1); });
}

void add_waste_bin(MeshBuilder& b, const RoomStyle& s) {
  b.occupy({-0.14, 0, 0}, {0.14, 0.28, 0.32});
  b.begin("ashcan");
  b.use(s.dark_metal);
  b.turned({0, 0.14, 0}, {{0, 0}, {0.1, 0}, {0.135, 0.3}, {0.128, 0.3}, {0.095, 0.012}, {0, 0.012}}, false);
}

void add_radiator(MeshBuilder& b, const RoomStyle& s, double width) {
  const double w = width / 2;
  b.occupy({-w, 0, 0}, {w, 0.13, 0.72});
  b.begin("radiator");
  b.use(s.white_plastic);
  b.box({-w, 0.035, 0.12}, {w, 0.05, 0.68});
  const int ribs = static_cast<int>(width / 0.075);
  for (int i = 0; i < ribs; ++i) {
    const double x = -w + (i + 0.5) * width / ribs;
    b.rounded_box({{x - 0.027, 0.05, 0.1}, {x + 0.027, 0.115, 0.7}, 0.018, 0, 0});
  }
}

void add_curtains(MeshBuilder& b, const RoomStyle& s, double opening, double bundle, double top, double bottom) {
  Random& r = b.random();
  b.begin("curtain");
  for (const double side : {-1.0, 1.0}) {
    b.use(another(s.curtain, r));
    const double folds = 5 + r.below(3), phase = r.uniform(0, 6);
    const uint32_t seed = static_cast<uint32_t>(r.next());
    const auto surface = [=](double u, double v) {
      const double x = opening + bundle * (side > 0 ? u : 1 - u);
      const double flare = 1 + 0.35 * (1 - v);
      const double wave = 0.035 * flare *
                          std::sin(2 * kPi * folds * u + phase +
                                   0.8 * fractal_noise(static_cast<float>(u * 3), static_cast<float>(v * 2), 2, seed));
      return Vec3d{side * x * (1 + 0.02 * (1 - v)), 0.1 + wave, bottom + (top - bottom) * v};
    };
    // u grows with x on both sides, so that du x dv points to the wall; the second side of the sheet faces the room.
    b.sheet(surface, bundle * 4.2, top - bottom, 0.006);  // the folds make the cloth that long
  }
  b.use(s.dark_metal);
  const double end = opening + bundle + 0.08;
  b.bar({-end, 0.1, top + 0.015}, {end, 0.1, top + 0.015}, 0.014);
  for (const double x : {-end + 0.05, end - 0.05}) b.bar({x, 0.0, top + 0.015}, {x, 0.1, top + 0.015}, 0.009);
}

void add_box_pile(MeshBuilder& b, const RoomStyle& s) {
  Random& r = b.random();
  double z = 0;
  for (int i = 0; i < 2; ++i) {
    b.begin("box");
    Material m = another(i == 0 ? s.wicker : s.cushion_a, r);
    b.use(m);
    const double h = r.uniform(0.14, 0.2);
    b.nested(placement({i * 0.04, 0.17, z}, r.uniform(-6, 6)), [&] {
      b.box({-0.2 + 0.04 * i, -0.14, 0}, {0.2 - 0.04 * i, 0.14, h});
    });
    z += h;
  }
}

}  // namespace aligngs
