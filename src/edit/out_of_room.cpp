#include "edit/out_of_room.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/quantile.h"
#include "edit/fill/carrying_classes.h"
#include "edit/fill/room_planes.h"

namespace aligngs {
namespace {

constexpr double kBeyond = 0.017;  // / extent: 5 cm
constexpr double kStray = 0.02;    // share of the object's Gaussians that may lie anywhere

enum BeyondPlace : size_t { kWallPlace, kFloorPlace, kCeilingPlace, kOutside, kBeyondPlaces };
using Depths = std::array<double, kBeyondPlaces>;

BeyondPlace place_of(PlaneKind kind) {
  if (kind == PlaneKind::kFloor) return kFloorPlace;
  return kind == PlaneKind::kCeiling ? kCeilingPlace : kWallPlace;
}

class Shell {
 public:
  Shell(const EditableRoom& room, const std::vector<uint8_t>& selected)
      : reach_(kBeyond * room.gaussians.extent),
        up_(room.up.value_or(Vec3d{})),
        planes_(room_planes(room.gaussians, carrying_classes(room.labels), selected,
                            place_inside(room.gaussians, room.cameras))) {
    for (const RoomPlane& plane : planes_) {
      for (int a = 0; a < 3; ++a) {
        low_[a] = std::min(low_[a], plane.low[a]);
        high_[a] = std::max(high_[a], plane.high[a]);
      }
    }
  }

  bool is_known() const { return !planes_.empty(); }

  /// How far places reach beyond each kind of plane, and out of the box around all of them.
  Depths depths(const std::vector<Vec3d>& places) const {
    std::array<std::vector<double>, kBeyondPlaces> all;
    for (const Vec3d& p : places) {
      Depths one{};
      for (const RoomPlane& plane : planes_) {
        const double height = plane.height(p);
        if (height < 0 && has_surface_at(plane, p, reach_))
          one[place_of(plane.kind)] = std::max(one[place_of(plane.kind)], -height);
      }
      Vec3d beside;  // to the box around all planes, level: a room may have no ceiling
      for (int a = 0; a < 3; ++a) beside[a] = p[a] - std::clamp(p[a], low_[a], high_[a]);
      one[kOutside] = norm(beside - up_ * dot(up_, beside));
      for (size_t k = 0; k < kBeyondPlaces; ++k) all[k].push_back(one[k]);
    }
    Depths out{};
    for (size_t k = 0; k < kBeyondPlaces; ++k) {
      out[k] = quantile_of(std::move(all[k]), 1 - kStray);
    }
    return out;
  }

 private:
  double reach_;
  Vec3d up_;
  std::vector<RoomPlane> planes_;
  Vec3d low_{1e300, 1e300, 1e300}, high_{-1e300, -1e300, -1e300};
};

}  // namespace

std::string out_of_room(const EditableRoom& room, const std::vector<uint8_t>& selected, const Placement& placement) {
  if (placement.before.empty() || placement.after.empty()) return "";
  const Shell shell(room, selected);
  if (!shell.is_known()) return "";
  const Depths was = shell.depths(placement.before), is = shell.depths(placement.after);
  size_t worst = kBeyondPlaces;
  double most = kBeyond * room.gaussians.extent;
  for (size_t k = 0; k < kBeyondPlaces; ++k) {
    const double deeper = is[k] - was[k];
    if (deeper < most) continue;
    most = deeper;
    worst = k;
  }
  if (worst == kBeyondPlaces) return "";
  constexpr const char* kWords[] = {"into a wall", "below the floor", "above the ceiling", "out of the room"};
  return fmt::format("{} reaches {} {}", placement.name, length_text(is[worst], room.length_unit), kWords[worst]);
}

}  // namespace aligngs
