#include "room/plan/plan_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/error.h"

namespace aligngs {
namespace {

constexpr double kMillimetres = 1000;  // per metre
constexpr double kLetterWidth = 0.6;   // of a letter's height, on the mean
constexpr double kTick = 1.2;          // mm on paper: half of the stroke that ends a dimension
constexpr double kPaneGap = 80;        // mm: depth of a window's two lines, so that they are distinct at 1:50

Vec2d millimetres(const Vec3d& p) { return {p.x * kMillimetres, p.y * kMillimetres}; }
Vec2d plus(const Vec2d& a, const Vec2d& b, double t) { return {a.x + t * b.x, a.y + t * b.y}; }

/// Turn of a text along a direction, never upside down.
double readable_turn(const Vec2d& along) {
  double turn = std::atan2(along.y, along.x) / kRadiansPerDegree;
  if (turn > 90 + 1e-6) turn -= 180;
  if (turn <= -90 + 1e-6) turn += 180;
  return turn;
}

class Plan {
 public:
  Plan(const MeasuredRoom& room, const PlanSettings& settings) : room_(room), s_(settings) {}

  PlanDrawing draw() {
    for (size_t w = 0; w < room_.walls.size(); ++w) draw_wall(w);
    draw_area();
    // The names of large things first: one that would cover another text is left out.
    std::vector<const MeasuredBox*> boxes;
    for (const MeasuredBox& box : room_.boxes) boxes.push_back(&box);
    std::stable_sort(boxes.begin(), boxes.end(),
                     [](auto* a, auto* b) { return a->width * a->depth > b->width * b->depth; });
    for (const MeasuredBox* box : boxes) draw_box(*box);
    frame();
    draw_scale_bar();
    return std::move(out_);
  }

 private:
  double paper(double mm) const { return mm * s_.scale; }
  void add(PlanLayer layer, std::vector<Vec2d> points, bool closed = false, bool dashed = false) {
    out_.paths.push_back({layer, std::move(points), closed, dashed});
  }
  void write(PlanLayer layer, const Vec2d& place, std::string text, double turn = 0,
             PlanAnchor anchor = PlanAnchor::kMiddle) {
    out_.texts.push_back({layer, place, std::move(text), paper(s_.text), turn, anchor});
  }

  void draw_wall(size_t index) {
    const MeasuredWall& wall = room_.walls[index];
    std::vector<const MeasuredOpening*> holes;
    for (const MeasuredOpening& o : room_.openings) {
      const bool hole = o.kind == OpeningKind::kDoor || o.kind == OpeningKind::kWindow;
      if (hole && o.wall == static_cast<int>(index)) holes.push_back(&o);
    }
    std::sort(holes.begin(), holes.end(), [](auto* a, auto* b) { return a->left < b->left; });
    // The thickness of a wall is not measured: a wall is one line, with gaps at its doors and windows.
    double at = 0;
    std::vector<double> stops = {0};
    for (const MeasuredOpening* o : holes) {
      if (o->left > at)
        add(PlanLayer::kWalls, {millimetres(wall.at(at, 0)), millimetres(wall.at(o->left, 0))}, false, wall.assumed);
      at = std::max(at, o->right);
      draw_opening(wall, *o);
      stops.insert(stops.end(), {o->left, o->right});
    }
    if (wall.length() > at)
      add(PlanLayer::kWalls, {millimetres(wall.at(at, 0)), millimetres(wall.at(wall.length(), 0))}, false,
          wall.assumed);
    stops.push_back(wall.length());
    if (!holes.empty()) draw_chain(wall, stops, 1);
    draw_chain(wall, {0, wall.length()}, holes.empty() ? 1 : 2);
  }

