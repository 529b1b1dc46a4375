#include "edit/export/object_meshes.h"

#include <fmt/format.h>

#include <map>
#include <memory>

#include "core/chosen_rows.h"
#include "gaussians/point_tree.h"

namespace aligngs {
namespace {

constexpr size_t kGrain = 4096;  // vertices per chunk

/// The object number of a vertex of a class, from the nearest Gaussian of that class.
class NearestObject {
 public:
  explicit NearestObject(const LabelledGaussians& g) {
    std::map<int, std::vector<Vec3f>> points;
    for (size_t i = 0; i < g.model.size(); ++i) {
      if (g.labels.label[i] == kNoLabel || g.labels.instance[i] == 0) continue;
      points[g.labels.label[i]].push_back(
          {g.model.positions[3 * i], g.model.positions[3 * i + 1], g.model.positions[3 * i + 2]});
      instances_[g.labels.label[i]].push_back(g.labels.instance[i]);
    }
    for (auto& [label, p] : points) trees_.emplace(label, PointTree(std::move(p)));
  }
  int of(int label, const Vec3f& place, std::vector<PointTree::Neighbour>& scratch) const {
    const auto tree = trees_.find(label);
    if (tree == trees_.end()) return 0;
    tree->second.nearest(place, 1, scratch);
    return scratch.empty() ? 0 : instances_.at(label)[scratch[0].index];
  }

 private:
  std::map<int, PointTree> trees_;
  std::map<int, std::vector<uint16_t>> instances_;
};

uint16_t majority(uint16_t a, uint16_t b, uint16_t c) { return b == c ? b : a; }

}  // namespace

std::vector<ObjectMesh> object_meshes(const EditableRoom& room, ThreadPool& pool) {
  return object_meshes(room.mesh, room.gaussians, room.labels, pool);
}

std::vector<ObjectMesh> object_meshes(const TriangleMesh& mesh, const LabelledGaussians& gaussians,
                                      const LabelSet& classes, ThreadPool& pool) {
  std::vector<uint16_t> labels = mesh.labels, instances(mesh.vertices.size(), 0);
  labels.resize(mesh.vertices.size(), kNoLabel);
  for (uint16_t& label : labels) {
    if (label >= classes.size()) label = kNoLabel;
  }
  const NearestObject nearest(gaussians);
  pool.parallel_for(labels.size(), kGrain, [&](size_t begin, size_t end, int) {
    std::vector<PointTree::Neighbour> scratch;
    for (size_t v = begin; v < end; ++v) {
      if (labels[v] != kNoLabel) instances[v] = static_cast<uint16_t>(nearest.of(labels[v], mesh.vertices[v], scratch));
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
