#include "edit/export/furniture_points.h"

#include <utility>

#include "edit/export/object_meshes.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"
#include "room/room_classes.h"

namespace aligngs {
namespace {

/// The mean probability of an object's class, by class and instance.
double confidence_of(const LabelledGaussians& g, int label, int instance) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < g.labels.label.size(); ++i) {
    if (g.labels.label[i] != label || g.labels.instance[i] != instance) continue;
    sum += g.labels.confidence[i] / 255.0;
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

}  // namespace

std::vector<ObjectPoints> furniture_points(const EditableRoom& room, ThreadPool& pool) {
  const std::vector<RoomClass> classes = room_classes(room.labels);
  const LabelledGaussians& g = room.gaussians;
  std::vector<ObjectPoints> out;
  if (!g.has_labels()) return out;
  const bool has_mesh = !room.mesh.empty() && !room.mesh.labels.empty();
  const auto is_boxed = [&](int label, bool from_mesh) {
    if (label < 0 || static_cast<size_t>(label) >= classes.size()) return false;
    const RoomClass& c = classes[static_cast<size_t>(label)];
    return c.furniture && from_mesh == (has_mesh && !c.leafy);
  };
  if (has_mesh) {
    for (const ObjectMesh& object : object_meshes(room, pool, StrayVertices::kNoObject)) {
      if (!is_boxed(object.label, true) || object.instance == 0) continue;
      ObjectPoints points{object.class_name, object.instance, {}, confidence_of(g, object.label, object.instance)};
      for (const Vec3f& p : object.mesh.vertices) points.points.push_back(p.cast<double>());
      out.push_back(std::move(points));
    }
  }
  for (const Instance& object : list_instances(g.model, g.labels)) {
    if (!is_boxed(object.label, false)) continue;
    ObjectPoints points{room.labels.classes[static_cast<size_t>(object.label)].name,
                        object.number,
                        {},
                        confidence_of(g, object.label, object.number)};
    for (size_t i = 0; i < g.model.size(); ++i) {
      if (g.labels.label[i] != object.label || g.labels.instance[i] != object.number ||
          opacity_of(g.model, i) < kSolidOpacity)
        continue;
      points.points.push_back(position_of(g.model, i));
    }
    out.push_back(std::move(points));
  }
  return out;
}

}  // namespace aligngs
