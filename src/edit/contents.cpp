#include "edit/contents.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "edit/fill/carrying_classes.h"
#include "edit/fill/plane_rectangle.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

using Column = std::pair<int, int>;

/// Upright columns of the room.
class Columns {
 public:
  Columns(const GaussianModel& model, const Vec3d& up, double edge) : model_(model), up_(up), edge_(edge) {
    u_ = normalized(cross(std::fabs(up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, up));
    v_ = cross(up, u_);
  }
  Column column_of(size_t i) const {
    const Vec3d p = place(i);
    return {static_cast<int>(std::floor(dot(u_, p) / edge_)), static_cast<int>(std::floor(dot(v_, p) / edge_))};
  }
  double height_of(size_t i) const { return dot(up_, place(i)); }

 private:
  Vec3d place(size_t i) const { return position_of(model_, i); }
  const GaussianModel& model_;
  Vec3d up_, u_, v_;
  double edge_;
};

/// Heights of the selected Gaussians in each column, ascending.
std::map<Column, std::vector<double>> heights_of(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                                                 const Columns& columns) {
  std::map<Column, std::vector<double>> out;
  for (size_t i = 0; i < selected.size(); ++i) {
    if (selected[i] && opacity_of(room.model, i) >= kSolidOpacity)
      out[columns.column_of(i)].push_back(columns.height_of(i));
  }
  for (auto& [column, heights] : out) std::sort(heights.begin(), heights.end());
  return out;
}

/// A level surface of a thing that goes, as a rectangle at a height: the top of a wardrobe, a mattress. Photos from eye
/// level do not show a wardrobe's top, and a blanket hides its mattress, so Gaussians below a thing are not needed.
struct BroadLevel {
  PlaneRectangle rectangle;  ///< in columns
  double height = 0;         ///< scene units along up
};

/// An object that goes, as its columns and the heights of its Gaussians in them.
struct GoingPiece {
  uint16_t label = 0;
  std::vector<Vec2d> places;  ///< middles of columns, one per Gaussian
  std::vector<double> heights;
  std::set<Column> columns;
};

/// The objects of which most is selected.
std::vector<GoingPiece> going_pieces(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                                     const Columns& columns, const std::vector<Instance>& objects) {
  constexpr size_t kFewest = 20;  // Gaussians that show how large a thing is
  std::vector<GoingPiece> pieces;
  for (const Instance& o : objects) {
    GoingPiece piece;
    piece.label = o.label;
    size_t rows = 0, taken = 0;
    for (size_t i = 0; i < selected.size(); ++i) {
      if (room.labels.label[i] != o.label || room.labels.instance[i] != o.number) continue;
      ++rows;
      taken += selected[i];
      if (!selected[i] || opacity_of(room.model, i) < kSolidOpacity) continue;
      const Column column = columns.column_of(i);
      piece.columns.insert(column);
      piece.places.push_back({column.first + 0.5, column.second + 0.5});
      piece.heights.push_back(columns.height_of(i));
    }
    if (piece.places.size() >= kFewest && 2 * taken >= rows) pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// Heights at which a thing is broad: its columns at that height are a share of all of them. And its top. Its lowest
/// part carries nothing: what is there is on the floor.
void add_levels(const GoingPiece& piece, double step, std::vector<BroadLevel>& levels) {
  constexpr double kStrays = 0.02;  // share of an object's Gaussians that may be higher, and lower
  constexpr double kBroad = 0.15;   // of the columns
  constexpr double kFeet = 0.25;    // of its height
  const PlaneRectangle rectangle = rectangle_of(piece.places);
  std::vector<double> heights = piece.heights;
  std::sort(heights.begin(), heights.end());
  const auto strays = static_cast<size_t>(kStrays * static_cast<double>(heights.size()));
  const double low = heights[strays], high = heights[heights.size() - 1 - strays];
  std::map<int, std::set<Column>> covered;  // by step of height
  for (size_t i = 0; i < piece.places.size(); ++i) {
    covered[static_cast<int>(std::floor(piece.heights[i] / step))].insert(
        {static_cast<int>(std::floor(piece.places[i].x)), static_cast<int>(std::floor(piece.places[i].y))});
  }
  for (const auto& [number, columns] : covered) {
    const double height = (number + 0.5) * step;
    if (height < low + kFeet * (high - low)) continue;
    if (static_cast<double>(columns.size()) >= kBroad * static_cast<double>(piece.columns.size()))
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

/// BroadLevel surfaces of what goes. Pieces of a class that lie near each other are one thing: a blanket parts the front of a
/// bed from its head.
std::vector<BroadLevel> levels_of(std::vector<GoingPiece> pieces, double step) {
  constexpr int kReach = 15;  // columns: 90 cm
  for (size_t i = 0; i < pieces.size(); ++i) {
    for (size_t j = i + 1; j < pieces.size();) {
      if (pieces[i].label != pieces[j].label || !are_near(pieces[i], pieces[j], kReach)) {
        ++j;
        continue;
      }
      GoingPiece &to = pieces[i], &from = pieces[j];
      to.places.insert(to.places.end(), from.places.begin(), from.places.end());
      to.heights.insert(to.heights.end(), from.heights.begin(), from.heights.end());
      to.columns.insert(from.columns.begin(), from.columns.end());
      pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;  // it is larger now
    }
  }
  std::vector<BroadLevel> levels;
  for (const GoingPiece& piece : pieces) add_levels(piece, step, levels);
  return levels;
}

/// Whether a thing rests on a level. A share of its columns is over it. Its low places are near to it, or most of its
/// columns are: a blanket's edges hang down.
bool rests_on(const BroadLevel& level, const std::map<Column, double>& lowest, double contact, double share) {
  constexpr double kLow = 0.1;  // quantile of the columns' lowest places: single Gaussians stray
  size_t inside = 0, near = 0;
  std::vector<double> heights;
  for (const auto& [column, height] : lowest) {
    const bool over = level.rectangle.holds({column.first + 0.5, column.second + 0.5}, 0.5);
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

/// Objects that could carry others, by column: heights of their Gaussians. Walls, floor and ceiling are none.
class Supports {
 public:
  Supports(const LabelledGaussians& room, const std::vector<CarryingClass>& classes, const Columns& columns) {
    for (size_t i = 0; i < room.model.size(); ++i) {
      const uint16_t label = room.labels.label[i];
      if (label >= classes.size() || classes[label].shell != PlaneKind::kNone ||
          opacity_of(room.model, i) < kSolidOpacity)
        continue;
      by_column_[columns.column_of(i)].push_back({columns.height_of(i), i});
    }
  }

  /// Whether something of `room` that neither goes nor is the thing itself is right below `height` in a column.
  bool below(const LabelledGaussians& room, const std::vector<uint8_t>& going, const Instance& thing,
             const Column& column, double height, double contact) const {
    const auto it = by_column_.find(column);
    return it != by_column_.end() && std::any_of(it->second.begin(), it->second.end(), [&](const auto& entry) {
             const auto& [at, row] = entry;
             const bool own = room.labels.label[row] == thing.label && room.labels.instance[row] == thing.number;
             return !own && !going[row] && at <= height + 0.3 * contact && height - at < contact;
           });
  }

 private:
  std::map<Column, std::vector<std::pair<double, size_t>>> by_column_;
};

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
  const std::vector<BroadLevel> levels = levels_of(going_pieces(room, selected, columns, objects), 0.5 * contact);
  const Supports others(room, classes, columns);
  for (bool more = true; more;) {  // a book on a tray on a table
    more = false;
    const auto below = heights_of(room, carried, columns);
    for (const Instance& o : objects) {
      const CarryingClass& kind = classes[static_cast<size_t>(o.label)];
      if (kind.shell != PlaneKind::kNone || kind.on_floor) continue;
      std::map<Column, double> lowest;
      size_t rows = 0, taken = 0;
      for (size_t i = 0; i < room.model.size(); ++i) {
        if (room.labels.label[i] != o.label || room.labels.instance[i] != o.number) continue;
        ++rows;
        taken += carried[i];
        if (opacity_of(room.model, i) < kSolidOpacity) continue;
        const double height = columns.height_of(i);
        const auto [at, fresh] = lowest.emplace(columns.column_of(i), height);
        if (!fresh) at->second = std::min(at->second, height);
      }
      if (rows == 0 || 2 * taken > rows || lowest.empty()) continue;
      // A thing that also reaches down to the floor is beside, not on: only its lowest columns count.
      double bottom = 1e300;
      for (const auto& [column, height] : lowest) bottom = std::min(bottom, height);
      size_t touching = 0, low = 0, elsewhere = 0;
      for (const auto& [column, height] : lowest) {
        if (height > bottom + 2 * contact) continue;
        ++low;
        elsewhere += others.below(room, carried, o, column, height, contact);
        const auto it = below.find(column);
        if (it == below.end()) continue;
        const auto above = std::upper_bound(it->second.begin(), it->second.end(), height + 0.3 * contact);
        touching += above != it->second.begin() && height - *std::prev(above) < contact;
      }
      const bool on_level = std::any_of(levels.begin(), levels.end(), [&](const BroadLevel& level) {
        return rests_on(level, lowest, contact, settings.share);
      });
      const bool on_another = static_cast<double>(elsewhere) >= settings.share * static_cast<double>(low);
      if (!(on_level && !on_another) && static_cast<double>(touching) < settings.share * static_cast<double>(low))
        continue;
      found.push_back(o);
      select_objects(room, {o}, carried);
      more = true;
    }
  }
  return found;
}

}  // namespace aligngs
