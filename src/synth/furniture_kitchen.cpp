// A fitted kitchen along one wall.
#include <algorithm>
#include <cmath>

#include "synth/furniture.h"

namespace aligngs {
namespace {

constexpr double kDepth = 0.6;   // of base cupboards, metres
constexpr double kHeight = 0.9;  // of the worktop
constexpr double kTop = 0.04;    // thickness of the worktop

void handle(MeshBuilder& b, const RoomStyle& s, double x, double z, double half, double y) {
  b.use(s.metal);
  b.bar({x - half, y + 0.026, z}, {x + half, y + 0.026, z}, 0.006);
  for (const double e : {x - half + 0.008, x + half - 0.008}) b.bar({e, y, z}, {e, y + 0.026, z}, 0.005);
}

void base_cupboard(MeshBuilder& b, const RoomStyle& s, const Material& fronts, double x0, double x1, bool drawers) {
  Random& r = b.random();
  b.begin("cabinet");
  b.use(s.lacquer);
  b.box({x0, 0.01, 0.1}, {x1, kDepth - 0.02, kHeight - kTop});
  b.use(s.dark_metal);
  b.box({x0, 0.05, 0}, {x1, kDepth - 0.08, 0.1});
  const double y = kDepth - 0.02, g = 0.003;
  if (drawers) {
    const double levels[] = {0.11, 0.36, 0.61, kHeight - kTop - 0.005};
    for (int i = 0; i < 3; ++i) {
      b.use(another(fronts, r));
      b.box({x0 + g, y, levels[i] + g}, {x1 - g, y + 0.018, levels[i + 1] - g});
      handle(b, s, (x0 + x1) / 2, levels[i + 1] - 0.05, 0.08, y + 0.018);
    }
  } else {
    const int doors = x1 - x0 > 0.65 ? 2 : 1;
    for (int i = 0; i < doors; ++i) {
      const double a = x0 + (x1 - x0) * i / doors, c = x0 + (x1 - x0) * (i + 1) / doors;
      b.use(another(fronts, r));
      b.box({a + g, y, 0.11 + g}, {c - g, y + 0.018, kHeight - kTop - 0.008});
      handle(b, s, (a + c) / 2, kHeight - kTop - 0.06, 0.06, y + 0.018);
    }
  }
}

/// A worktop from x0 to x1 with a rectangular hole for the sink (skipped when hole_x1 <= hole_x0).
void worktop(MeshBuilder& b, const RoomStyle& s, double x0, double x1, double hole_x0, double hole_x1) {
  b.begin("countertop");
  b.use(s.counter);
  const double z0 = kHeight - kTop, y1 = kDepth + 0.02;
  if (hole_x1 <= hole_x0) {
    b.box({x0, 0.0, z0}, {x1, y1, kHeight});
    return;
  }
  b.box({x0, 0.0, z0}, {hole_x0, y1, kHeight});
  b.box({hole_x1, 0.0, z0}, {x1, y1, kHeight});
  b.box({hole_x0, 0.0, z0}, {hole_x1, 0.12, kHeight});
  b.box({hole_x0, 0.5, z0}, {hole_x1, y1, kHeight});
}

void sink(MeshBuilder& b, const RoomStyle& s, double x0, double x1) {
  b.begin("sink");
  b.use(s.metal);
  const double y0 = 0.12, y1 = 0.5, floor = kHeight - 0.17, rim = kHeight + 0.006, t = 0.006;
  b.box({x0 + t, y0 + t, floor}, {x1 - t, y1 - t, floor + 0.005});
  b.box({x0, y0, floor}, {x0 + t, y1, rim});
  b.box({x1 - t, y0, floor}, {x1, y1, rim});
  b.box({x0 + t, y0, floor}, {x1 - t, y0 + t, rim});
  b.box({x0 + t, y1 - t, floor}, {x1 - t, y1, rim});
  const double x = (x0 + x1) / 2;
  b.cylinder({x, 0.07, kHeight}, 0.022, 0.05);
  b.bar({x, 0.07, kHeight + 0.05}, {x, 0.07, kHeight + 0.26}, 0.013);
  b.bar({x, 0.07, kHeight + 0.255}, {x, 0.25, kHeight + 0.25}, 0.012);
  b.bar({x, 0.245, kHeight + 0.255}, {x, 0.245, kHeight + 0.21}, 0.012);
}

void stove(MeshBuilder& b, const RoomStyle& s, double x0, double x1) {
  b.begin("stove");
  b.use(s.white_plastic);
  b.box({x0, 0.01, 0.03}, {x1, kDepth - 0.02, kHeight - 0.01});
  b.use(s.black_gloss);
  b.box({x0 + 0.004, 0.02, kHeight - 0.01}, {x1 - 0.004, kDepth + 0.01, kHeight + 0.006});
  const double middle = (x0 + x1) / 2;
  for (const double dx : {-0.14, 0.14}) {
    for (const double y : {0.18, 0.44}) {
      const double r = (dx < 0) == (y < 0.3) ? 0.1 : 0.075;
      b.use(s.metal);
      b.turned({middle + dx, y, kHeight + 0.006}, {{r - 0.006, 0}, {r, 0}, {r, 0.003}, {r - 0.006, 0.003}}, false);
    }
  }
  b.use(s.metal);
  b.box({x0 + 0.01, kDepth - 0.02, kHeight - 0.13}, {x1 - 0.01, kDepth, kHeight - 0.02});
  b.use(s.black_plastic);
  for (int i = 0; i < 5; ++i) {
    const double x = x0 + 0.1 + i * (x1 - x0 - 0.2) / 4;
    b.bar({x, kDepth, kHeight - 0.075}, {x, kDepth + 0.025, kHeight - 0.075}, 0.018);
  }
  b.begin("oven");
  b.use(s.black_gloss);
  b.box({x0 + 0.015, kDepth - 0.02, 0.24}, {x1 - 0.015, kDepth + 0.004, kHeight - 0.15});
  handle(b, s, middle, kHeight - 0.19, (x1 - x0) / 2 - 0.07, kDepth + 0.004);
  b.use(s.white_plastic);
  b.box({x0 + 0.015, kDepth - 0.02, 0.06}, {x1 - 0.015, kDepth, 0.225});
}

void refrigerator(MeshBuilder& b, const RoomStyle& s, double x0, double x1) {
  Random& r = b.random();
  const double h = r.uniform(1.75, 1.95), split = 0.62;
  b.begin("refrigerator");
  b.use(r.chance(0.5) ? s.white_plastic : s.lacquer);
  b.box({x0 + 0.01, 0.03, 0.02}, {x1 - 0.01, 0.58, h});
  b.rounded_box({{x0 + 0.01, 0.585, 0.05}, {x1 - 0.01, 0.65, split}, 0.015, 0, 0});
  b.rounded_box({{x0 + 0.01, 0.585, split + 0.008}, {x1 - 0.01, 0.65, h}, 0.015, 0, 0});
  b.use(s.metal);
  for (const auto& [z0, z1] : {std::pair{split - 0.28, split - 0.04}, std::pair{split + 0.06, split + 0.5}}) {
    b.bar({x0 + 0.06, 0.685, z0}, {x0 + 0.06, 0.685, z1}, 0.011);
    for (const double z : {z0 + 0.02, z1 - 0.02}) b.bar({x0 + 0.06, 0.65, z}, {x0 + 0.06, 0.685, z}, 0.007);
  }
  b.occupy({x0, 0, 0}, {x1, 0.7, h});
}

void wall_cupboards(MeshBuilder& b, const RoomStyle& s, const Material& fronts, double x0, double x1) {
  if (x1 - x0 < 0.3) return;
  Random& r = b.random();
  const double z0 = 1.45, z1 = 2.15, depth = 0.33;
  const int doors = std::max(1, static_cast<int>(std::lround((x1 - x0) / 0.45)));
  b.begin("cabinet");
  b.use(s.lacquer);
  b.box({x0, 0.005, z0}, {x1, depth, z1});
  for (int i = 0; i < doors; ++i) {
    const double a = x0 + (x1 - x0) * i / doors, c = x0 + (x1 - x0) * (i + 1) / doors;
    b.use(another(fronts, r));
    b.box({a + 0.003, depth, z0 + 0.003}, {c - 0.003, depth + 0.018, z1 - 0.003});
    handle(b, s, (a + c) / 2, z0 + 0.05, 0.06, depth + 0.018);
  }
  b.occupy({x0, 0, z0}, {x1, depth, z1});
}

void hood(MeshBuilder& b, const RoomStyle& s, double x0, double x1) {
  b.begin("hood");
  b.use(s.metal);
  b.box({x0 + 0.01, 0.005, 1.58}, {x1 - 0.01, 0.48, 1.65});
  const double m = (x0 + x1) / 2;
  b.box({m - 0.14, 0.005, 1.65}, {m + 0.14, 0.3, 2.3});
}

void pot(MeshBuilder& b, const RoomStyle& s, double x, double y, double z) {
  b.begin("pot");
  b.use(s.ceramic);
  b.turned({x, y, z},
           {{0, 0}, {0.095, 0}, {0.1, 0.13}, {0.105, 0.135}, {0.09, 0.15}, {0.02, 0.165}, {0.02, 0.18}, {0, 0.185}},
           false);
  for (const double d : {-1.0, 1.0}) b.bar({x + d * 0.098, y, z + 0.1}, {x + d * 0.14, y, z + 0.1}, 0.01);
}

void clutter(MeshBuilder& b, const RoomStyle& s, double x0, double x1) {
  Random& r = b.random();
  if (x1 - x0 < 0.3) return;
  const double m = x0 + 0.3;
  if (x1 - x0 > 0.62) {
    b.begin("microwave");
    b.use(s.white_plastic);
    b.box({m - 0.25, 0.08, kHeight}, {m + 0.25, 0.42, kHeight + 0.29});
    b.use(s.black_gloss);
    b.box({m - 0.22, 0.42, kHeight + 0.03}, {m + 0.12, 0.426, kHeight + 0.26});
  }
  for (double x = x1 - 0.08; x > x1 - 0.3; x -= 0.1) {
    b.begin("bottle");
    b.use(another(r.chance(0.5) ? s.ceramic : s.leaf, r));
    const double h = r.uniform(0.8, 1.1);
    b.turned({x, r.uniform(0.12, 0.25), kHeight},
             {{0, 0}, {0.036, 0}, {0.038, 0.15 * h}, {0.014, 0.21 * h}, {0.014, 0.27 * h}, {0, 0.27 * h}}, false, 14);
  }
}

}  // namespace

void add_kitchen_run(MeshBuilder& b, const RoomStyle& s, double length, double window_low, double window_high) {
  Random& r = b.random();
  const Material fronts = another(r.chance(0.5) ? s.wood : s.second_wood, r);
  const double left = -length / 2, right = length / 2, fridge = 0.66;
  const double run_end = right - fridge, window = (window_low + window_high) / 2;
  const double sink_x0 = std::clamp(window - 0.3, left + 0.65, run_end - 1.35), sink_x1 = sink_x0 + 0.6;
  const double stove_x0 = run_end - 0.62, stove_x1 = stove_x0 + 0.6;
  refrigerator(b, s, right - fridge, right);
  b.occupy({left, 0, 0}, {run_end, kDepth + 0.02, kHeight});

  base_cupboard(b, s, fronts, left, sink_x0 - 0.02, true);
  base_cupboard(b, s, fronts, sink_x0 - 0.02, sink_x1 + 0.02, false);
  if (stove_x0 - sink_x1 > 0.1) base_cupboard(b, s, fronts, sink_x1 + 0.02, stove_x0, false);
  stove(b, s, stove_x0, stove_x1);
  worktop(b, s, left, stove_x0, sink_x0, sink_x1);
  sink(b, s, sink_x0, sink_x1);
  hood(b, s, stove_x0, stove_x1);
  wall_cupboards(b, s, fronts, left, std::min(window_low - 0.1, stove_x0));
  wall_cupboards(b, s, fronts, window_high + 0.1, stove_x0 - 0.02);
  pot(b, s, stove_x0 + 0.16, 0.44, kHeight + 0.009);
  clutter(b, s, left + 0.08, sink_x0 - 0.06);
}

}  // namespace aligngs
