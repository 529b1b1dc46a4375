#include "edit/shell_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "edit/crumbs.h"
#include "edit/fill/carrying_classes.h"
#include "edit/fill/room_planes.h"
#include "gaussians/gaussian_geometry.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr size_t kShells = 3;
constexpr PlaneKind kShellKinds[kShells] = {PlaneKind::kWall, PlaneKind::kFloor, PlaneKind::kCeiling};
constexpr double kFar = 1e30;  ///< no plane of a kind is near

/// Height above the nearest plane of each kind, scene units, positive inside the room.
struct ShellPlace {
  std::array<double, kShells> height{kFar, kFar, kFar};
  std::array<uint8_t, kShells> faces{};  ///< the shortest axis is along the normal
};

ShellPlace shell_place(const Vec3d& p, const Vec3d& axis, const std::vector<RoomPlane>& planes, double beyond,
                       double facing) {
  ShellPlace out;
  for (const RoomPlane& plane : planes) {
    const double height = dot(plane.normal, p) - plane.offset;
    const Vec3d foot = p - plane.normal * height;
    bool near = true;
    for (int a = 0; a < 3; ++a) near = near && foot[a] > plane.low[a] - beyond && foot[a] < plane.high[a] + beyond;
    for (size_t s = 0; near && s < kShells; ++s) {
      if (kShellKinds[s] != plane.kind || std::fabs(height) >= std::fabs(out.height[s])) continue;
      out.height[s] = height;
      out.faces[s] = std::fabs(dot(axis, plane.normal)) > facing;
    }
  }
  return out;
}

/// The object that most Gaussians on the planes of each kind are of.
std::array<uint16_t, kShells> main_objects(const LabelledGaussians& room, const std::vector<RoomPlane>& planes) {
  std::array<uint16_t, kShells> out{};
  for (size_t s = 0; s < kShells; ++s) {
    std::map<uint16_t, size_t> counts;
    for (const RoomPlane& plane : planes) {
      for (const uint32_t i : plane.carriers) {
        if (plane.kind == kShellKinds[s] && room.labels.instance[i]) ++counts[room.labels.instance[i]];
      }
    }
    size_t most = 0;
    for (const auto& [number, count] : counts) {
      if (count > most) out[s] = number;
      most = std::max(most, count);
    }
  }
  return out;
}

class ShellCorrection {
 public:
  ShellCorrection(LabelledGaussians& room, const LabelSet& labels, const std::vector<Camera>& cameras,
                  const ShellLabelOptions& options)
      : room_(room), options_(options), classes_(carrying_classes(labels)) {
    const std::vector<uint8_t> all(room.model.size(), 0);
    planes_ = room_planes(room, classes_, all, place_inside(room, cameras));
    for (size_t s = 0; s < kShells; ++s) {
      for (size_t c = 0; c < classes_.size(); ++c) {
        if (classes_[c].shell == kShellKinds[s]) label_[s] = static_cast<uint16_t>(c);
      }
    }
  }

  bool has_planes() const { return !planes_.empty(); }

  void measure(ThreadPool& pool) {
    constexpr size_t kGrain = 4096;  // Gaussians per chunk
    places_.resize(room_.model.size());
    pool.parallel_for(places_.size(), kGrain, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        places_[i] = shell_place(position_of(room_.model, i), shortest_axis(room_.model, i), planes_,
                                 options_.beyond * room_.extent, options_.facing);
      }
    });
  }

  size_t swap_planes() {
    const double proud = options_.proud * room_.extent, on_plane = options_.on_plane * room_.extent;
    const std::array<uint16_t, kShells> objects = main_objects(room_, planes_);
    size_t changed = 0;
    for (size_t i = 0; i < places_.size(); ++i) {
      const size_t own = shell_of(room_.labels.label[i]);
      if (own == kShells || std::fabs(places_[i].height[own]) <= proud) continue;
      for (size_t s = 0; s < kShells; ++s) {
        if (s == own || objects[s] == 0 || std::fabs(places_[i].height[s]) >= on_plane || !places_[i].faces[s])
          continue;
        room_.labels.label[i] = label_[s];
        room_.labels.instance[i] = objects[s];
        ++changed;
        break;
      }
    }
    return changed;
  }

  /// Rows with the label of a shell, in front of its planes.
  std::vector<uint8_t> proud_rows() const {
    std::vector<uint8_t> rows(places_.size(), 0);
    std::array<double, kShells> all{}, before{};
    for (size_t i = 0; i < rows.size(); ++i) {
      const size_t s = shell_of(room_.labels.label[i]);
      if (s == kShells) continue;
      const double height = places_[i].height[s];
      rows[i] = height > (places_[i].faces[s] ? options_.parallel : options_.proud) * room_.extent && height < kFar;
      const double weight = opacity_of(room_.model, i);
      all[s] += weight;
      before[s] += rows[i] ? weight : 0;
    }
    for (size_t i = 0; i < rows.size(); ++i) {
      const size_t s = shell_of(room_.labels.label[i]);
      if (s < kShells && before[s] > options_.most_proud * all[s]) rows[i] = 0;
    }
    return rows;
  }

  bool may_join(uint32_t row, uint16_t label) const {
    const size_t s = shell_of(label);
    return s == kShells || std::fabs(places_[row].height[s]) <= options_.proud * room_.extent;
  }

 private:
  /// Index into kShellKinds; kShells for other classes.
  size_t shell_of(uint16_t label) const {
    return static_cast<size_t>(std::find(label_.begin(), label_.end(), label) - label_.begin());
  }

  LabelledGaussians& room_;
  const ShellLabelOptions& options_;
  std::vector<CarryingClass> classes_;
  std::vector<RoomPlane> planes_;
  std::array<uint16_t, kShells> label_{kNoLabel - 1, kNoLabel - 1, kNoLabel - 1};  ///< no class has that number
  std::vector<ShellPlace> places_;
};

}  // namespace

size_t correct_shell_labels(LabelledGaussians& room, const LabelSet& labels, const std::vector<Camera>& cameras,
                            ThreadPool& pool, RoomTree& tree, const ShellLabelOptions& options) {
  if (!room.has_labels()) return 0;
  ShellCorrection shell(room, labels, cameras, options);
  if (!shell.has_planes()) return 0;
  shell.measure(pool);
  size_t changed = shell.swap_planes();
  const std::vector<uint8_t> proud = shell.proud_rows();
  std::vector<uint8_t> crumbs = crumb_rows(room, {});
  for (size_t i = 0; i < crumbs.size(); ++i) crumbs[i] = crumbs[i] && !proud[i];
  const MayJoin may_join = [&](uint32_t row, uint16_t label) { return shell.may_join(row, label); };
  CrumbOptions join;
  join.color_sigma = options.color_sigma;
  join.rounds = options.reach;
  changed += join_neighbours(room, crumbs, join, pool, may_join, &tree);
  join.majority = 0;  // nothing is in front of a wall for long
  return changed + join_neighbours(room, proud, join, pool, may_join, &tree);
}

}  // namespace aligngs
