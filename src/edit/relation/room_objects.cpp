#include "edit/relation/room_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/error.h"
#include "edit/object_names.h"
#include "edit/object_rows.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

constexpr const char* kByNumber = "name the object by its number: `aligngs edit RUN --list` shows them";

}  // namespace

RoomObjects::RoomObjects(const LabelledGaussians& room, const LabelSet& labels, const Viewpoint& viewpoint,
                         double metre)
    : room_(room),
      labels_(labels),
      viewpoint_(viewpoint),
      axes_(viewpoint.up.value_or(Vec3d{0, 0, 1})),
      metre_(metre),
      rows_(rows_of_objects(room.labels)) {
  for (const Instance& instance : list_instances(room.model, room.labels)) {
    const auto it = rows_.find({static_cast<uint16_t>(instance.label), static_cast<uint16_t>(instance.number)});
    objects_.push_back({instance, &it->second, {}, {}, {}});
  }
}

RoomObjects::~RoomObjects() = default;

std::string RoomObjects::name(size_t i) const { return object_name(objects_[i].instance, labels_); }

std::string RoomObjects::names(const std::vector<size_t>& objects) const {
  std::vector<Instance> named;
  for (const size_t i : objects) named.push_back(objects_[i].instance);
  return first_objects_text(named, labels_);
}

const ObjectBox& RoomObjects::box(size_t i) const {
  const Entry& entry = objects_[i];
  if (!entry.box) entry.box = object_box(room_.model, *entry.rows, axes_);
  return *entry.box;
}

const std::vector<Vec3f>& RoomObjects::places(size_t i) const {
  const Entry& entry = objects_[i];
  if (entry.places) return *entry.places;
  constexpr double kCube = 0.03, kMargin = 0.03;  // metres
  const ObjectBox& around = box(i);
  const double edge = kCube * metre_, margin = kMargin * metre_;
  std::set<std::array<int, 3>> taken;
  std::vector<Vec3f> solid, all;
  for (const uint32_t row : *entry.rows) {
    const Vec3d p = position_of(room_.model, row);
    const double height = dot(axes_.up, p);
    if (height < around.low - margin || height > around.high + margin ||
        !around.footprint.holds(axes_.on_floor(p), margin))
      continue;
    all.push_back(p.cast<float>());
    if (opacity_of(room_.model, row) < kSolidOpacity) continue;
    const std::array<int, 3> cube{static_cast<int>(std::floor(p.x / edge)), static_cast<int>(std::floor(p.y / edge)),
                                  static_cast<int>(std::floor(p.z / edge))};
    if (taken.insert(cube).second) solid.push_back(p.cast<float>());
  }
  entry.places = solid.empty() ? std::move(all) : std::move(solid);
  return *entry.places;
}

const PointTree& RoomObjects::tree(size_t i) const {
  const Entry& entry = objects_[i];
  if (!entry.tree) entry.tree = std::make_unique<PointTree>(places(i));
  return *entry.tree;
}

double RoomObjects::gap(size_t a, size_t b) const {
  constexpr double kLeaking = 0.02;  // share of the places that may be nearer
  if (places(a).size() > places(b).size()) std::swap(a, b);
  std::vector<float> distances;
  std::vector<PointTree::Neighbour> near;
  for (const Vec3f& p : places(a)) {
    tree(b).nearest(p, 1, near);
    if (!near.empty()) distances.push_back(near[0].distance);
  }
  if (distances.empty()) return 1e30;
  const auto at = distances.begin() + static_cast<std::ptrdiff_t>(kLeaking * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), at, distances.end());
  return static_cast<double>(*at) / metre_;
}

Vec3d up_of_viewer(const Viewpoint& viewpoint) {
  if (!viewpoint.up)
    throw_bad_input({}, "--select", "this room does not tell which way is up, so that no object is left or highest",
                    kByNumber);
  return *viewpoint.up;
}

Vec3d right_of_viewer(const Viewpoint& viewpoint, const Vec3d& place) {
  const Vec3d up = up_of_viewer(viewpoint);
  Vec3d forward = place - viewpoint.place.value_or(place);
  forward -= up * dot(forward, up);
  constexpr double kShortest = 1e-6;  // scene units
  if (norm(forward) < kShortest)
    throw_bad_input({}, "--select", "the cameras are among these objects, so that none is left or right", kByNumber);
  return normalized(cross(forward, up));
}

}  // namespace aligngs
