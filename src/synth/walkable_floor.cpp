#include "synth/walkable_floor.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr double kCell = 0.1;          // metres
constexpr double kBody = 0.24;         // half the width a person needs
constexpr double kWallDistance = 0.3;  // least distance of the camera from a wall
constexpr double kArm = 0.5;           // how far from the body a phone is held over low furniture
constexpr double kLow = 0.8;           // furniture lower than this can be reached over
constexpr double kClearance = 0.28;    // of the camera from tall furniture

double distance_to(const FurnitureFootprint& f, const Vec2d& p) {
  return std::hypot(std::max({f.x0 - p.x, 0.0, p.x - f.x1}), std::max({f.y0 - p.y, 0.0, p.y - f.y1}));
}

}  // namespace

WalkableFloor::WalkableFloor(const RoomModel& room) {
  columns_ = static_cast<int>(room.width / kCell);
  rows_ = static_cast<int>(room.depth / kCell);
  const size_t n = static_cast<size_t>(columns_) * rows_;
  std::vector<uint8_t> standing(n, 0), clear(n, 0);
  for (size_t i = 0; i < n; ++i) {
    const Vec2d p = centre_of(static_cast<int>(i));
    const double wall = std::min({p.x, p.y, room.width - p.x, room.depth - p.y});
    standing[i] = wall >= kBody;
    clear[i] = wall >= kWallDistance;
    for (const FurnitureFootprint& f : room.footprints) {
      const double d = distance_to(f, p);
      if (f.bottom < 1.0 && d < kBody) standing[i] = 0;
      if (f.top > kLow && d < kClearance) clear[i] = 0;  // hanging things count as well
    }
  }
  // The largest connected floor: a person cannot step over furniture.
  std::vector<int> component(n, -1);
  int best = -1;
  size_t best_size = 0;
  for (size_t start = 0; start < n; ++start) {
    if (!standing[start] || component[start] >= 0) continue;
    const int id = static_cast<int>(start);
    size_t size = 0;
    std::queue<int> queue;
    queue.push(id);
    component[start] = id;
    while (!queue.empty()) {
      const int c = queue.front();
      queue.pop();
      ++size;
      const int x = c % columns_, y = c / columns_;
      for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{-1, 0}, std::pair{0, 1}, std::pair{0, -1}}) {
        const int nx = x + dx, ny = y + dy;
        if (nx < 0 || ny < 0 || nx >= columns_ || ny >= rows_) continue;
        const int next = ny * columns_ + nx;
        if (standing[next] && component[next] < 0) component[next] = id, queue.push(next);
      }
    }
    if (size > best_size) best_size = size, best = id;
  }
  camera_.assign(n, 0);
  const int reach = static_cast<int>(kArm / kCell);
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      const size_t i = static_cast<size_t>(y) * columns_ + x;
      if (!clear[i]) continue;
      for (int dy = -reach; dy <= reach && !camera_[i]; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          const int nx = x + dx, ny = y + dy;
          if (nx < 0 || ny < 0 || nx >= columns_ || ny >= rows_ || dx * dx + dy * dy > reach * reach) continue;
          if (component[static_cast<size_t>(ny) * columns_ + nx] == best && best >= 0) camera_[i] = 1;
        }
      }
      if (camera_[i]) places_.push_back(centre_of(static_cast<int>(i)));
    }
  }
  if (places_.empty())
    throw Error({ErrorKind::kFailed, "the room has no free floor for the camera", {}, {}, "try another seed"});
}

int WalkableFloor::cell_of(const Vec2d& p) const {
  return static_cast<int>(p.y / kCell) * columns_ + static_cast<int>(p.x / kCell);
}

Vec2d WalkableFloor::centre_of(int cell) const {
  return {(cell % columns_ + 0.5) * kCell, (cell / columns_ + 0.5) * kCell};
}

std::vector<int> WalkableFloor::shortest_path(int from, int to) const {
  // Breadth first over eight neighbours; diagonal steps count alike, the walk is resampled afterwards.
  std::vector<int> previous(camera_.size(), -1);
  std::queue<int> queue;
  queue.push(from);
  previous[from] = from;
  while (!queue.empty() && previous[to] < 0) {
    const int c = queue.front();
    queue.pop();
    const int x = c % columns_, y = c / columns_;
    for (int k = 0; k < 8; ++k) {
      static constexpr int kDx[] = {1, -1, 0, 0, 1, 1, -1, -1}, kDy[] = {0, 0, 1, -1, 1, -1, 1, -1};
      const int nx = x + kDx[k], ny = y + kDy[k];
      if (nx < 0 || ny < 0 || nx >= columns_ || ny >= rows_) continue;
      const int next = ny * columns_ + nx;
      if (camera_[next] && previous[next] < 0) previous[next] = c, queue.push(next);
    }
  }
  std::vector<int> path;
  if (previous[to] < 0) return path;
  for (int c = to; c != from; c = previous[c]) path.push_back(c);
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<Vec2d> WalkableFloor::walk(int count, size_t first_place) const {
  // Stops: each as far as possible from those before it, visited in the order of their angle about the middle.
  constexpr int kStops = 7;
  std::vector<Vec2d> stops = {places_[first_place % places_.size()]};
  while (static_cast<int>(stops.size()) < kStops) {
    Vec2d farthest = stops[0];
    double best = -1;
    for (const Vec2d& p : places_) {
      double nearest = 1e9;
      for (const Vec2d& s : stops) nearest = std::min(nearest, std::hypot(p.x - s.x, p.y - s.y));
      if (nearest > best) best = nearest, farthest = p;
    }
    if (best < 0.4) break;
    stops.push_back(farthest);
  }
  Vec2d middle;
  for (const Vec2d& s : stops) {
    middle.x += s.x / static_cast<double>(stops.size());
    middle.y += s.y / static_cast<double>(stops.size());
  }
  std::sort(stops.begin(), stops.end(), [&](const Vec2d& a, const Vec2d& b) {
    return std::atan2(a.y - middle.y, a.x - middle.x) < std::atan2(b.y - middle.y, b.x - middle.x);
  });
  std::vector<Vec2d> line = {stops[0]};
  for (size_t i = 0; i < stops.size(); ++i) {
    for (const int cell : shortest_path(cell_of(stops[i]), cell_of(stops[(i + 1) % stops.size()]))) {
      line.push_back(centre_of(cell));
    }
  }
  std::vector<double> length(line.size(), 0.0);
  for (size_t i = 1; i < line.size(); ++i) {
    length[i] = length[i - 1] + std::hypot(line[i].x - line[i - 1].x, line[i].y - line[i - 1].y);
  }
  std::vector<Vec2d> out;
  size_t k = 0;
  for (int i = 0; i < count; ++i) {
    const double at = length.back() * i / count;
    while (k + 1 < line.size() && length[k + 1] < at) ++k;
    out.push_back(line[std::min(k + 1, line.size() - 1)]);
  }
  return out;
}

}  // namespace aligngs
