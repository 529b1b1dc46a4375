#include "room/wall_votes.h"

#include <cmath>

#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr double kMostSquares = 4e6;  // a wall of 40 m x 40 m: more is an error of its planes

struct WallFrame {
  Vec2d from, along;
  Vec3d normal;
  double length = 0, height = 0;
};

WallFrame frame_of(const MeasuredWall& wall) {
  const double length = wall.length();
  return {wall.from,
          {(wall.to.x - wall.from.x) / length, (wall.to.y - wall.from.y) / length},
          wall.normal,
          length,
          wall.height};
}

/// The point where a ray meets a wall from its front: the share of its length, and the place on the wall.
struct Meeting {
  double t = 0, along = 0, height = 0;
};

bool meet(const WallFrame& wall, const SeenRay& ray, double reach, Meeting& out) {
  const auto distance = [&wall](const Vec3d& p) {
    return wall.normal.x * (p.x - wall.from.x) + wall.normal.y * (p.y - wall.from.y);
  };
  const double da = distance(ray.from), db = distance(ray.to);
  if (da <= 0 || da - db <= 0) return false;
  out.t = da / (da - db);
  // A ray that ends far before the wall is not followed.
  if (db > reach) return false;
  const Vec3d p = ray.from + (ray.to - ray.from) * out.t;
  out.along = (p.x - wall.from.x) * wall.along.x + (p.y - wall.from.y) * wall.along.y;
  out.height = p.z;
  return out.along >= 0 && out.along < wall.length && out.height >= 0 && out.height < wall.height;
}

void vote(WallVotes& votes, const SeenRay& ray, const RoomClass& c, double behind, const Meeting& m,
          const WallVoteSettings& s) {
  const int column = static_cast<int>(m.along / votes.cell), row = static_cast<int>(m.height / votes.cell);
  if (column >= votes.columns || row >= votes.rows) return;
  const size_t i = votes.index(column, row);
  const bool standing = c.opening && !c.glass;
  if (behind < -(standing ? s.proud : s.on_wall)) return;  // something hides the wall
  if (c.opening && (c.glass || behind < s.proud)) {
    votes.kinds[static_cast<size_t>(*c.opening)][i] += 1;
    votes.labels[i] = ray.label;
    votes.depth[static_cast<size_t>(*c.opening)][i] += static_cast<float>(behind);
  } else if (behind > s.beyond) {
    votes.beyond[i] += 1;
  } else if (c.wall) {
    votes.wall[i] += 1;
  } else if (ray.label != kNoLabel && !c.floor && !c.ceiling) {
    // Something flat against the wall: it is no opening, and the wall is not seen either.
    votes.wall[i] += 0.5f;
  }
}

}  // namespace

std::vector<WallVotes> wall_votes(const std::vector<MeasuredWall>& walls, const std::vector<SeenRay>& rays,
                                  const std::vector<RoomClass>& classes, const WallVoteSettings& s) {
  std::vector<WallVotes> out(walls.size());
  std::vector<WallFrame> frames;
  for (size_t w = 0; w < walls.size(); ++w) {
    frames.push_back(frame_of(walls[w]));
    const double columns = std::ceil(frames[w].length / s.cell), rows = std::ceil(frames[w].height / s.cell);
    out[w].cell = s.cell;
    if (!(columns * rows <= kMostSquares)) continue;
    out[w].columns = static_cast<int>(columns);
    out[w].rows = static_cast<int>(rows);
    const size_t squares = static_cast<size_t>(columns) * static_cast<size_t>(rows);
    for (auto& kind : out[w].kinds) kind.assign(squares, 0);
    for (auto& kind : out[w].depth) kind.assign(squares, 0);
    out[w].wall.assign(squares, 0);
    out[w].beyond.assign(squares, 0);
    out[w].labels.assign(squares, -1);
  }
  for (const SeenRay& ray : rays) {
    const RoomClass c = ray.label < classes.size() ? classes[ray.label] : RoomClass{};
    size_t first = walls.size();
    Meeting nearest;
    for (size_t w = 0; w < walls.size(); ++w) {
      Meeting m;
      if (out[w].columns == 0 || !meet(frames[w], ray, c.opening ? s.proud : s.on_wall, m)) continue;
      if (first < walls.size() && m.t >= nearest.t) continue;
      first = w;
      nearest = m;
    }
    if (first == walls.size()) continue;
    const Vec3d& n = frames[first].normal;
    const double behind = -(n.x * (ray.to.x - frames[first].from.x) + n.y * (ray.to.y - frames[first].from.y));
    vote(out[first], ray, c, behind, nearest, s);
  }
  return out;
}

double seen_share(const WallVotes& votes) {
  size_t seen = 0;
  const size_t squares = votes.wall.size();
  for (int row = 0; row < votes.rows; ++row) {
    for (int column = 0; column < votes.columns; ++column) {
      bool any = false;
      for (int dy = -1; dy <= 1 && !any; ++dy) {
        for (int dx = -1; dx <= 1 && !any; ++dx) {
          const int x = column + dx, y = row + dy;
          any = x >= 0 && y >= 0 && x < votes.columns && y < votes.rows && votes.total(votes.index(x, y)) > 0;
        }
      }
      seen += any;
    }
  }
  return squares == 0 ? 0 : static_cast<double>(seen) / static_cast<double>(squares);
}

}  // namespace aligngs
