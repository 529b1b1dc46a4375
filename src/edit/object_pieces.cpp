#include "edit/object_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "core/perpendicular.h"
#include "edit/object_rows.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/instances.h"
#include "gaussians/point_tree.h"

namespace aligngs {
namespace {

/// Furniture that has a foot, legs or floors of its own. A stove above an oven is two things, and so are two cabinets.
constexpr const char* kWithPieces[] = {"bed", "sofa", "stool", "table", "coffee table", "desk", "bookcase"};
/// Classes that photos take for each other: a piece of one of them joins an object of another.
const std::vector<std::vector<const char*>> kAlike = {{"lamp", "light", "sconce", "chandelier"},
                                                      {"chair", "armchair", "swivel chair"}};

/// Furniture that bedding divides, and the bedding.
constexpr const char* kBridged[] = {"bed", "sofa"};
constexpr const char* kBridges[] = {"blanket", "pillow", "cushion"};

struct Piece {
  uint16_t label = kNoLabel, instance = 0;  ///< those of the object that it is a part of
  std::vector<uint32_t> rows;
};

struct PieceBox {
  double low[2] = {0, 0}, high[2] = {0, 0};
  bool holds(double u, double v, double margin) const {
    return u > low[0] - margin && u < high[0] + margin && v > low[1] - margin && v < high[1] + margin;
  }
};

class PieceSearch {
 public:
  PieceSearch(const LabelledGaussians& room, const Vec3d& up, const ObjectPieceSettings& settings)
      : room_(room), settings_(settings) {
    u_ = perpendicular_to(up);
    v_ = cross(up, u_);
  }

  /// Seen from above, without strays.
  PieceBox outline(const std::vector<uint32_t>& rows) const {
    PieceBox box;
    const Vec3d axes[2] = {u_, v_};
    for (int a = 0; a < 2; ++a) {
      std::vector<double> values;
      for (const uint32_t i : rows) values.push_back(dot(axes[a], position_of(room_.model, i)));
      std::sort(values.begin(), values.end());
      const size_t stray = static_cast<size_t>(settings_.strays * static_cast<double>(values.size()));
      box.low[a] = values[stray];
      box.high[a] = values[values.size() - 1 - stray];
    }
    return box;
  }
  /// Share of the piece in the vertical column of an outline.
  double share_within(const std::vector<uint32_t>& piece, const PieceBox& box) const {
    const auto count = std::count_if(piece.begin(), piece.end(), [&](uint32_t i) {
      const Vec3d p = position_of(room_.model, i);
      return box.holds(dot(u_, p), dot(v_, p), settings_.outside * room_.extent);
    });
    return static_cast<double>(count) / static_cast<double>(piece.size());
  }
  /// From a share of the nearest Gaussians of the piece to the object, scene units.
  double gap(const std::vector<uint32_t>& piece, const PointTree& object, double share) const {
    std::vector<PointTree::Neighbour> near;
    std::vector<float> distances;
    for (const uint32_t i : piece) {
      object.nearest(position_of(room_.model, i).cast<float>(), 1, near);
      distances.push_back(near.front().distance);
    }
    const size_t rank = static_cast<size_t>(share * static_cast<double>(distances.size()));
    const auto at = distances.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(distances.begin(), at, distances.end());
    return static_cast<double>(*at);
  }
  /// Distance of a piece from the object that it belongs to; empty where it is a thing of its own.
  std::optional<double> distance(const Piece& piece, const Piece& object, const PointTree& tree) const {
    constexpr double kHalf = 0.5;
    const double gap_here = gap(piece.rows, tree, settings_.nearest);
    const bool is_small =
        static_cast<double>(piece.rows.size()) <= settings_.most * static_cast<double>(object.rows.size());
    const bool in_column = is_small && gap_here < settings_.gap * room_.extent &&
                           share_within(piece.rows, outline(object.rows)) >= settings_.column;
    const bool touches = piece.label != object.label && gap_here < settings_.touch * room_.extent &&
                         gap(piece.rows, tree, kHalf) < settings_.thick * room_.extent;
    return in_column || touches ? std::optional<double>(gap_here) : std::nullopt;
  }
  /// Whether one of the bridges touches both.
  bool is_bridged(const PointTree& piece, const PointTree& object,
                  const std::vector<std::vector<uint32_t>>& bridges) const {
    const double most = settings_.bridge * room_.extent;
    return std::any_of(bridges.begin(), bridges.end(), [&](const std::vector<uint32_t>& bridge) {
      return gap(bridge, piece, settings_.nearest) < most && gap(bridge, object, settings_.nearest) < most;
    });
  }
  PointTree tree_of(const std::vector<uint32_t>& rows) const {
    std::vector<Vec3f> points;
    for (const uint32_t i : rows) points.push_back(position_of(room_.model, i).cast<float>());
    return PointTree(std::move(points));
  }

