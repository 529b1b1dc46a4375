#include "edit/export/object_meshes.h"

#include <fmt/format.h>

#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "core/chosen_rows.h"
#include "edit/object_rows.h"
#include "gaussians/point_tree.h"

namespace aligngs {
namespace {

constexpr size_t kGrain = 4096;  // vertices per chunk

/// The object of a vertex, from the numbered Gaussians around it.
class NearestObject {
 public:
  NearestObject(const LabelledGaussians& g, StrayVertices strays)
      : near_(static_cast<float>(kNear * g.extent)), strays_(strays) {
    std::map<uint16_t, std::vector<Vec3f>> points;
    std::vector<Vec3f> all;
    for (size_t i = 0; i < g.model.size(); ++i) {
      const uint16_t label = g.labels.label[i];
      if (label == kNoLabel || g.labels.instance[i] == 0) continue;
      all.push_back({g.model.positions[3 * i], g.model.positions[3 * i + 1], g.model.positions[3 * i + 2]});
      names_.push_back({label, g.labels.instance[i]});
      points[label].push_back(all.back());
      instances_[label].push_back(g.labels.instance[i]);
    }
    for (auto& [label, p] : points) trees_.emplace(label, PointTree(std::move(p)));
    if (!all.empty()) all_.emplace(std::move(all));
  }

  /// The nearest object of a vertex's own class. A vertex far from it, at the place of another object, is a stray.
  ObjectName of(uint16_t label, const Vec3f& place, std::vector<PointTree::Neighbour>& scratch) const {
    ObjectName own{label, 0};
    float distance = std::numeric_limits<float>::infinity();
    const auto tree = trees_.find(label);
    if (tree != trees_.end()) {
      tree->second.nearest(place, 1, scratch);
      own.second = instances_.at(label)[scratch.front().index];
      distance = scratch.front().distance;
    }
    if (distance <= near_ || !all_) return own;
    all_->nearest(place, 1, scratch);
    if (distance <= scratch.front().distance + near_) return own;
    return strays_ == StrayVertices::kJoinOthers ? names_[scratch.front().index] : ObjectName{label, 0};
  }

 private:
  static constexpr double kNear = 0.017;  ///< of the extent: 5 cm, by which labels of mesh and Gaussians may differ
  float near_;
  StrayVertices strays_;
  std::map<uint16_t, PointTree> trees_;
  std::map<uint16_t, std::vector<uint16_t>> instances_;
  std::optional<PointTree> all_;
  std::vector<ObjectName> names_;  ///< of the points of all_
};

uint16_t majority(uint16_t a, uint16_t b, uint16_t c) { return b == c ? b : a; }

}  // namespace

std::vector<ObjectMesh> object_meshes(const EditableRoom& room, ThreadPool& pool, StrayVertices strays) {
  return object_meshes(room.mesh, room.gaussians, room.labels, pool, strays);
}

std::vector<ObjectMesh> object_meshes(const TriangleMesh& mesh, const LabelledGaussians& gaussians,
                                      const LabelSet& classes, ThreadPool& pool, StrayVertices strays) {
  std::vector<uint16_t> labels = mesh.labels, instances(mesh.vertices.size(), 0);
  labels.resize(mesh.vertices.size(), kNoLabel);
  for (uint16_t& label : labels) {
    if (label >= classes.size()) label = kNoLabel;
  }
  const NearestObject nearest(gaussians, strays);
  pool.parallel_for(labels.size(), kGrain, [&](size_t begin, size_t end, int) {
    std::vector<PointTree::Neighbour> scratch;
    for (size_t v = begin; v < end; ++v) {
      if (labels[v] == kNoLabel) continue;
      std::tie(labels[v], instances[v]) = nearest.of(labels[v], mesh.vertices[v], scratch);
    }
  });
  std::map<std::pair<uint16_t, uint16_t>, std::vector<uint32_t>> triangles;  // kNoLabel sorts last
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corners = mesh.triangles[t];
    const uint16_t label = majority(labels[corners[0]], labels[corners[1]], labels[corners[2]]);
    uint16_t instance = 0;
    for (const uint32_t v : corners) {
      if (label != kNoLabel && labels[v] == label) instance = instances[v];
    }
    triangles[{label, instance}].push_back(t);
  }
  std::vector<ObjectMesh> out;
  std::vector<uint32_t> moved(mesh.vertices.size(), 0xffffffffu);
  for (const auto& [key, members] : triangles) {
    ObjectMesh object;
    if (key.first == kNoLabel) {
      object.name = "unlabelled";
    } else {
      object.label = key.first;
      object.instance = key.second;
      object.class_name = classes.classes[key.first].name;
      object.name = fmt::format("{}.{:03}", object.class_name, object.instance);
    }
    std::vector<uint32_t> used;
    object.mesh.triangles.reserve(members.size());
    for (const uint32_t t : members) {
      std::array<uint32_t, 3> triangle;
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t v = mesh.triangles[t][k];
        if (moved[v] == 0xffffffffu) {
          moved[v] = static_cast<uint32_t>(used.size());
          used.push_back(v);
        }
        triangle[k] = moved[v];
      }
      object.mesh.triangles.push_back(triangle);
    }
    for (const uint32_t v : used) moved[v] = 0xffffffffu;
    object.mesh.vertices = chosen_rows(mesh.vertices, used);
    if (!mesh.normals.empty()) object.mesh.normals = chosen_rows(mesh.normals, used);
    if (!mesh.colors.empty()) object.mesh.colors = chosen_rows(mesh.colors, used);
    out.push_back(std::move(object));
  }
  return out;
}

}  // namespace aligngs
