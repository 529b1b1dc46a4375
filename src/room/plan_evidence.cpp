#include "room/plan_evidence.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

RoomClass class_of(uint16_t label, const std::vector<RoomClass>& classes) {
  return label < classes.size() ? classes[label] : RoomClass{};
}

double along(const PlanLine& line, const Vec2d& p) { return -line.normal.y * p.x + line.normal.x * p.y; }

Vec2d flat(const Vec3d& p) { return {p.x, p.y}; }

}  // namespace

FreeSpace free_space(const Vec2d& low, const Vec2d& high, const std::vector<SeenRay>& rays,
                     const std::vector<RoomClass>& classes, const PlanEvidenceSettings& s) {
  FreeSpace out{low,
                s.cell,
                static_cast<int>(std::ceil((high.x - low.x) / s.cell)),
                static_cast<int>(std::ceil((high.y - low.y) / s.cell)),
                {}};
  out.free.assign(static_cast<size_t>(out.columns) * static_cast<size_t>(out.rows), 0);
  for (const SeenRay& ray : rays) {
    if (class_of(ray.label, classes).glass) continue;
    const Vec2d a = flat(ray.from), b = flat(ray.to);
    const double length = std::hypot(b.x - a.x, b.y - a.y), end = length - s.before_surface;
    for (double t = 0; t < end; t += 0.7 * s.cell) {
      const int x = static_cast<int>(std::floor((a.x + (b.x - a.x) * t / length - low.x) / s.cell));
      const int y = static_cast<int>(std::floor((a.y + (b.y - a.y) * t / length - low.y) / s.cell));
      if (x < 0 || y < 0 || x >= out.columns || y >= out.rows) continue;
      out.free[static_cast<size_t>(y) * static_cast<size_t>(out.columns) + static_cast<size_t>(x)] = 1;
    }
  }
  return out;
}

std::vector<LineEvidence> line_evidence(const std::vector<PlanLine>& lines, const Vec2d& low, const Vec2d& high,
                                        const std::vector<SeenRay>& rays, const std::vector<RoomClass>& classes,
                                        const PlanEvidenceSettings& s) {
  std::vector<LineEvidence> out;
  for (const PlanLine& line : lines) {
    LineEvidence e;
    e.cell = s.cell;
    double first = 1e300, last = -1e300;
    for (const Vec2d& corner : {low, Vec2d{high.x, low.y}, high, Vec2d{low.x, high.y}}) {
      first = std::min(first, along(line, corner));
      last = std::max(last, along(line, corner));
    }
    e.begin = first;
    const size_t bins = static_cast<size_t>(std::ceil((last - first) / s.cell)) + 1;
    e.wall.assign(bins, 0);
    e.crossed.assign(bins, 0);
    for (const SeenRay& ray : rays) {
      const RoomClass c = class_of(ray.label, classes);
      const double da = line.distance(flat(ray.from)), db = line.distance(flat(ray.to));
      const bool wall = c.wall || c.opening;
      // A pane counts where its ray enters it, and as no evidence of what is farther.
      const double reach = c.glass ? s.glass : s.on_wall;
      const bool on = wall && da > 0 && std::abs(db) < reach;
      const bool crosses = !c.glass && da * db < 0 && std::abs(db) > s.least_beyond;
      if (!on && !crosses) continue;
      const double t = da * db < 0 ? da / (da - db) : 1;
      const double at = along(line, flat(ray.from)) * (1 - t) + along(line, flat(ray.to)) * t;
      const double bin = std::floor((at - e.begin) / s.cell);
      if (!(bin >= 0 && bin < static_cast<double>(bins))) continue;
      (on ? e.wall : e.crossed)[static_cast<size_t>(bin)] += 1;
    }
    out.push_back(std::move(e));
  }
  return out;
}

SideEvidence evidence_between(const PlanLine& line, const LineEvidence& evidence, const Vec2d& a, const Vec2d& b) {
  double first = along(line, a), last = along(line, b);
  if (first > last) std::swap(first, last);
  SideEvidence out;
  for (size_t bin = 0; bin < evidence.wall.size(); ++bin) {
    const double from = evidence.begin + evidence.cell * static_cast<double>(bin);
    const double inside = std::min(last, from + evidence.cell) - std::max(first, from);
    if (inside <= 0) continue;
    const double wall = evidence.wall[bin], crossed = evidence.crossed[bin];
    (wall + crossed == 0 ? out.unknown : wall >= crossed ? out.wall : out.crossed) += inside;
  }
  return out;
}

}  // namespace aligngs
