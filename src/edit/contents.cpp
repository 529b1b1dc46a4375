#include "edit/contents.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/perpendicular.h"
#include "edit/fill/carrying_classes.h"
#include "edit/fill/plane_rectangle.h"
#include "edit/object_rows.h"
#include "edit/relation/class_groups.h"
#include "edit/row_flags.h"
#include "edit/taken_objects.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

using Column = std::pair<int, int>;

/// The solid Gaussians of the room in upright columns.
class Columns {
 public:
  Columns(const GaussianModel& model, const Vec3d& up, double edge) : up_(up), edge_(edge) {
    u_ = perpendicular_to(up);
    v_ = cross(up, u_);
    for (uint32_t i = 0; i < model.size(); ++i) {
      const Vec3d p = position_of(model, i);
      places_.push_back(
          {{static_cast<int>(std::floor(dot(u_, p) / edge_)), static_cast<int>(std::floor(dot(v_, p) / edge_))},
           dot(up_, p)});
      solid_.push_back(opacity_of(model, i) >= kSolidOpacity);
      if (solid_[i]) rows_[places_[i].column].push_back(i);
    }
  }
  const Column& column_of(uint32_t row) const { return places_[row].column; }
  double height_of(uint32_t row) const { return places_[row].height; }
  bool is_solid(uint32_t row) const { return solid_[row] != 0; }

  /// Whether a solid Gaussian that counts is right below a height of a column.
  template <class Counts>
  bool below(const Column& column, double height, double contact, const Counts& counts) const {
    constexpr double kOverlap = 0.3;  // of the contact: surfaces are rough
    const auto it = rows_.find(column);
    return it != rows_.end() && std::any_of(it->second.begin(), it->second.end(), [&](uint32_t row) {
             const double at = height_of(row);
             return at <= height + kOverlap * contact && height - at < contact && counts(row);
           });
  }

 private:
  struct Place {
    Column column;
    double height = 0;
  };
  Vec3d up_, u_, v_;
  double edge_;
  std::vector<Place> places_;   ///< by row
  std::vector<uint8_t> solid_;  ///< by row
  std::map<Column, std::vector<uint32_t>> rows_;
};

Vec2d middle_of(const Column& column) { return {column.first + 0.5, column.second + 0.5}; }

/// A level surface of a thing that goes, as a rectangle at a height: the top of a wardrobe, a mattress. Photos from eye
/// level do not show a wardrobe's top, and a blanket hides its mattress, so Gaussians below a thing are not needed.
struct BroadLevel {
  PlaneRectangle rectangle;  ///< in columns
  double height = 0;         ///< scene units along up
};

/// The solid Gaussians of an object that goes.
struct GoingPiece {
  uint16_t label = 0;
  std::vector<uint32_t> rows;
  std::set<Column> columns;
};

