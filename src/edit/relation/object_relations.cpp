#include "edit/relation/object_relations.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "edit/contents.h"
#include "edit/relation/class_groups.h"

namespace aligngs {
namespace {

/// Share of an object's places whose footprint another box holds.
double share_over(const RoomObjects& objects, size_t a, const ObjectBox& box, double margin) {
  const std::vector<Vec3f>& places = objects.places(a);
  const auto inside = std::count_if(places.begin(), places.end(), [&](const Vec3f& p) {
    return box.footprint.holds(objects.axes().on_floor(p.cast<double>()), margin);
  });
  return static_cast<double>(inside) / static_cast<double>(std::max<size_t>(1, places.size()));
}

}  // namespace

const std::set<size_t>& ObjectRelations::contents(const std::vector<size_t>& carriers) const {
  const auto [it, fresh] = contents_.emplace(carriers, std::set<size_t>());
  if (!fresh) return it->second;
  std::vector<uint8_t> selected(objects_.room().model.size(), 0);
  for (const size_t c : carriers) {
    for (const uint32_t row : objects_.rows(c)) selected[row] = 1;
  }
  const Vec3d up = up_of_viewer(objects_.viewpoint());
  for (const Instance& found : contents_of(objects_.room(), selected, objects_.labels(), up)) {
    for (size_t i = 0; i < objects_.size(); ++i) {
      if (objects_[i].label == found.label && objects_[i].number == found.number) it->second.insert(i);
    }
  }
  return it->second;
}

bool ObjectRelations::is_carried(size_t a) const {
  std::vector<size_t> furniture;
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (classes_[static_cast<size_t>(objects_[i].label)].furniture) furniture.push_back(i);
  }
  return contents(furniture).count(a) > 0;
}

bool ObjectRelations::stands(size_t a) const {
  double floor = 1e300;  // its height
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (classes_[static_cast<size_t>(objects_[i].label)].shell == PlaneKind::kFloor)
      floor = std::min(floor, objects_.box(i).middle_height());
  }
  if (floor == 1e300 || never_stands(objects_.labels(), objects_[a].label)) return false;
  const double reach = is_standing(objects_.labels(), objects_[a].label) ? limits_.foot : limits_.touch;
  return objects_.box(a).low - floor < reach * objects_.metre();
}

bool ObjectRelations::is_on_a_top(size_t a) const {
  if (!is_standing(objects_.labels(), objects_[a].label) || is_heavy(objects_.labels(), objects_[a].label))
    return false;  // a painting just above a sofa hangs
  const double margin = limits_.inside * objects_.metre();
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (i == a || !classes_[static_cast<size_t>(objects_[i].label)].furniture) continue;
    const ObjectBox& below = objects_.box(i);
    if (std::fabs(objects_.box(a).low - below.high) <= margin &&
        share_over(objects_, a, below, margin) >= limits_.share)
      return true;
  }
  return false;
}

std::optional<size_t> ObjectRelations::pot_of(size_t a) const {
  for (size_t i = 0; i < objects_.size(); ++i) {
    if (may_stand_in(objects_.labels(), objects_[a].label, objects_[i].label) &&
        objects_.box(i).middle_height() < objects_.box(a).middle_height() && objects_.gap(a, i) < limits_.touch)
      return i;
  }
  return std::nullopt;
}

bool ObjectRelations::is_on_shell(size_t a, size_t b) const {
  const auto shell = [&](size_t i) { return classes_[static_cast<size_t>(objects_[i].label)].shell; };
  if (shell(a) != PlaneKind::kNone || is_carried(a) || is_on_a_top(a)) return false;
  const bool on_floor = stands(a);
  if (const auto pot = on_floor ? std::nullopt : pot_of(a)) return is_on_shell(*pot, b);
  if (shell(b) == PlaneKind::kFloor) return on_floor;
  return !on_floor && !is_heavy(objects_.labels(), objects_[a].label) && objects_.gap(a, b) < limits_.touch;
}

bool ObjectRelations::is_on(size_t a, size_t b) const {
  const CarryingClass kind = classes_[static_cast<size_t>(objects_[b].label)];
  if (kind.shell != PlaneKind::kNone) return is_on_shell(a, b);
  return contents({b}).count(a) > 0;
}

bool ObjectRelations::is_in(size_t a, size_t b) const {
  const ObjectBox &inner = objects_.box(a), &outer = objects_.box(b);
  const double margin = limits_.inside * objects_.metre();
  return inner.low >= outer.low - margin && inner.high <= outer.high + margin &&
         share_over(objects_, a, outer, margin) > limits_.share;
}

bool ObjectRelations::is_above_inside(size_t a, size_t b) const {
  return is_closed(objects_.labels(), objects_[b].label) &&
         objects_.box(a).low >= objects_.box(b).high - limits_.top * objects_.metre();
}

bool ObjectRelations::is_above(size_t a, size_t b) const {
  up_of_viewer(objects_.viewpoint());  // refuses where it is not known
  const ObjectBox &upper = objects_.box(a), &lower = objects_.box(b);
  if (lower.high > upper.middle_height() || lower.high > upper.high) return false;
  // A lamp on the floor beside a bed is not above it.
  const bool is_over = upper.low >= lower.middle_height();
  const double margin = (is_over ? limits_.around : limits_.inside) * objects_.metre();
  return std::max(share_over(objects_, a, lower, margin), share_over(objects_, b, upper, margin)) >= limits_.share;
}

