// Wardrobes, chests, shelves and the books on them.
#include <algorithm>
#include <cmath>

#include "synth/furniture.h"

namespace aligngs {
namespace {

/// A flat front with a thin shadow gap around it and a handle.
void front(MeshBuilder& b, double x0, double x1, double z0, double z1, double y) {
  constexpr double kGap = 0.004;
  b.box({x0 + kGap, y, z0 + kGap}, {x1 - kGap, y + 0.018, z1 - kGap});
}

void bar_handle(MeshBuilder& b, const RoomStyle& s, const Vec3d& from, const Vec3d& to) {
  b.use(s.metal);
  b.bar(from + Vec3d{0, 0.022, 0}, to + Vec3d{0, 0.022, 0}, 0.006);
  b.bar(from, from + Vec3d{0, 0.022, 0}, 0.005);
  b.bar(to, to + Vec3d{0, 0.022, 0}, 0.005);
}

}  // namespace

void add_wardrobe(MeshBuilder& b, const RoomStyle& s, double width) {
  Random& r = b.random();
  const double w = width / 2, depth = 0.58, height = r.uniform(2.0, 2.2);
  b.occupy({-w, 0, 0}, {w, depth + 0.04, height});
  b.begin("wardrobe");
  const Material body = another(r.chance(0.35) ? s.lacquer : s.wood, r);
  b.use(body);
  b.box({-w, 0.01, 0.07}, {w, depth, height});
  b.box({-w + 0.03, 0.04, 0}, {w - 0.03, depth - 0.04, 0.07});
  b.box({-w - 0.02, 0.005, height}, {w + 0.02, depth + 0.03, height + 0.03});
  const int doors = std::max(2, static_cast<int>(std::lround(width / 0.5)));
  const Material inlay = another(s.second_wood, r);
  const double each = width / doors;
  for (int i = 0; i < doors; ++i) {
    const double x0 = -w + i * each, x1 = x0 + each;
    b.use(another(body, r));
    front(b, x0, x1, 0.08, height, depth);
    b.use(inlay);
    for (const auto& [z0, z1] : {std::pair{0.16, 0.9}, std::pair{1.0, height - 0.1}}) {
      b.box({x0 + 0.07, depth + 0.018, z0}, {x1 - 0.07, depth + 0.024, z1});
    }
    const double hx = (i & 1) == 0 ? x1 - 0.035 : x0 + 0.035;
    bar_handle(b, s, {hx, depth + 0.018, 0.95}, {hx, depth + 0.018, 1.15});
  }
  if (r.chance(0.6)) {
    b.nested(placement({r.uniform(-0.2, 0.2), 0.1, height + 0.03}, 0), [&] { add_box_pile(b, s); });
  }
}

void add_chest_of_drawers(MeshBuilder& b, const RoomStyle& s, double width) {
  Random& r = b.random();
  const double w = width / 2, depth = 0.45, height = r.uniform(0.8, 0.95);
  b.occupy({-w, 0, 0}, {w, depth + 0.03, height});
  b.begin("chest of drawers");
  const Material body = another(s.second_wood, r);
  b.use(body);
  b.box({-w, 0.01, 0.08}, {w, depth, height - 0.03});
  b.box({-w - 0.015, 0.005, height - 0.03}, {w + 0.015, depth + 0.03, height});
  for (const double x : {-w + 0.01, w - 0.06}) {
    for (const double y : {0.02, depth - 0.06}) b.box({x, y, 0}, {x + 0.05, y + 0.05, 0.08});
  }
  const int rows = 4;
  const double each = (height - 0.14) / rows;
  for (int i = 0; i < rows; ++i) {
    const double z = 0.1 + i * each;
    const bool halves = i == rows - 1;
    for (int k = 0; k < (halves ? 2 : 1); ++k) {
      const double x0 = halves ? -w + k * w + 0.01 : -w + 0.01, x1 = halves ? x0 + w - 0.02 : w - 0.01;
      b.use(another(body, r));
      front(b, x0, x1, z, z + each, depth);
      b.use(s.dark_metal);
      for (const double t : halves ? std::vector<double>{0.5} : std::vector<double>{0.25, 0.75}) {
        b.turned({x0 + t * (x1 - x0), depth + 0.03, z + each / 2 - 0.014},
                 {{0, 0}, {0.012, 0.004}, {0.016, 0.014}, {0.012, 0.024}, {0, 0.028}}, true, 10);
      }
    }
  }
}

void add_books(MeshBuilder& b, double x0, double x1, double z, double front_y, double max_height) {
  Random& r = b.random();
  b.begin("book");
  double x = x0;
  while (x < x1 - 0.05) {
    const double t = r.uniform(0.018, 0.05), h = std::min(max_height - 0.01, r.uniform(0.17, 0.3));
    const double depth = std::min(front_y - 0.02, r.uniform(0.13, 0.2)), back = r.uniform(0.0, 0.025);
    if (x + t > x1) break;
    b.use(book_material(r));
    // The back faces the room; its texture starts at the foot of the book.
    const double y = front_y - back;
    b.rectangle({x + t, y, z}, {-t, 0, 0}, {0, 0, h});
    b.rectangle({x, y, z}, {0, -depth, 0}, {0, 0, h});
    b.rectangle({x + t, y - depth, z}, {0, depth, 0}, {0, 0, h});
    b.rectangle({x, y, z + h}, {0, -depth, 0}, {t, 0, 0});
    b.rectangle({x, y - depth, z}, {t, 0, 0}, {0, 0, h});
    if (r.chance(0.07)) x += r.uniform(0.03, 0.14);
    x += t + 0.0015;
  }
}

void add_bookcase(MeshBuilder& b, const RoomStyle& s, double width, double height) {
  Random& r = b.random();
  const double w = width / 2, depth = 0.3, board = 0.025;
  b.occupy({-w, 0, 0}, {w, depth, height});
  b.begin("bookcase");
  b.use(another(s.wood, r));
  b.box({-w, 0.005, 0}, {-w + board, depth, height});
  b.box({w - board, 0.005, 0}, {w, depth, height});
  b.box({-w + board, 0.005, 0.0}, {w - board, 0.018, height});
  b.box({-w + board, 0.018, height - board}, {w - board, depth, height});
  b.box({-w + board, 0.03, 0}, {w - board, depth - 0.03, 0.07});
  const int rows = std::max(2, static_cast<int>(std::lround((height - 0.1) / 0.36)));
  const double each = (height - 0.07 - board) / rows;
  for (int i = 0; i < rows; ++i) {
    const double z = 0.07 + i * each;
    b.use(another(s.wood, r));
    b.box({-w + board, 0.018, z}, {w - board, depth - 0.005, z + board});
  }
  for (int i = 0; i < rows; ++i) {
    const double z = 0.07 + i * each + board, free = each - board;
    const double fill = r.uniform(0.55, 1.0), x1 = -w + board + fill * (width - 2 * board);
    add_books(b, -w + board + 0.004, x1, z, depth - 0.03, free);
    if (w - board - x1 > 0.16) {
      b.nested(placement({(x1 + w - board) / 2 + 0.01, 0.15, 0}, 0), [&] {
        if (r.chance(0.5)) {
          add_vase(b, s, z);
        } else {
          b.begin("box");
          b.use(another(s.wicker, r));
          b.box({-0.06, -0.1, z}, {0.06, 0.1, z + std::min(0.16, free - 0.03)});
        }
      });
    }
  }
}

void add_wall_shelf(MeshBuilder& b, const RoomStyle& s, double width, double z) {
  Random& r = b.random();
  const double w = width / 2;
  b.begin("shelf");
  b.use(another(s.wood, r));
  b.box({-w, 0.0, z}, {w, 0.23, z + 0.028});
  b.use(s.dark_metal);
  for (const double x : {-w * 0.7, w * 0.7}) b.box({x - 0.012, 0, z - 0.12}, {x + 0.012, 0.02, z});
  add_books(b, -w + 0.03, w * r.uniform(0.1, 0.6), z + 0.028, 0.21, 0.3);
  b.nested(placement({w - 0.14, 0.12, 0}, 0), [&] { add_vase(b, s, z + 0.028); });
}

void add_tv_stand(MeshBuilder& b, const RoomStyle& s, double width) {
  Random& r = b.random();
  const double w = width / 2, depth = 0.42, height = r.uniform(0.45, 0.55);
  b.occupy({-w, 0, 0}, {w, depth, height});
  b.begin("cabinet");
  const Material body = another(s.wood, r);
  b.use(body);
  b.box({-w, 0.01, 0.1}, {w, depth, height});
  for (const double x : {-w + 0.05, w - 0.1}) {
    for (const double y : {0.04, depth - 0.09}) b.box({x, y, 0}, {x + 0.05, y + 0.05, 0.1});
  }
  for (int i = 0; i < 3; ++i) {
    b.use(another(i == 1 ? s.second_wood : body, r));
    front(b, -w + i * width / 3, -w + (i + 1) * width / 3, 0.11, height - 0.02, depth);
    b.use(s.metal);
    const double x = -w + (i + 0.5) * width / 3;
    b.bar({x - 0.05, depth + 0.026, height - 0.07}, {x + 0.05, depth + 0.026, height - 0.07}, 0.007);
  }
  b.begin("television");
  b.use(s.black_plastic);
  const double tv = std::min(0.62, w - 0.12), z = height + 0.06, h = tv * 1.14;
  b.box({-tv, 0.19, z}, {tv, 0.23, z + h});
  b.rounded_box({{-0.2, 0.12, height}, {0.2, 0.32, height + 0.014}, 0.006, 0, 0});
  b.box({-0.05, 0.19, height + 0.01}, {0.05, 0.22, z + 0.02});
  b.use(s.black_gloss);
  b.rectangle({tv - 0.012, 0.2312, z + 0.012}, {-2 * tv + 0.024, 0, 0}, {0, 0, h - 0.024});
}

void add_cabinet(MeshBuilder& b, const RoomStyle& s, double width, double height) {
  Random& r = b.random();
  const double w = width / 2, depth = 0.42;
  b.occupy({-w, 0, 0}, {w, depth + 0.03, height});
  b.begin("cabinet");
  const Material body = another(s.second_wood, r);
  b.use(body);
  b.box({-w, 0.01, 0.06}, {w, depth, height - 0.025});
  b.box({-w + 0.03, 0.03, 0}, {w - 0.03, depth - 0.04, 0.06});
  b.box({-w - 0.01, 0.005, height - 0.025}, {w + 0.01, depth + 0.03, height});
  const int doors = std::max(2, static_cast<int>(std::lround(width / 0.45)));
  const double each = width / doors;
  for (int i = 0; i < doors; ++i) {
    const double x0 = -w + i * each;
    b.use(another(body, r));
    front(b, x0, x0 + each, 0.065, height - 0.03, depth);
    b.use(another(s.wood, r));
    b.box({x0 + 0.06, depth + 0.018, 0.13}, {x0 + each - 0.06, depth + 0.023, height - 0.1});
    const double hx = (i & 1) == 0 ? x0 + each - 0.03 : x0 + 0.03;
    bar_handle(b, s, {hx, depth + 0.018, height * 0.55}, {hx, depth + 0.018, height * 0.55 + 0.12});
  }
}

}  // namespace aligngs
