#include "edit/placement_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/perpendicular.h"
#include "core/quantile.h"
#include "edit/fill/carrying_classes.h"
#include "edit/object_names.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

// Lengths are shares of the extent, which is about 3 m in a room.
constexpr double kColumnEdge = 0.02;   // 6 cm
constexpr double kFloats = 0.017;      // gap under a foot: 5 cm
constexpr double kHangs = 0.1;         // it hung there before, or nobody saw its legs: 30 cm
constexpr double kUnseenFeet = 0.05;   // nearer to the floor an object rests on it: 15 cm
constexpr double kUnseenLegs = 0.085;  // and furniture: photos do not look under a bed (25 cm)
constexpr double kFoot = 0.03;         // the lowest part of an object: 10 cm
constexpr double kSink = 0.01;         // surfaces are rough: 3 cm
constexpr double kStrayShare = 0.02;   // of an object's Gaussians that may lie anywhere
constexpr size_t kCollidingColumns = 6;
constexpr int kFarthest = 30;  // columns that a remedy may move it

using PlanColumn = std::pair<int, int>;
struct HeightRange {
  double low = 1e300, high = -1e300;
  void add(double height) {
    low = std::min(low, height);
    high = std::max(high, height);
  }
};
using ColumnRanges = std::map<PlanColumn, HeightRange>;

/// The other things and the floor of a room, in upright columns.
class ThingsAround {
 public:
  ThingsAround(const EditableRoom& room, const std::vector<uint8_t>& selected, bool with_selected)
      : up_(*room.up), u_(perpendicular_to(up_)), v_(cross(up_, u_)), edge_(kColumnEdge * room.gaussians.extent) {
    const std::vector<CarryingClass> classes = carrying_classes(room.labels);
    const GaussianLabels& labels = room.gaussians.labels;
    std::vector<double> floor;
    for (size_t i = 0; i < labels.label.size(); ++i) {
      const uint16_t label = labels.label[i];
      if (label == kNoLabel || label >= classes.size() || (selected[i] && !with_selected)) continue;
      if (opacity_of(room.gaussians.model, i) < kSolidOpacity) continue;
      const Vec3d place = position_of(room.gaussians.model, i);
      if (classes[label].shell == PlaneKind::kFloor) floor.push_back(dot(up_, place));
      if (classes[label].shell != PlaneKind::kNone || classes[label].on_floor || labels.instance[i] == 0) continue;
      things_[{label, labels.instance[i]}][column_of(place)].add(dot(up_, place));
    }
    if (!floor.empty()) ground_ = quantile_of(std::move(floor), 0.5);
  }

  PlanColumn column_of(const Vec3d& place) const {
    return {static_cast<int>(std::floor(dot(u_, place) / edge_)), static_cast<int>(std::floor(dot(v_, place) / edge_))};
  }
  double edge() const { return edge_; }

  /// Columns of an object without its strays.
  ColumnRanges columns_of(const std::vector<Vec3d>& places) const {
    std::vector<double> heights;
    for (const Vec3d& p : places) heights.push_back(dot(up_, p));
    const double low = quantile_of(heights, kStrayShare), high = quantile_of(heights, 1 - kStrayShare);
    ColumnRanges out;
    for (size_t k = 0; k < places.size(); ++k) {
      if (heights[k] >= low && heights[k] <= high) out[column_of(places[k])].add(heights[k]);
    }
    return out;
  }

  /// From the foot of an object down to what is right below it; empty without a floor.
  std::optional<double> gap_below(const ColumnRanges& object, double extent) const {
    if (!ground_ || object.empty()) return std::nullopt;
    const double foot = foot_of(object);
    double support = *ground_;
    for (const auto& entry : object) {
      if (entry.second.low > foot + kFoot * extent) continue;
      for (const auto& thing : things_) {
        const auto under = thing.second.find(entry.first);
        if (under == thing.second.end() || under->second.low > foot + kFloats * extent) continue;
        support = std::max(support, std::min(under->second.high, foot));
      }
    }
    return foot - support;
  }

  /// From the foot of an object down to the floor; empty without a floor.
  std::optional<double> gap_to_floor(const ColumnRanges& object) const {
    if (!ground_ || object.empty()) return std::nullopt;
    return foot_of(object) - *ground_;
  }

  /// Columns that an object shares with each thing.
  std::map<std::pair<uint16_t, uint16_t>, size_t> shared(const ColumnRanges& object, double extent,
                                                         const PlanColumn& shift = {0, 0}) const {
    std::map<std::pair<uint16_t, uint16_t>, size_t> out;
    const double rough = kSink * extent;
    for (const auto& thing : things_) {
      size_t count = 0;
      for (const auto& entry : object) {
        const auto at = thing.second.find({entry.first.first + shift.first, entry.first.second + shift.second});
        if (at == thing.second.end()) continue;
        count += entry.second.low + rough < at->second.high && at->second.low + rough < entry.second.high;
      }
      if (count > 0) out[thing.first] = count;
    }
    return out;
  }

 private:
  static double foot_of(const ColumnRanges& object) {
    double foot = 1e300;
    for (const auto& entry : object) foot = std::min(foot, entry.second.low);
    return foot;
  }

