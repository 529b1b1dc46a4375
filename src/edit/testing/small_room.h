// A small room in memory: a floor with two pillows and a box on it, each thing with Gaussians and a mesh.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "edit/apply_edit.h"
#include "edit/mesh_rows.h"

namespace aligngs::small_room {

inline constexpr int kFloor = 3, kBox = 41, kPillow = 57;  ///< ADE20K class numbers
inline constexpr float kSpacing = 0.04f;                   ///< metres between Gaussians
inline constexpr double kExtent = 3;                       ///< metres, as of a real room

inline EditOperation edit_of(EditKind kind, const std::string& select, bool fill = false) {
  EditOperation edit;
  edit.kind = kind;
  edit.select = select;
  edit.fill = fill;
  return edit;
}

/// Adds one flat Gaussian that faces `normal`.
inline void add_gaussian(GaussianModel& model, const Vec3f& position, const Vec3f& normal, const Vec3f& color,
                         int label) {
  const size_t i = model.size();
  model.resize(i + 1);
  for (size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    model.positions[3 * i + a] = position[axis];
    model.log_scales[3 * i + a] = std::log(a == 2 ? 0.002f : 0.5f * kSpacing);
    model.sh[3 * kShCoefficients * i + a] = (color[axis] - 0.5f) / static_cast<float>(kSh0);
  }
  const Quaternionf q = quaternion_from_z_to(normal);
  const float rotation[4] = {q.w, q.x, q.y, q.z};
  std::copy_n(rotation, 4, &model.rotations[4 * i]);
  model.opacity_logits[i] = 3;
  if (label >= 0 && model.semantic_channels > 0)
    model.semantics[i * static_cast<size_t>(model.semantic_channels) + static_cast<size_t>(label)] = 8;
}

/// A box without bottom standing on y = 0, up is -y as in a camera's world; Gaussians on its faces and the same as
/// mesh.
inline void add_box(GaussianModel& model, TriangleMesh& mesh, const Vec3f& low, const Vec3f& high, const Vec3f& color,
                    int label) {
  struct Face {
    int axis;
    float at, sign;
  };
  const Face faces[] = {{0, low.x, -1}, {0, high.x, 1}, {2, low.z, -1}, {2, high.z, 1}, {1, low.y, -1}};
  for (const Face& face : faces) {
    const int u = face.axis == 0 ? 1 : 0, v = face.axis == 2 ? 1 : 2;
    Vec3f normal;
    normal[face.axis] = face.sign;
    const int columns = static_cast<int>(std::lround((high[u] - low[u]) / kSpacing)),
              rows = static_cast<int>(std::lround((high[v] - low[v]) / kSpacing));
    const auto place = [&](float i, float j) {
      Vec3f p;
      p[face.axis] = face.at;
      p[u] = low[u] + i * kSpacing;
      p[v] = low[v] + j * kSpacing;
      return p;
    };
    const uint32_t base = static_cast<uint32_t>(mesh.vertices.size());
    for (int j = 0; j <= rows; ++j) {
      for (int i = 0; i <= columns; ++i) {
        mesh.vertices.push_back(place(static_cast<float>(i), static_cast<float>(j)));
        mesh.normals.push_back(normal);
        mesh.colors.push_back({static_cast<uint8_t>(std::lround(255 * color.x)),
                               static_cast<uint8_t>(std::lround(255 * color.y)),
                               static_cast<uint8_t>(std::lround(255 * color.z))});
        mesh.labels.push_back(static_cast<uint16_t>(label));
      }
    }
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) {
        add_gaussian(model, place(static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f), normal, color, label);
        const uint32_t a = base + static_cast<uint32_t>(j * (columns + 1) + i), b = a + 1,
                       c = a + static_cast<uint32_t>(columns) + 1;
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({b, c + 1, c});
      }
    }
  }
}

