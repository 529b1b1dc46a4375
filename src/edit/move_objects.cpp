#include "edit/move_objects.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/append.h"
#include "core/error.h"
#include "edit/mesh_rows.h"
#include "edit/mesh_selection.h"
#include "edit/object_rows.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/point_tree.h"

namespace aligngs {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

/// Middle of the box around the selected Gaussians.
Vec3d middle_of(const GaussianModel& model, const std::vector<uint8_t>& selected) {
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (size_t i = 0; i < selected.size(); ++i) {
    if (!selected[i]) continue;
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min<double>(low[a], model.positions[3 * i + static_cast<size_t>(a)]);
      high[a] = std::max<double>(high[a], model.positions[3 * i + static_cast<size_t>(a)]);
    }
  }
  return 0.5 * (low + high);
}

/// Rotation about a unit axis (Rodrigues' formula).
Mat3d rotation_about(const Vec3d& axis, double degrees) {
  const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
  Mat3d out;
  for (int column = 0; column < 3; ++column) {
    Vec3d e;
    e[column] = 1;
    const Vec3d r = e * c + cross(axis, e) * s + axis * (dot(axis, e) * (1 - c));
    for (int row = 0; row < 3; ++row) out(row, column) = r[row];
  }
  return out;
}

Vec3d up_of(const EditableRoom& room) {
  if (!room.up)
    throw_bad_input({}, "--move", "this room does not tell which way is up",
                    "give the scene an up direction: `up` in scene.json");
  return *room.up;
}

/// Unit, level: from the objects to the mean place of the cameras.
Vec3d toward_viewer(const EditableRoom& room, const Vec3d& up, const Vec3d& middle) {
  if (room.cameras.empty())
    throw_bad_input({}, "--move", "no camera of this room is known, so that nothing is left or right",
                    "give --move 0,UP,0 only");
  Vec3d toward = -middle;
  for (const Camera& camera : room.cameras)
    toward += camera.centre() * (1.0 / static_cast<double>(room.cameras.size()));
  toward -= up * dot(toward, up);
  constexpr double kShortest = 1e-6;  // scene units
  if (norm(toward) < kShortest)
    throw_bad_input({}, "--move", "the cameras are right above the objects, so that nothing is left or right",
                    "select fewer objects");
  return normalized(toward);
}

}  // namespace

Similarity motion_in_world(const EditableRoom& room, const std::vector<uint8_t>& selected, const ObjectMotion& motion) {
  const Vec3d up = up_of(room), middle = middle_of(room.gaussians.model, selected);
  Similarity out;
  Vec3d shift = up * motion.shift.y;
  if (motion.shift.x != 0 || motion.shift.z != 0) {
    const Vec3d toward = toward_viewer(room, up, middle);
    shift += cross(up, toward) * motion.shift.x + toward * motion.shift.z;
  }
  out.rotation = rotation_about(up, motion.turn);
  out.translation = middle + shift - out.rotation * middle;
  return out;
}

double step_aside(const EditableRoom& room, const std::vector<uint8_t>& selected) {
  constexpr double kGap = 0.02;  // / extent: 6 cm in a room
  const Vec3d up = up_of(room), right = cross(up, toward_viewer(room, up, middle_of(room.gaussians.model, selected)));
  double low = 1e300, high = -1e300;
  for (size_t i = 0; i < selected.size(); ++i) {
    if (!selected[i]) continue;
    const float* p = &room.gaussians.model.positions[3 * i];
    const double x = dot(right, Vec3d{p[0], p[1], p[2]});
    low = std::min(low, x);
    high = std::max(high, x);
  }
  return high - low + kGap * room.gaussians.extent;
}

EditableRoom piece_of(const EditableRoom& room, const std::vector<uint8_t>& selected,
                      const std::vector<uint8_t>& vertices) {
  EditableRoom piece;
  piece.labels = room.labels;
  piece.up = room.up;
  piece.gaussians = keep_rows(room.gaussians, selected);
  for (size_t i = 0; i < selected.size(); ++i) {
    if (selected[i]) piece.origins.push_back(room.origins[i]);
  }
  if (!room.mesh.vertices.empty()) piece.mesh = submesh(room.mesh, vertices, 1);
  return piece;
}

void claim_neighbours(EditableRoom& piece, const EditableRoom& room) {
  GaussianLabels& labels = piece.gaussians.labels;
  const std::map<ObjectName, std::vector<uint32_t>> all = rows_of_objects(room.gaussians.labels);
  std::vector<uint32_t> own, others;
  for (const auto& [name, rows] : rows_of_objects(labels)) {
    const bool is_whole = name.second != 0 && 2 * rows.size() >= all.at(name).size();
    std::vector<uint32_t>& list = is_whole ? own : others;
    list.insert(list.end(), rows.begin(), rows.end());
  }
  if (own.empty()) return;
  std::vector<Vec3f> points;
  for (const uint32_t i : own) points.push_back(position_of(piece.gaussians.model, i).cast<float>());
  const PointTree tree(std::move(points));
  std::vector<PointTree::Neighbour> near;
  for (const uint32_t i : others) {
    tree.nearest(position_of(piece.gaussians.model, i).cast<float>(), 1, near);
    const uint32_t nearest = own[near.front().index];
    labels.label[i] = labels.label[nearest];
    labels.instance[i] = labels.instance[nearest];
  }
}

void add_piece(EditableRoom& room, const EditableRoom& piece) {
  GaussianModel& m = room.gaussians.model;
  const GaussianModel& p = piece.gaussians.model;
  append(m.positions, p.positions);
  append(m.log_scales, p.log_scales);
  append(m.rotations, p.rotations);
  append(m.opacity_logits, p.opacity_logits);
  append(m.sh, p.sh);
  append(m.semantics, p.semantics);
  append(room.gaussians.labels.label, piece.gaussians.labels.label);
  append(room.gaussians.labels.instance, piece.gaussians.labels.instance);
  append(room.gaussians.labels.confidence, piece.gaussians.labels.confidence);
  append(room.gaussians.soft.label, piece.gaussians.soft.label);
  append(room.gaussians.soft.probability, piece.gaussians.soft.probability);
  for (const GaussianOrigin& origin : piece.origins) room.origins.push_back({origin.row, true});
  append_mesh(room, piece.mesh);
}

void number_anew(EditableRoom& piece, const EditableRoom& room) {
  std::map<uint16_t, uint16_t> last;  // of each class
  for (size_t i = 0; i < room.gaussians.labels.label.size(); ++i) {
    uint16_t& number = last[room.gaussians.labels.label[i]];
    number = std::max(number, room.gaussians.labels.instance[i]);
  }
  std::map<std::pair<uint16_t, uint16_t>, uint16_t> fresh;
  for (size_t i = 0; i < piece.gaussians.labels.label.size(); ++i) {
    const uint16_t label = piece.gaussians.labels.label[i];
    uint16_t& instance = piece.gaussians.labels.instance[i];
    if (instance == 0) continue;
    const auto [it, is_new] = fresh.try_emplace({label, instance}, 0);
    if (is_new) it->second = ++last[label];
    instance = it->second;
  }
}

}  // namespace aligngs