  Vec3d up_, u_, v_;
  double edge_;
  std::map<std::pair<uint16_t, uint16_t>, ColumnRanges> things_;  ///< by class and number
  std::optional<double> ground_;
};

/// Things that an object shares more columns with than it did before.
std::vector<Instance> hit_things(const std::map<std::pair<uint16_t, uint16_t>, size_t>& was,
                                 const std::map<std::pair<uint16_t, uint16_t>, size_t>& is) {
  std::vector<Instance> out;
  for (const auto& [thing, count] : is) {
    const auto before = was.find(thing);
    if (count < kCollidingColumns + (before == was.end() ? 0 : before->second)) continue;
    Instance instance;
    instance.label = thing.first;
    instance.number = thing.second;
    out.push_back(instance);
  }
  return out;
}

/// The shortest level move that leaves all things, as a sentence; empty where none does.
std::string way_out(const EditableRoom& room, const ThingsAround& around, const Placement& placement,
                    const ColumnRanges& object, const std::map<std::pair<uint16_t, uint16_t>, size_t>& was) {
  if (room.cameras.empty()) return "";
  Vec3d toward;
  for (const Camera& c : room.cameras) toward += c.centre() * (1.0 / static_cast<double>(room.cameras.size()));
  for (const Vec3d& p : placement.after) toward -= p * (1.0 / static_cast<double>(placement.after.size()));
  toward -= *room.up * dot(toward, *room.up);
  constexpr double kShortestWay = 1e-6;  // scene units
  if (norm(toward) < kShortestWay) return "";
  toward = normalized(toward);
  const Vec3d right = cross(*room.up, toward);
  const std::pair<Vec3d, const char*> ways[] = {
      {right, "to the right"}, {-right, "to the left"}, {toward, "closer"}, {-toward, "back"}};
  const PlanColumn origin = around.column_of({});
  for (int step = 1; step <= kFarthest; ++step) {
    for (const auto& way : ways) {
      const PlanColumn to = around.column_of(way.first * ((step + 0.5) * around.edge()));
      const PlanColumn shift{to.first - origin.first, to.second - origin.second};
      if (!hit_things(was, around.shared(object, room.gaussians.extent, shift)).empty()) continue;
      return fmt::format("move {} {} {}", placement.name,
                         length_to_type((step + 0.5) * around.edge(), room.length_unit), way.second);
    }
  }
  return "";
}

/// Whether most of some rows are of furniture that things rest on.
bool is_furniture(const EditableRoom& room, const std::vector<uint8_t>& selected) {
  const std::vector<CarryingClass> classes = carrying_classes(room.labels);
  size_t all = 0, furniture = 0;
  for (size_t i = 0; i < selected.size(); ++i) {
    if (!selected[i]) continue;
    const uint16_t label = room.gaussians.labels.label[i];
    ++all;
    furniture += label < classes.size() && classes[label].furniture;
  }
  return 2 * furniture > all;
}

}  // namespace

std::vector<Vec3d> solid_places(const GaussianModel& model, const std::vector<uint8_t>& selected) {
  std::vector<Vec3d> out;
  for (size_t i = 0; i < selected.size(); ++i) {
    if (selected[i] && opacity_of(model, i) >= kSolidOpacity) out.push_back(position_of(model, i));
  }
  return out;
}

std::vector<std::string> placement_warnings(const EditableRoom& room, const std::vector<uint8_t>& selected,
                                            const Placement& placement) {
  std::vector<std::string> out;
  if (!room.up || placement.before.empty() || placement.after.empty()) return out;
  const double extent = room.gaussians.extent;
  const ThingsAround others(room, selected, false);
  const ThingsAround around(room, selected, placement.original_stays);
  const ColumnRanges before = others.columns_of(placement.before), after = others.columns_of(placement.after);
  const std::optional<double> to_floor = others.gap_to_floor(before), was = others.gap_below(before, extent),
                              is = around.gap_below(after, extent);
  if (was && is && to_floor) {
    // Photos rarely show the feet of things on the floor.
    const bool over_floor = *is >= around.gap_to_floor(after).value_or(0);
    const double unseen = is_furniture(room, selected) ? kUnseenLegs : kUnseenFeet;
    const double feet = over_floor && *to_floor < unseen * extent ? *to_floor : 0;
    const double usual = std::max({0.0, *was, feet}), flight = *is - usual;
    const bool hung = usual >= kHangs * extent;
    if (!hung && flight > kFloats * extent) {
      out.push_back(fmt::format("{} floats {} above what is below it; \"move {} {} down\" puts it there",
                                placement.name, length_text(flight, room.length_unit), placement.name,
                                length_to_type(flight, room.length_unit)));
    }
  }
  const auto shared_before = others.shared(before, extent);
  const std::vector<Instance> hit = hit_things(shared_before, around.shared(after, extent));
  if (!hit.empty()) {
    std::string text = placement.name + " collides with " + first_objects_text(hit, room.labels);
    if (const std::string way = way_out(room, around, placement, after, shared_before); !way.empty())
      text += "; \"" + way + "\" frees it";
    out.push_back(text);
  }
  return out;
}

}  // namespace aligngs
