#include "edit/replace_object.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/spherical_harmonics.h"
#include "edit/export/moved_room.h"
#include "edit/move_objects.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

constexpr double kStrays = 0.01;  ///< share of the Gaussians on each side that a box leaves out

using Axes = std::array<Vec3d, 3>;  ///< right, up, front

struct Range {
  double low = 0, high = 0;
  double size() const { return high - low; }
  double middle() const { return 0.5 * (low + high); }
};

Axes axes_of(const Vec3d& up, Vec3d front) {
  front = front - up * dot(front, up);
  constexpr double kShortest = 1e-6;
  if (norm(front) < kShortest) front = cross(std::fabs(up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, up);
  front = normalized(front);
  return {cross(up, front), up, front};
}

/// Extents along some axes; all Gaussians where nothing is selected.
std::array<Range, 3> ranges_of(const GaussianModel& model, const std::vector<uint8_t>& selected, const Axes& axes) {
  std::array<Range, 3> out;
  for (size_t a = 0; a < 3; ++a) {
    std::vector<double> values;
    for (size_t i = 0; i < model.size(); ++i) {
      if (selected.empty() || selected[i]) values.push_back(dot(axes[a], position_of(model, i)));
    }
    std::sort(values.begin(), values.end());
    const size_t left_out = static_cast<size_t>(kStrays * static_cast<double>(values.size()));
    out[a] = {values[left_out], values[values.size() - 1 - left_out]};
  }
  return out;
}

Mat3d turned_from(const Axes& from, const Axes& to) {
  Mat3d out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      out(r, c) = 0;
      for (size_t a = 0; a < 3; ++a) out(r, c) += to[a][r] * from[a][c];
    }
  }
  return out;
}

Vec3d turned_about(const Vec3d& axis, const Vec3d& v, double degrees) {
  const double angle = degrees * 3.14159265358979323846 / 180, c = std::cos(angle), s = std::sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

}  // namespace

Similarity placement_of(const EditableRoom& room, const std::vector<uint8_t>& selected, const InsertedObject& object,
                        double turn, bool fit) {
  Similarity to;
  if (object.placed) return to;
  if (!room.up)
    throw_bad_input({}, "--replace", "this room does not tell which way is up",
                    "give the scene an up direction: `up` in scene.json");
  const std::optional<Vec3d> wall = wall_behind(room, selected);
  const Axes target = axes_of(*room.up, wall.value_or(Vec3d{}));
  Axes own = axes_of(object.up, object.front.value_or(Vec3d{}));
  own[2] = turned_about(own[1], own[2], -turn);
  own[0] = cross(own[1], own[2]);
  to.rotation = turned_from(own, target);
  const std::array<Range, 3> old = ranges_of(room.gaussians.model, selected, target),
                             fresh = ranges_of(object.room.gaussians.model, {}, own);
  if (fit) {
    to.scale = 1e300;
    for (size_t a = 0; a < 3; ++a) {
      if (fresh[a].size() > 0) to.scale = std::min(to.scale, old[a].size() / fresh[a].size());
    }
    if (!(to.scale > 0 && to.scale < 1e300))
      throw_bad_input({}, "--fit", "the object or the selection has no size", "leave out --fit");
  }
  for (size_t a = 0; a < 3; ++a) {
    const bool at_low = a == 1 || (a == 2 && wall);  // the foot, and the back at a wall
    const double place = at_low ? old[a].low - to.scale * fresh[a].low : old[a].middle() - to.scale * fresh[a].middle();
    to.translation += target[a] * place;
  }
  return to;
}

EditableRoom labelled_for(const EditableRoom& room, const std::vector<uint8_t>& selected,
                          const InsertedObject& object) {
  const LabelledGaussians& g = room.gaussians;
  std::map<uint16_t, size_t> counts;
  size_t source = 0;
  for (size_t i = 0; i < selected.size(); ++i) {
    if (selected[i] && counts.empty()) source = i;
    if (selected[i]) ++counts[g.labels.label[i]];
  }
  uint16_t label = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
                     return a.second < b.second;
                   })->first;
  const int own = object.class_name.empty() ? -1 : room.labels.find(object.class_name);
  if (own >= 0 && g.has_labels()) label = static_cast<uint16_t>(own);
  for (size_t i = 0; i < g.labels.label.size(); ++i) {
    if (g.labels.label[i] != label) continue;
    source = i;
    break;
  }
  EditableRoom piece = object.room;
  GaussianModel& model = piece.gaussians.model;
  const size_t n = model.size(), used = size_t(3) * static_cast<size_t>(sh_coefficient_count(g.model.sh_degree)),
               all = size_t(3) * kShCoefficients;
  for (size_t i = 0; i < n; ++i) std::fill(model.sh.begin() + i * all + used, model.sh.begin() + (i + 1) * all, 0.f);
  const size_t channels = static_cast<size_t>(g.model.semantic_channels);
  model.semantic_channels = g.model.semantic_channels;
  model.semantics.clear();
  for (size_t i = 0; i < n; ++i) {
    const auto row = g.model.semantics.begin() + static_cast<std::ptrdiff_t>(channels * source);
    model.semantics.insert(model.semantics.end(), row, row + static_cast<std::ptrdiff_t>(channels));
  }
  piece.gaussians.labels.label.assign(n, label);
  piece.gaussians.labels.instance.assign(n, label == kNoLabel ? 0 : 1);
  piece.gaussians.labels.confidence.assign(n, 255);
  if (!g.soft.label.empty()) {
    for (size_t i = 0; i < n * SoftLabels::kTop; ++i) {
      piece.gaussians.soft.label.push_back(i % SoftLabels::kTop == 0 ? label : kNoLabel);
      piece.gaussians.soft.probability.push_back(i % SoftLabels::kTop == 0 ? 1.f : 0.f);
    }
  }
  piece.origins.assign(n, {room.origins[source].row, true});
  number_anew(piece, room);
  TriangleMesh& mesh = piece.mesh;
  mesh.normals.resize(mesh.vertices.size(), Vec3f{0, 0, 1});
  mesh.colors.resize(mesh.vertices.size(), {128, 128, 128});
  mesh.labels.assign(mesh.vertices.size(), label);
  if (room.mesh.vertices.empty()) mesh = {};
  return piece;
}

}  // namespace aligngs
