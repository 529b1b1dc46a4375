#include "room/plan_cells.h"

#include <cmath>

namespace aligngs {
namespace {

constexpr double kSame = 1e-6;  // of the plan's size: corners this near are one, slivers this thin are none

struct Halves {
  PlanCell front, back;
};

/// The parts of a cell on both sides of a line; one is empty where the line misses the cell.
Halves cut(const PlanCell& cell, const PlanLine& line, int number, double least) {
  std::vector<double> distance;
  bool front = false, back = false;
  for (const Vec2d& p : cell.corners) {
    distance.push_back(line.distance(p));
    front = front || distance.back() > least;
    back = back || distance.back() < -least;
  }
  Halves out;
  if (!front || !back) {
    (front ? out.front : out.back) = cell;
    return out;
  }
  const size_t n = cell.corners.size();
  for (size_t k = 0; k < n; ++k) {
    const size_t next = (k + 1) % n;
    const Vec2d &a = cell.corners[k], &b = cell.corners[next];
    const double da = std::abs(distance[k]) <= least ? 0 : distance[k],
                 db = std::abs(distance[next]) <= least ? 0 : distance[next];
    if (da == 0) {
      // The new edge begins here on the side that the polygon leaves.
      out.front.corners.push_back(a);
      out.front.lines.push_back(db < 0 ? number : cell.lines[k]);
      out.back.corners.push_back(a);
      out.back.lines.push_back(db > 0 ? number : cell.lines[k]);
      continue;
    }
    PlanCell& own = da > 0 ? out.front : out.back;
    own.corners.push_back(a);
    own.lines.push_back(cell.lines[k]);
    if (da * db >= 0) continue;
    const double t = da / (da - db);
    const Vec2d middle{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
    out.front.corners.push_back(middle);
    out.front.lines.push_back(da > 0 ? number : cell.lines[k]);
    out.back.corners.push_back(middle);
    out.back.lines.push_back(da > 0 ? cell.lines[k] : number);
  }
  return out;
}

bool same(const Vec2d& a, const Vec2d& b, double least) {
  return std::abs(a.x - b.x) <= least && std::abs(a.y - b.y) <= least;
}

}  // namespace

PlanCells cut_plan(const Vec2d& low, const Vec2d& high, const std::vector<PlanLine>& lines) {
  const double least = kSame * std::max(high.x - low.x, high.y - low.y);
  PlanCells out;
  out.cells.push_back(
      {{low, {high.x, low.y}, high, {low.x, high.y}}, {kPlanBorder, kPlanBorder, kPlanBorder, kPlanBorder}});
  for (size_t number = 0; number < lines.size(); ++number) {
    std::vector<PlanCell> pieces;
    for (const PlanCell& cell : out.cells) {
      Halves halves = cut(cell, lines[number], static_cast<int>(number), least);
      for (PlanCell* half : {&halves.front, &halves.back}) {
        if (half->corners.size() >= 3) pieces.push_back(std::move(*half));
      }
    }
    out.cells = std::move(pieces);
  }
  const size_t count = out.cells.size();
  for (size_t i = 0; i < count; ++i) {
    const PlanCell& cell = out.cells[i];
    for (size_t k = 0; k < cell.corners.size(); ++k) {
      const Vec2d &a = cell.corners[k], &b = cell.corners[(k + 1) % cell.corners.size()];
      int other = -1;
      for (size_t j = 0; j < count && other < 0; ++j) {
        const PlanCell& beyond = out.cells[j];
        for (size_t m = 0; j != i && m < beyond.corners.size(); ++m) {
          if (same(beyond.corners[m], b, 4 * least) &&
              same(beyond.corners[(m + 1) % beyond.corners.size()], a, 4 * least))
            other = static_cast<int>(j);
        }
      }
      if (other < 0 || static_cast<size_t>(other) > i) out.sides.push_back({i, other, k});
    }
  }
  return out;
}

bool contains(const PlanCell& cell, const Vec2d& p) {
  for (size_t k = 0; k < cell.corners.size(); ++k) {
    const Vec2d &a = cell.corners[k], &b = cell.corners[(k + 1) % cell.corners.size()];
    if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) < 0) return false;
  }
  return true;
}

}  // namespace aligngs
