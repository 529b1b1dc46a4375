#include "room/outline.h"

#include <algorithm>
#include <cmath>

#include "room/min_cut.h"

namespace aligngs {
namespace {

struct Box {
  Vec2d low, high;
};

/// Box of the surfaces that photos show, but for panes, mirrors and the strays on each side; cameras are in it.
Box box_of(const std::vector<SeenRay>& rays, const std::vector<RoomClass>& classes, double quantile) {
  std::vector<double> x, y;
  Box box{{1e300, 1e300}, {-1e300, -1e300}};
  const auto take_in = [&box](const Vec2d& p) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
  };
  for (const SeenRay& ray : rays) {
    take_in({ray.from.x, ray.from.y});
    if (ray.label < classes.size() && classes[ray.label].glass) continue;
    x.push_back(ray.to.x);
    y.push_back(ray.to.y);
  }
  if (x.empty()) return box;
  std::sort(x.begin(), x.end());
  std::sort(y.begin(), y.end());
  const size_t tail = static_cast<size_t>(quantile * static_cast<double>(x.size()));
  take_in({x[tail], y[tail]});
  take_in({x[x.size() - 1 - tail], y[y.size() - 1 - tail]});
  return box;
}

/// Lines along the sides of the box that no wall closes.
void close_with_box(std::vector<PlanLine>& lines, const Box& box, double near) {
  const PlanLine sides[4] = {
      {{1, 0}, -box.low.x, true}, {{-1, 0}, box.high.x, true}, {{0, 1}, -box.low.y, true}, {{0, -1}, box.high.y, true}};
  const Vec2d middle{(box.low.x + box.high.x) / 2, (box.low.y + box.high.y) / 2};
  const size_t walls = lines.size();
  for (const PlanLine& side : sides) {
    // A wall closes a side when it faces the same way and lies at the side or beyond.
    const double there = side.distance(middle);
    const bool closed =
        std::any_of(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(walls), [&](const PlanLine& line) {
          return line.normal.x * side.normal.x + line.normal.y * side.normal.y > 0.9 &&
                 line.distance(middle) > there - near;
        });
    if (!closed) lines.push_back(side);
  }
}

double cost_of(const SideEvidence& e, const RoomOutlineSettings& s) {
  return e.wall * s.along_wall + e.unknown * s.along_unknown + e.crossed * s.along_crossed;
}

std::vector<uint8_t> choose_inside(const PlanCells& plan, const std::vector<PlanLine>& lines,
                                   const std::vector<LineEvidence>& evidence, const FreeSpace& space,
                                   const RoomOutlineSettings& s) {
  MinCut graph(plan.cells.size());
  const double square = space.cell * space.cell;
  for (size_t i = 0; i < plan.cells.size(); ++i) {
    size_t free = 0, hidden = 0;
    for (int y = 0; y < space.rows; ++y) {
      for (int x = 0; x < space.columns; ++x) {
        if (!contains(plan.cells[i], {space.low.x + (x + 0.5) * space.cell, space.low.y + (y + 0.5) * space.cell}))
          continue;
        ++(space.free[static_cast<size_t>(y) * static_cast<size_t>(space.columns) + static_cast<size_t>(x)] ? free
                                                                                                            : hidden);
      }
    }
    graph.add_node_costs(i, s.hidden_area * square * static_cast<double>(hidden), square * static_cast<double>(free));
  }
  for (const PlanSide& side : plan.sides) {
    const PlanCell& cell = plan.cells[side.cell];
    const Vec2d &a = cell.corners[side.edge], &b = cell.corners[(side.edge + 1) % cell.corners.size()];
    const int line = cell.lines[side.edge];
    if (side.other < 0 || line == kPlanBorder) {
      graph.add_node_costs(side.cell, s.along_unknown * std::hypot(b.x - a.x, b.y - a.y), 0);
      continue;
    }
    graph.add_edge_cost(side.cell, static_cast<size_t>(side.other),
                        cost_of(evidence_between(lines[line], evidence[line], a, b), s));
  }
  return graph.solve();
}

struct Edge {
  Vec2d from, to;
  int line = kPlanBorder;
};

bool near(const Vec2d& a, const Vec2d& b, double least) {
  return std::abs(a.x - b.x) <= least && std::abs(a.y - b.y) <= least;
}

/// Closed chains of edges with the inside on their left. At a corner where two parts of the inside touch, the sharpest
/// turn to the left keeps them apart.
std::vector<std::vector<Edge>> chains_of(std::vector<Edge> edges, double least) {
  std::vector<std::vector<Edge>> out;
  while (!edges.empty()) {
    std::vector<Edge> chain = {edges.back()};
    edges.pop_back();
    while (!near(chain.back().to, chain.front().from, least)) {
      const Edge& last = chain.back();
      size_t best = edges.size();
      double sharpest = -10;
      for (size_t i = 0; i < edges.size(); ++i) {
        if (!near(edges[i].from, last.to, least)) continue;
        const double ax = last.to.x - last.from.x, ay = last.to.y - last.from.y, bx = edges[i].to.x - edges[i].from.x,
                     by = edges[i].to.y - edges[i].from.y;
        const double turn = std::atan2(ax * by - ay * bx, ax * bx + ay * by);
        if (turn > sharpest) sharpest = turn, best = i;
      }
      if (best == edges.size()) break;  // not closed: rounding; the chain is dropped below
      chain.push_back(edges[best]);
      edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(best));
    }
    if (chain.size() >= 3 && near(chain.back().to, chain.front().from, least)) out.push_back(std::move(chain));
  }
  return out;
}