/// Floor of 2.4 m x 1.6 m with holes under things, as no camera sees the floor there.
inline EditableRoom make(ThreadPool& pool) {
  GaussianModel model;
  model.semantic_channels = 150;
  EditableRoom room;
  room.labels = ade20k_labels();
  room.up = Vec3d{0, -1, 0};
  struct Thing {
    Vec3f low, high, color;
    int label;
  };
  const Thing things[] = {{{-0.8f, -0.12f, -0.2f}, {-0.32f, 0, 0.28f}, {0.2f, 0.4f, 0.8f}, kPillow},
                          {{0.4f, -0.12f, -0.2f}, {0.72f, 0, 0.12f}, {0.2f, 0.4f, 0.8f}, kPillow},
                          {{-0.2f, -0.4f, 0.2f}, {0.2f, 0, 0.6f}, {0.8f, 0.7f, 0.5f}, kBox}};
  for (const Thing& t : things) add_box(model, room.mesh, t.low, t.high, t.color, t.label);
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 60; ++i) {
      const Vec3f p{-1.2f + (static_cast<float>(i) + 0.5f) * kSpacing, 0,
                    -0.8f + (static_cast<float>(j) + 0.5f) * kSpacing};
      bool hidden = false;
      for (const Thing& t : things) hidden |= p.x > t.low.x && p.x < t.high.x && p.z > t.low.z && p.z < t.high.z;
      if (hidden) continue;
      add_gaussian(model, p, {0, -1, 0}, {0.6f, 0.5f, 0.4f}, kFloor);
      const uint32_t base = static_cast<uint32_t>(room.mesh.vertices.size());
      for (int corner = 0; corner < 4; ++corner) {
        room.mesh.vertices.push_back(
            {p.x + (corner % 2 ? 0.5f : -0.5f) * kSpacing, 0, p.z + (corner / 2 ? 0.5f : -0.5f) * kSpacing});
        room.mesh.normals.push_back({0, -1, 0});
        room.mesh.colors.push_back({153, 128, 102});
        room.mesh.labels.push_back(kFloor);
      }
      room.mesh.triangles.push_back({base, base + 1, base + 2});
      room.mesh.triangles.push_back({base + 1, base + 3, base + 2});
    }
  }
  room.gaussians = label_objects(std::move(model), room.labels, kExtent, pool);
  for (uint32_t i = 0; i < room.gaussians.model.size(); ++i) room.origins.push_back({i, false, i});
  number_mesh(room);
  return room;
}

inline size_t count_label(const EditableRoom& room, int label) {
  size_t n = 0;
  for (const uint16_t l : room.gaussians.labels.label) n += l == label;
  return n;
}

/// Boxes of Gaussians with classes and numbers in an otherwise empty room; up is -y.
class LabelledBoxes : public testing::Test {
 protected:
  LabelledBoxes() {
    room_.named = true;  // as a finished training: labels, and no semantic rows
    room_.extent = kExtent;
    room_.labels.label_set = ade20k_labels().name;
  }
  /// First row of the new box, and the end.
  std::pair<size_t, size_t> add(const Vec3f& low, const Vec3f& high, int label, int number = 1) {
    TriangleMesh mesh;
    const size_t first = room_.model.size();
    add_box(room_.model, mesh, low, high, {0.5f, 0.5f, 0.5f}, label);
    room_.labels.label.resize(room_.model.size(), static_cast<uint16_t>(label));
    room_.labels.instance.resize(room_.model.size(), static_cast<uint16_t>(number));
    room_.labels.confidence.resize(room_.model.size(), 255);
    return {first, room_.model.size()};
  }
  /// Numbers of the rows of a box.
  std::vector<int> numbers(std::pair<size_t, size_t> rows) const {
    return {room_.labels.instance.begin() + static_cast<std::ptrdiff_t>(rows.first),
            room_.labels.instance.begin() + static_cast<std::ptrdiff_t>(rows.second)};
  }
  LabelledGaussians room_;
};

}  // namespace aligngs::small_room
