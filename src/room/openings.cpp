#include "room/openings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/disjoint_sets.h"

namespace aligngs {
namespace {

struct Rectangle {
  int left = 0, right = 0, bottom = 0, top = 0;  // squares; right and top are excluded
};

size_t number(OpeningKind kind) { return static_cast<size_t>(kind); }

struct Mask {
  int columns = 0, rows = 0;
  std::vector<uint8_t> own, seen;
  size_t index(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
  }
};

Mask mask_of(const WallVotes& votes, OpeningKind kind, double agreement) {
  Mask mask{votes.columns, votes.rows, std::vector<uint8_t>(votes.wall.size()),
            std::vector<uint8_t>(votes.wall.size())};
  const bool hole = kind == OpeningKind::kDoor || kind == OpeningKind::kWindow;
  for (size_t i = 0; i < votes.wall.size(); ++i) {
    const float all = votes.total(i), named = votes.kinds[number(kind)][i];
    mask.seen[i] = all > 0;
    // The niche of a window and the room behind a door are seen through the wall.
    const float own = named + (hole ? votes.beyond[i] : 0);
    mask.own[i] = all > 0 && own > agreement * all && (named > 0 || hole);
  }
  return mask;
}

/// Groups of squares of the kind, joined over gaps.
std::vector<Rectangle> groups(const Mask& mask, int gap) {
  DisjointSets sets(mask.own.size());
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.columns; ++x) {
      if (!mask.own[mask.index(x, y)]) continue;
      for (int d = 1; d <= gap + 1; ++d) {
        if (x + d < mask.columns && mask.own[mask.index(x + d, y)])
          sets.unite(static_cast<uint32_t>(mask.index(x, y)), static_cast<uint32_t>(mask.index(x + d, y)));
        if (y + d < mask.rows && mask.own[mask.index(x, y + d)])
          sets.unite(static_cast<uint32_t>(mask.index(x, y)), static_cast<uint32_t>(mask.index(x, y + d)));
      }
    }
  }
  std::map<uint32_t, Rectangle> boxes;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.columns; ++x) {
      if (!mask.own[mask.index(x, y)]) continue;
      const auto [at, fresh] =
          boxes.try_emplace(sets.find(static_cast<uint32_t>(mask.index(x, y))), Rectangle{x, x + 1, y, y + 1});
      Rectangle& r = at->second;
      r = {std::min(r.left, x), std::max(r.right, x + 1), std::min(r.bottom, y), std::max(r.top, y + 1)};
    }
  }
  std::vector<Rectangle> out;
  for (const auto& [root, r] : boxes) out.push_back(r);
  return out;
}

/// Share of the seen squares of a part that are of the kind; 0 where nothing is seen.
double filled(const Mask& mask, const Rectangle& r, size_t* count = nullptr) {
  size_t own = 0, seen = 0;
  for (int y = r.bottom; y < r.top; ++y) {
    for (int x = r.left; x < r.right; ++x) {
      own += mask.own[mask.index(x, y)];
      seen += mask.seen[mask.index(x, y)];
    }
  }
  if (count) *count = seen;
  return seen == 0 ? 0 : static_cast<double>(own) / static_cast<double>(seen);
}

/// Draws in the side with the smallest share until every side has enough.
Rectangle drawn_in(const Mask& mask, Rectangle r, double share) {
  while (r.right - r.left > 1 && r.top - r.bottom > 1) {
    const Rectangle sides[4] = {{r.left, r.left + 1, r.bottom, r.top},
                                {r.right - 1, r.right, r.bottom, r.top},
                                {r.left, r.right, r.bottom, r.bottom + 1},
                                {r.left, r.right, r.top - 1, r.top}};
    int worst = 0;
    double least = 2;
    for (int k = 0; k < 4; ++k) {
      const double own = filled(mask, sides[k]);
      if (own < least) least = own, worst = k;
    }
    if (least >= share) break;
    if (worst == 0)
      ++r.left;
    else if (worst == 1)
      --r.right;
    else if (worst == 2)
      ++r.bottom;
    else
      --r.top;
  }
  return r;
}

/// Sum of a map over a rectangle.
double sum_in(const WallVotes& votes, const std::vector<float>& map, const Rectangle& r) {
  double sum = 0;
  for (int y = r.bottom; y < r.top; ++y) {
    for (int x = r.left; x < r.right; ++x) sum += map[votes.index(x, y)];
  }
  return sum;
}