bool ObjectRelations::is_beside(size_t a, Relation relation, size_t b) const {
  const Vec3d middle = objects_[b].centre.cast<double>(), right = right_of_viewer(objects_.viewpoint(), middle);
  const bool sideways = relation == Relation::kLeftOf || relation == Relation::kRightOf;
  Vec3d direction = sideways ? right : cross(right, objects_.axes().up);  // to the right, or to the cameras
  if (relation == Relation::kLeftOf || relation == Relation::kBehind) direction = -direction;
  double end = -1e300;  // of b in that direction
  for (const Vec3f& p : objects_.places(b)) end = std::max(end, dot(direction, p.cast<double>()));
  return dot(direction, objects_[a].centre.cast<double>()) > end && objects_.gap(a, b) < limits_.beside;
}

bool ObjectRelations::is_on_side(size_t a, Relation side, size_t b) const {
  if (is_beside(a, side == Relation::kLeftSide ? Relation::kLeftOf : Relation::kRightOf, b)) return true;
  if (!is_on(a, b)) return false;
  constexpr double kFromMiddle = 0.03;  // metres
  const Vec3d middle = objects_[b].centre.cast<double>(), right = right_of_viewer(objects_.viewpoint(), middle);
  const double at = dot(right, objects_[a].centre.cast<double>() - middle) / objects_.metre();
  return side == Relation::kLeftSide ? at < -kFromMiddle : at > kFromMiddle;
}

std::vector<Vec2d> ObjectRelations::directions(size_t a, size_t b) const {
  const BoxAxes& axes = objects_.axes();
  const Vec2d middle = objects_.box(a).middle();
  std::vector<std::pair<double, Vec2d>> seen;  // distances and directions
  for (const Vec3f& p : objects_.places(b)) {
    const Vec2d place = axes.on_floor(p.cast<double>());
    const double u = place.x - middle.x, v = place.y - middle.y, distance = std::hypot(u, v);
    if (distance > 0) seen.push_back({distance, {u / distance, v / distance}});
  }
  if (seen.empty()) return {};
  const auto nearer = [](const auto& one, const auto& other) { return one.first < other.first; };
  const auto nearest = std::min_element(seen.begin(), seen.end(), nearer);
  if (classes_[static_cast<size_t>(objects_[b].label)].shell == PlaneKind::kNone) return {nearest->second};
  const double farthest = std::max(nearest->first, 0.5 * objects_.box(a).length) + limits_.beside * objects_.metre();
  std::vector<Vec2d> out;
  for (const auto& [distance, direction] : seen) {
    if (distance <= farthest) out.push_back(direction);
  }
  return out;
}

std::optional<double> ObjectRelations::gap_between(size_t a, size_t one, size_t other) const {
  if (a == one || a == other || one == other) return std::nullopt;
  up_of_viewer(objects_.viewpoint());  // refuses where it is not known
  const double most = std::cos(limits_.apart * kRadiansPerDegree);
  const std::vector<Vec2d> there = directions(a, one), here = directions(a, other);
  const bool is_between = std::any_of(there.begin(), there.end(), [&](const Vec2d& t) {
    return std::any_of(here.begin(), here.end(), [&](const Vec2d& h) { return t.x * h.x + t.y * h.y < most; });
  });
  return is_between ? std::optional<double>(objects_.gap(a, one) + objects_.gap(a, other)) : std::nullopt;
}

std::optional<double> ObjectRelations::gap_where(size_t a, Relation relation, size_t b) const {
  if (a == b) return std::nullopt;
  const auto where = [&](bool holds) { return holds ? std::optional<double>(objects_.gap(a, b)) : std::nullopt; };
  const auto within = [&](double most) {
    const double gap = objects_.gap(a, b);
    return gap <= most ? std::optional<double>(gap) : std::nullopt;
  };
  switch (relation) {
    case Relation::kOn:
      return where(is_on(a, b));
    case Relation::kIn:
      return where(!is_above_inside(a, b) && (is_in(a, b) || is_on(a, b)));
    case Relation::kOwned:
      return where(is_in(a, b) || is_on(a, b));
    case Relation::kUnder:
      return where(is_above(b, a));
    case Relation::kAbove:
      return where(is_above(a, b));
    case Relation::kNextTo:
      return within(limits_.next_to);
    case Relation::kNear:
      return within(limits_.near);
    case Relation::kNearest:
    case Relation::kFarthest:
      return objects_.gap(a, b);
    case Relation::kLeftSide:
    case Relation::kRightSide:
      return where(is_on_side(a, relation, b));
    case Relation::kBothSides:
      return where(is_beside(a, Relation::kLeftOf, b) || is_beside(a, Relation::kRightOf, b));
    case Relation::kHolding:
      return where(is_on(b, a) || is_in(b, a));
    default:
      return where(is_beside(a, relation, b));
  }
}

}  // namespace aligngs