  void draw_opening(const MeasuredWall& wall, const MeasuredOpening& o) {
    const Vec2d a = millimetres(wall.at(o.left, 0)), b = millimetres(wall.at(o.right, 0));
    const Vec2d out{-wall.normal.x, -wall.normal.y};
    add(PlanLayer::kOpenings, {a, plus(a, out, kPaneGap), plus(b, out, kPaneGap), b}, true);
    if (o.kind == OpeningKind::kWindow)
      add(PlanLayer::kOpenings, {plus(a, out, kPaneGap / 2), plus(b, out, kPaneGap / 2)});
    const Vec2d middle = millimetres(wall.at((o.left + o.right) / 2, 0));
    const Vec2d along{b.x - a.x, b.y - a.y};
    const std::string size = o.kind == OpeningKind::kWindow
                                 ? fmt::format("{:.2f} / sill {:.2f}", o.top - o.bottom, o.bottom)
                                 : fmt::format("h {:.2f}", o.top);
    // The middle of the letters is one letter's height from the wall, whichever side is up for them.
    const double turn = readable_turn(along);
    const Vec2d up{-std::sin(turn * kRadiansPerDegree), std::cos(turn * kRadiansPerDegree)};
    write(PlanLayer::kOpenings,
          plus(plus(middle, {wall.normal.x, wall.normal.y}, 1.2 * paper(s_.text)), up, -paper(s_.text) / 2), size,
          turn);
  }

  /// A line beside a wall with strokes at `stops` (along the wall, metres) and lengths between them.
  void draw_chain(const MeasuredWall& wall, const std::vector<double>& stops, int row) {
    const Vec2d out{-wall.normal.x, -wall.normal.y};
    const double away = paper(s_.chain) * row, tick = paper(kTick);
    const auto place = [&](double at) { return plus(millimetres(wall.at(at, 0)), out, away); };
    const Vec2d a = place(0), b = place(wall.length());
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    if (!(length > 0)) return;
    const Vec2d along{(b.x - a.x) / length, (b.y - a.y) / length};
    const double turn = readable_turn(along);
    add(PlanLayer::kDimensions, {a, b});
    for (const double stop : stops) {
      const Vec2d p = place(stop), slant{along.x + out.x, along.y + out.y};
      add(PlanLayer::kDimensions, {plus(p, slant, -tick / 2), plus(p, slant, tick / 2)});
    }
    // Letters are on the line, on the side that is up for them.
    const Vec2d up{-std::sin(turn * kRadiansPerDegree), std::cos(turn * kRadiansPerDegree)};
    for (size_t i = 0; i + 1 < stops.size(); ++i) {
      const double size = stops[i + 1] - stops[i];
      const std::string text = fmt::format("{:.2f}", size);
      if (size * kMillimetres < kLetterWidth * paper(s_.text) * static_cast<double>(text.size())) continue;
      write(PlanLayer::kDimensions, plus(place((stops[i] + stops[i + 1]) / 2), up, paper(s_.text) * 0.4), text, turn);
    }
  }

  void draw_box(const MeasuredBox& box) {
    std::vector<Vec2d> corners;
    for (const Vec2d& p : footprint(box)) corners.push_back({p.x * kMillimetres, p.y * kMillimetres});
    add(PlanLayer::kFurniture, corners, true, box.support != "floor");
    if (std::max(box.width, box.depth) * kMillimetres < s_.least_name) return;
    const double along = (box.width >= box.depth ? box.turn : box.turn + 90) * kRadiansPerDegree;
    const double turn = readable_turn({std::cos(along), std::sin(along)});
    const Vec2d up{-std::sin(turn * kRadiansPerDegree), std::cos(turn * kRadiansPerDegree)};
    const Vec2d centre{box.centre.x * kMillimetres, box.centre.y * kMillimetres};
    if (covers_text(centre, box.class_name, turn)) return;
    write(PlanLayer::kFurniture,
          plus({box.centre.x * kMillimetres, box.centre.y * kMillimetres}, up, -paper(s_.text) / 2), box.class_name,
          turn);
  }

  /// Whether a text about `centre` would cover one that is there, by the boxes of both.
  bool covers_text(const Vec2d& centre, const std::string& text, double turn) const {
    const double height = paper(s_.text);
    const auto half = [height](const std::string& letters, double degrees) {
      const double c = std::abs(std::cos(degrees * kRadiansPerDegree)),
                   s = std::abs(std::sin(degrees * kRadiansPerDegree));
      const double width = kLetterWidth * height * static_cast<double>(letters.size());
      return Vec2d{(c * width + s * height) / 2, (s * width + c * height) / 2};
    };
    const Vec2d own = half(text, turn);
    return std::any_of(out_.texts.begin(), out_.texts.end(), [&](const PlanText& other) {
      const double up = height / 2, x = other.place.x - std::sin(other.turn * kRadiansPerDegree) * up,
                   y = other.place.y + std::cos(other.turn * kRadiansPerDegree) * up;
      const Vec2d its = half(other.text, other.turn);
      return std::abs(x - centre.x) < own.x + its.x && std::abs(y - centre.y) < own.y + its.y;
    });
  }