/// The objects of which most is selected.
std::vector<GoingPiece> going_pieces(const GaussianLabels& labels, const std::vector<uint8_t>& selected,
                                     const Columns& columns,
                                     const std::map<ObjectName, std::vector<uint32_t>>& rows_of) {
  constexpr size_t kFewest = 20;  // Gaussians that show how large a thing is
  const TakenObjects taken(labels, selected);
  std::vector<GoingPiece> pieces;
  for (const auto& [name, rows] : rows_of) {
    if (name.second == 0 || !taken.holds(name.first, name.second)) continue;
    GoingPiece piece;
    piece.label = name.first;
    for (const uint32_t i : rows) {
      if (!selected[i] || !columns.is_solid(i)) continue;
      piece.rows.push_back(i);
      piece.columns.insert(columns.column_of(i));
    }
    if (piece.rows.size() >= kFewest) pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// Heights at which a thing is broad: its columns at that height are a share of all of them. And its top. Its lowest
/// part carries nothing: what is there is on the floor.
void add_levels(const GoingPiece& piece, const Columns& columns, double step, std::vector<BroadLevel>& levels) {
  constexpr double kStrays = 0.02;  // share of an object's Gaussians that may be higher, and lower
  constexpr double kBroad = 0.15;   // of the columns
  constexpr double kFeet = 0.25;    // of its height
  std::vector<Vec2d> places;
  std::vector<double> heights;
  std::map<int, std::set<Column>> covered;  // by step of height
  for (const uint32_t i : piece.rows) {
    places.push_back(middle_of(columns.column_of(i)));
    heights.push_back(columns.height_of(i));
    covered[static_cast<int>(std::floor(columns.height_of(i) / step))].insert(columns.column_of(i));
  }
  std::sort(heights.begin(), heights.end());
  const auto strays = static_cast<size_t>(kStrays * static_cast<double>(heights.size()));
  const double low = heights[strays], high = heights[heights.size() - 1 - strays];
  const PlaneRectangle rectangle = rectangle_of(places);
  for (const auto& [number, there] : covered) {
    const double height = (number + 0.5) * step;
    if (height < low + kFeet * (high - low)) continue;
    if (static_cast<double>(there.size()) >= kBroad * static_cast<double>(piece.columns.size()))
      levels.push_back({rectangle, height});
  }
  levels.push_back({rectangle, high});
}

bool are_near(const GoingPiece& a, const GoingPiece& b, int reach) {
  return std::any_of(a.columns.begin(), a.columns.end(), [&](const Column& c) {
    return std::any_of(b.columns.begin(), b.columns.end(), [&](const Column& d) {
      return std::abs(c.first - d.first) <= reach && std::abs(c.second - d.second) <= reach;
    });
  });
}

/// Level surfaces of what goes. Pieces of a class that lie near each other are one thing: a blanket parts the front of
/// a bed from its head.
std::vector<BroadLevel> levels_of(const std::vector<GoingPiece>& pieces, const Columns& columns, double step) {
  constexpr int kReach = 15;  // columns: 90 cm
  DisjointSets sets(pieces.size());
  for (uint32_t i = 0; i < pieces.size(); ++i) {
    for (uint32_t j = i + 1; j < pieces.size(); ++j) {
      if (pieces[i].label == pieces[j].label && are_near(pieces[i], pieces[j], kReach)) sets.unite(i, j);
    }
  }
  std::map<uint32_t, GoingPiece> things;
  for (uint32_t i = 0; i < pieces.size(); ++i) {
    GoingPiece& thing = things[sets.find(i)];
    thing.rows.insert(thing.rows.end(), pieces[i].rows.begin(), pieces[i].rows.end());
    thing.columns.insert(pieces[i].columns.begin(), pieces[i].columns.end());
  }
  std::vector<BroadLevel> levels;
  for (const auto& [first, thing] : things) add_levels(thing, columns, step, levels);
  return levels;
}

/// Whether a thing rests on a level. A share of its columns is over it. Its low places are near to it, or most of its
/// columns are: a blanket's edges hang down.
bool rests_on(const BroadLevel& level, const std::map<Column, double>& lowest, double contact, double share) {
  constexpr double kLow = 0.1;  // quantile of the columns' lowest places: single Gaussians stray
  size_t inside = 0, near = 0;
  std::vector<double> heights;
  for (const auto& [column, height] : lowest) {
    const bool over = level.rectangle.holds(middle_of(column), 0.5);
    inside += over;
    near += over && std::fabs(height - level.height) <= contact;
    heights.push_back(height);
  }
  const double needed = share * static_cast<double>(lowest.size());
  if (static_cast<double>(inside) < needed) return false;
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(kLow * static_cast<double>(heights.size() - 1));
  std::nth_element(heights.begin(), low, heights.end());
  return std::fabs(*low - level.height) <= contact || static_cast<double>(near) >= needed;
}

}  // namespace

void select_objects(const LabelledGaussians& room, const std::vector<Instance>& objects,
                    std::vector<uint8_t>& selected) {
  for (size_t i = 0; i < selected.size(); ++i) {
    for (const Instance& o : objects) {
      if (room.labels.label[i] == o.label && room.labels.instance[i] == o.number) selected[i] = 1;
    }
  }
}

std::vector<Instance> contents_of(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                                  const LabelSet& labels, const Vec3d& up, const ContentsSettings& settings) {
  std::vector<Instance> found;
  if (!room.has_labels()) return found;
  const std::vector<CarryingClass> classes = carrying_classes(labels);
  const Columns columns(room.model, up, settings.column * room.extent);
  const double contact = settings.contact * room.extent;
  std::vector<uint8_t> carried = selected;
  const std::vector<Instance> objects = list_instances(room.model, room.labels);
  const std::map<ObjectName, std::vector<uint32_t>> rows_of = rows_of_objects(room.labels);
  const std::vector<BroadLevel> levels =
      levels_of(going_pieces(room.labels, selected, columns, rows_of), columns, 0.5 * contact);
  const auto is_thing = [&](uint16_t label) {
    return label < classes.size() && classes[label].shell == PlaneKind::kNone;
  };
  for (bool more = true; more;) {  // a book on a tray on a table
    more = false;
    for (const Instance& o : objects) {
      const CarryingClass& kind = classes[static_cast<size_t>(o.label)];
      if (kind.shell != PlaneKind::kNone || kind.on_floor || never_stands(labels, o.label)) continue;
      const ObjectName name{static_cast<uint16_t>(o.label), static_cast<uint16_t>(o.number)};
      const std::vector<uint32_t>& rows = rows_of.at(name);
      std::map<Column, double> lowest;
      size_t taken = 0;
      for (const uint32_t i : rows) {
        taken += carried[i];
        if (!columns.is_solid(i)) continue;
        const auto [at, fresh] = lowest.emplace(columns.column_of(i), columns.height_of(i));
        if (!fresh) at->second = std::min(at->second, columns.height_of(i));
      }
      if (2 * taken > rows.size() || lowest.empty()) continue;
      // A thing that also reaches down to the floor is beside, not on: only its lowest columns count.
      double bottom = 1e300;
      for (const auto& [column, height] : lowest) bottom = std::min(bottom, height);
      size_t touching = 0, elsewhere = 0, low = 0;
      for (const auto& [column, height] : lowest) {
        if (height > bottom + 2 * contact) continue;
        ++low;
        touching += columns.below(column, height, contact, [&](uint32_t row) { return carried[row] != 0; });
        elsewhere += columns.below(column, height, contact, [&](uint32_t row) {
          const ObjectName other{room.labels.label[row], room.labels.instance[row]};
          return !carried[row] && other != name && is_thing(other.first);
        });
      }
      const auto is_share = [&](size_t count) {
        return static_cast<double>(count) >= settings.share * static_cast<double>(low);
      };
      const bool on_level = std::any_of(levels.begin(), levels.end(), [&](const BroadLevel& level) {
        return rests_on(level, lowest, contact, settings.share);
      });
      if (!is_share(touching) && (!on_level || is_share(elsewhere))) continue;
      found.push_back(o);
      for (const uint32_t i : rows) carried[i] = 1;
      more = true;
    }
  }
  return found;
}

}  // namespace aligngs