 private:
  const LabelledGaussians& room_;
  const ObjectPieceSettings& settings_;
  Vec3d u_, v_;  ///< horizontal
};

/// For each class the first one of those like it; kNoLabel for classes without pieces.
std::vector<uint16_t> kinds_with_pieces(const LabelSet& labels) {
  std::vector<uint16_t> out(labels.classes.size(), kNoLabel);
  for (const char* name : kWithPieces) {
    if (const int index = labels.find(name); index >= 0) out[static_cast<size_t>(index)] = static_cast<uint16_t>(index);
  }
  for (const std::vector<const char*>& alike : kAlike) {
    const int first = labels.find(alike.front());
    for (const char* name : alike) {
      const int index = labels.find(name);
      if (index >= 0) out[static_cast<size_t>(index)] = static_cast<uint16_t>(first >= 0 ? first : index);
    }
  }
  return out;
}

/// The objects of each kind, the largest first.
std::map<uint16_t, std::vector<Piece>> pieces_of(const LabelledGaussians& room, const std::vector<uint16_t>& kinds) {
  std::map<uint16_t, std::vector<Piece>> out;
  for (auto& [name, rows] : rows_of_objects(room.labels)) {
    const auto [label, instance] = name;
    if (label < kinds.size() && kinds[label] != kNoLabel && instance)
      out[kinds[label]].push_back({label, instance, std::move(rows)});
  }
  for (auto& [kind, pieces] : out) {
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const Piece& a, const Piece& b) { return a.rows.size() > b.rows.size(); });
  }
  return out;
}

template <class Names>
bool is_named(const LabelSet& labels, uint16_t label, const Names& names) {
  return std::any_of(std::begin(names), std::end(names), [&](const char* name) { return labels.find(name) == label; });
}

/// Rows of the objects that lie on others.
std::vector<std::vector<uint32_t>> bridges_of(const LabelledGaussians& room, const LabelSet& labels) {
  std::vector<std::vector<uint32_t>> out;
  for (auto& [name, rows] : rows_of_objects(room.labels)) {
    if (name.second && is_named(labels, name.first, kBridges)) out.push_back(std::move(rows));
  }
  return out;
}

}  // namespace

size_t join_object_pieces(LabelledGaussians& room, const LabelSet& labels, const std::optional<Vec3d>& up,
                          const ObjectPieceSettings& settings) {
  if (!up || !room.has_labels()) return 0;
  const PieceSearch search(room, *up, settings);
  const std::vector<std::vector<uint32_t>> bridges = bridges_of(room, labels);
  size_t joined = 0;
  for (auto& [kind, pieces] : pieces_of(room, kinds_with_pieces(labels))) {
    std::vector<PointTree> trees;
    const bool may_be_bridged = is_named(labels, kind, kBridged);
    for (size_t k = 0; k < pieces.size(); ++k) {
      Piece& piece = pieces[k];
      trees.push_back(search.tree_of(piece.rows));
      const Piece* best = nullptr;
      double least = std::numeric_limits<double>::infinity();
      for (size_t o = 0; o < k; ++o) {
        const std::optional<double> distance = search.distance(piece, pieces[o], trees[o]);
        const bool bridged = may_be_bridged && !distance && search.is_bridged(trees[k], trees[o], bridges);
        if (!(distance || bridged) || distance.value_or(0) >= least) continue;
        least = distance.value_or(0);
        best = &pieces[o];
      }
      if (!best) continue;
      piece.label = best->label;
      piece.instance = best->instance;
      for (const uint32_t i : piece.rows) {
        room.labels.label[i] = piece.label;
        room.labels.instance[i] = piece.instance;
      }
      ++joined;
    }
  }
  return joined;
}

}  // namespace aligngs