  void draw_area() {
    // The centre of the outline's area.
    double x = 0, y = 0, twice = 0;
    for (const MeasuredWall& w : room_.walls) {
      const double c = w.from.x * w.to.y - w.from.y * w.to.x;
      twice += c;
      x += (w.from.x + w.to.x) * c;
      y += (w.from.y + w.to.y) * c;
    }
    if (!(std::abs(twice) > 0)) return;
    const Vec2d centre{x / (3 * twice) * kMillimetres, y / (3 * twice) * kMillimetres};
    write(PlanLayer::kText, centre, fmt::format("{:.2f} m²", room_.area()));
    const char* assumed = room_.floor_assumed || room_.ceiling_assumed ? " (assumed)" : "";
    write(PlanLayer::kText, plus(centre, {0, -1}, 1.8 * paper(s_.text)),
          fmt::format("height {:.2f} m{}", room_.height, assumed));
  }

  void frame() {
    Vec2d low{1e300, 1e300}, high{-1e300, -1e300};
    const auto take = [&](const Vec2d& p, double around) {
      low = {std::min(low.x, p.x - around), std::min(low.y, p.y - around)};
      high = {std::max(high.x, p.x + around), std::max(high.y, p.y + around)};
    };
    for (const PlanPath& path : out_.paths) {
      for (const Vec2d& p : path.points) take(p, 0);
    }
    for (const PlanText& t : out_.texts) take(t.place, t.height);
    const double margin = paper(s_.margin);
    out_.low = {low.x - margin, low.y - 2 * margin};
    out_.high = {high.x + margin, high.y + margin};
  }

  /// Two metres below the room, and what the drawing is.
  void draw_scale_bar() {
    const double margin = paper(s_.margin), y = out_.low.y + margin, x = out_.low.x + margin, tick = paper(kTick);
    add(PlanLayer::kText, {{x, y}, {x + 2 * kMillimetres, y}});
    for (const double at : {0.0, 1.0, 2.0}) {
      add(PlanLayer::kText, {{x + at * kMillimetres, y}, {x + at * kMillimetres, y + tick}});
      write(PlanLayer::kText, {x + at * kMillimetres, y + 1.5 * tick}, fmt::format("{:.0f} m", at));
    }
    write(PlanLayer::kText, {x, y - 1.6 * paper(s_.text)},
          fmt::format("1:{:.0f}, scale by {}", s_.scale, aligngs::name_of(room_.scale_source)), 0, PlanAnchor::kLeft);
  }

  const MeasuredRoom& room_;
  const PlanSettings& s_;
  PlanDrawing out_;
};

}  // namespace

const char* name_of(PlanLayer layer) {
  switch (layer) {
    case PlanLayer::kWalls:
      return "WALLS";
    case PlanLayer::kOpenings:
      return "OPENINGS";
    case PlanLayer::kFurniture:
      return "FURNITURE";
    case PlanLayer::kDimensions:
      return "DIMENSIONS";
    case PlanLayer::kText:
      return "TEXT";
  }
  return "";
}

PlanDrawing draw_plan(const MeasuredRoom& room, const PlanSettings& settings) {
  if (!room.metric) {
    std::string known = "ceiling";  // a name that this room has
    for (size_t i = 0; i < room.openings.size(); ++i) {
      if (room.openings[i].kind == OpeningKind::kDoor) known = opening_name(room, i);
    }
    const char* height = known == "ceiling" ? "2.5" : "2.0";
    throw_bad_input({}, "units", "the scale of this room is not known, so that no plan can be drawn to scale",
                    "give a length that you know: aligngs scale RUN --object " + known + " --height " + height);
  }
  return Plan(room, settings).draw();
}

}  // namespace aligngs