/// Pictures and mirrors that lie in a niche are windows: their votes become votes for the first class of windows.
WallVotes with_windows_in_niches(WallVotes votes, const LabelSet& labels, const OpeningSettings& s) {
  const std::vector<RoomClass> classes = room_classes(labels);
  const auto window = std::find_if(classes.begin(), classes.end(),
                                   [](const RoomClass& c) { return c.opening == OpeningKind::kWindow; });
  if (window == classes.end()) return votes;
  for (const OpeningKind kind : {OpeningKind::kPicture, OpeningKind::kMirror}) {
    std::vector<float>& own = votes.kinds[number(kind)];
    for (const Rectangle& r : groups(mask_of(votes, kind, s.agreement), s.gap)) {
      const double depth = sum_in(votes, votes.depth[number(kind)], r) / sum_in(votes, own, r);
      if (!(depth > s.niche && depth < s.deepest_niche)) continue;
      for (int y = r.bottom; y < r.top; ++y) {
        for (int x = r.left; x < r.right; ++x) {
          const size_t i = votes.index(x, y);
          if (own[i] > 0) votes.labels[i] = static_cast<int>(window - classes.begin());
          votes.kinds[number(OpeningKind::kWindow)][i] += own[i];
          own[i] = 0;
        }
      }
    }
  }
  return votes;
}

/// The class that most votes of the kind in a rectangle have, and whether there are any.
int class_in(const WallVotes& votes, OpeningKind kind, const Rectangle& r, double& share) {
  std::map<int, double> by_class;
  double named = 0, all = 0;
  for (int y = r.bottom; y < r.top; ++y) {
    for (int x = r.left; x < r.right; ++x) {
      const size_t i = votes.index(x, y);
      const float own = votes.kinds[number(kind)][i];
      named += own;
      all += votes.total(i);
      if (own > 0 && votes.labels[i] >= 0) by_class[votes.labels[i]] += own;
    }
  }
  share = all > 0 ? named / all : 0;
  int best = -1;
  for (const auto& [label, weight] : by_class) {
    if (best < 0 || weight > by_class[best]) best = label;
  }
  return best;
}

}  // namespace

std::vector<MeasuredOpening> find_openings(const WallVotes& counted, int wall, const LabelSet& labels,
                                           const OpeningSettings& s) {
  const WallVotes votes = with_windows_in_niches(counted, labels, s);
  std::vector<MeasuredOpening> out;
  for (const OpeningKind kind :
       {OpeningKind::kDoor, OpeningKind::kWindow, OpeningKind::kPicture, OpeningKind::kMirror}) {
    const Mask mask = mask_of(votes, kind, s.agreement);
    std::vector<MeasuredOpening> own;
    for (const Rectangle& group : groups(mask, s.gap)) {
      const Rectangle r = drawn_in(mask, group, s.side_share);
      const double width = (r.right - r.left) * votes.cell, height = (r.top - r.bottom) * votes.cell;
      if (width < s.least_side || height < s.least_side || width * height < s.least_area) continue;
      size_t seen = 0;
      double share = 0;
      if (filled(mask, r, &seen) < s.least_filled) continue;
      const int label = class_in(votes, kind, r, share);
      // A place that is only seen through belongs to the kind that is named there.
      if (label < 0 || label >= labels.size() || share < s.least_filled / 2) continue;
      MeasuredOpening o;
      o.kind = kind;
      o.class_name = labels.classes[static_cast<size_t>(label)].name;
      o.wall = wall;
      o.left = r.left * votes.cell;
      o.right = r.right * votes.cell;
      o.bottom = r.bottom * votes.cell;
      o.top = r.top * votes.cell;
      if (kind == OpeningKind::kDoor && o.bottom < s.snap_to_floor) o.bottom = 0;
      o.seen = static_cast<double>(seen) / static_cast<double>((r.right - r.left) * (r.top - r.bottom));
      o.confidence = share;
      own.push_back(o);
    }
    std::stable_sort(own.begin(), own.end(), [](const MeasuredOpening& a, const MeasuredOpening& b) {
      return (a.right - a.left) * (a.top - a.bottom) > (b.right - b.left) * (b.top - b.bottom);
    });
    out.insert(out.end(), own.begin(), own.end());
  }
  return out;
}

}  // namespace aligngs