double area_of(const std::vector<Edge>& chain) {
  std::vector<Vec2d> corners;
  for (const Edge& e : chain) corners.push_back(e.from);
  return signed_area(corners);
}

double length_of(const Edge& e) { return std::hypot(e.to.x - e.from.x, e.to.y - e.from.y); }

bool parallel(const PlanLine& a, const PlanLine& b) {
  return a.normal.x * b.normal.x + a.normal.y * b.normal.y > 0.999;
}

/// Consecutive edges of one line become one; a short side between two that face the same way goes, with the lesser of
/// the two lines.
std::vector<Edge> simplified(std::vector<Edge> chain, const std::vector<PlanLine>& lines, double least_side) {
  const auto at = [&chain](size_t i) -> Edge& { return chain[i % chain.size()]; };
  bool changed = true;
  while (changed && chain.size() > 3) {
    changed = false;
    for (size_t i = 0; i < chain.size() && !changed; ++i) {
      Edge &a = at(i), &b = at(i + 1), &c = at(i + 2);
      if (a.line == b.line) {
        a.to = b.to;
        chain.erase(chain.begin() + static_cast<std::ptrdiff_t>((i + 1) % chain.size()));
        changed = true;
      } else if (a.line != kPlanBorder && c.line != kPlanBorder && chain.size() > 4 && length_of(b) < least_side &&
                 parallel(lines[a.line], lines[c.line])) {
        const int kept = length_of(a) >= length_of(c) ? a.line : c.line;
        a.line = c.line = kept;
        b.line = kept;
        changed = true;
      }
    }
  }
  return chain;
}

/// Corner of two lines, or `fallback` where they are nearly parallel.
Vec2d corner(const PlanLine& a, const PlanLine& b, const Vec2d& fallback) {
  const double det = a.normal.x * b.normal.y - a.normal.y * b.normal.x;
  if (std::abs(det) < 0.05) return fallback;
  return {(-a.offset * b.normal.y + b.offset * a.normal.y) / det,
          (-a.normal.x * b.offset + b.normal.x * a.offset) / det};
}

}  // namespace

std::vector<OutlineSide> find_outline(std::vector<PlanLine> lines, const std::vector<SeenRay>& rays,
                                      const std::vector<RoomClass>& classes, const RoomOutlineSettings& s) {
  if (rays.empty()) return {};
  if (lines.size() > static_cast<size_t>(s.most_lines)) lines.resize(static_cast<size_t>(s.most_lines));
  const Box box = box_of(rays, classes, s.box_quantile);
  close_with_box(lines, box, s.near_box);
  const Vec2d low{box.low.x - s.margin, box.low.y - s.margin}, high{box.high.x + s.margin, box.high.y + s.margin};
  const PlanCells plan = cut_plan(low, high, lines);
  const std::vector<LineEvidence> evidence = line_evidence(lines, low, high, rays, classes, s.evidence);
  const std::vector<uint8_t> inside =
      choose_inside(plan, lines, evidence, free_space(low, high, rays, classes, s.evidence), s);

  std::vector<Edge> edges;
  for (const PlanSide& side : plan.sides) {
    const bool in = inside[side.cell], beyond = side.other >= 0 && inside[static_cast<size_t>(side.other)];
    if (in == beyond) continue;
    const PlanCell& cell = plan.cells[side.cell];
    const Vec2d &a = cell.corners[side.edge], &b = cell.corners[(side.edge + 1) % cell.corners.size()];
    edges.push_back(in ? Edge{a, b, cell.lines[side.edge]} : Edge{b, a, cell.lines[side.edge]});
  }
  const double least = 1e-5 * std::max(high.x - low.x, high.y - low.y);
  std::vector<Edge> chain;
  for (std::vector<Edge>& c : chains_of(std::move(edges), least)) {
    if (chain.empty() || area_of(c) > area_of(chain)) chain = std::move(c);
  }
  if (chain.empty() || area_of(chain) <= 0) return {};
  chain = simplified(std::move(chain), lines, s.least_side);

  std::vector<OutlineSide> out;
  for (const Edge& e : chain) {
    PlanLine line;
    if (e.line != kPlanBorder) line = lines[static_cast<size_t>(e.line)];
    const double length = length_of(e);
    const Vec2d left{-(e.to.y - e.from.y) / length, (e.to.x - e.from.x) / length};
    if (e.line == kPlanBorder) line.assumed = true;
    // The border's, and a wall that was seen from its other side, turned into the room.
    if (e.line == kPlanBorder || line.normal.x * left.x + line.normal.y * left.y < 0) {
      line.normal = left;
      line.offset = -(left.x * e.from.x + left.y * e.from.y);
    }
    out.push_back(
        {line, e.from, e.to,
         e.line == kPlanBorder ? SideEvidence{} : evidence_between(lines[e.line], evidence[e.line], e.from, e.to)});
  }
  for (size_t i = 0; i < out.size(); ++i) {
    OutlineSide& next = out[(i + 1) % out.size()];
    out[i].to = next.from = corner(out[i].line, next.line, out[i].to);
  }
  return out;
}

}  // namespace aligngs
