#include "edit/object_parts.h"

#include <algorithm>

#include "edit/taken_objects.h"
#include "gaussians/point_tree.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

/// Classes that have parts, and the classes of their parts.
constexpr const char* kGrowing[] = {"plant", "flower", "tree", "palm"};
constexpr const char* kHolding[] = {"pot", "vase"};

/// One flag per class.
template <class Names>
std::vector<uint8_t> classes_of(const LabelSet& labels, const Names& names) {
  std::vector<uint8_t> flags(labels.classes.size(), 0);
  for (const char* name : names) {
    if (const int label = labels.find(name); label >= 0) flags[static_cast<size_t>(label)] = 1;
  }
  return flags;
}

}  // namespace

std::vector<Instance> parts_of(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                               const LabelSet& labels, const std::optional<Vec3d>& up,
                               const ObjectPartSettings& settings) {
  std::vector<Instance> parts;
  if (!room.has_labels()) return parts;
  const GaussianModel& model = room.model;
  const auto row_of = [&](size_t i) {
    return Vec3f{model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]};
  };
  const std::vector<uint8_t> growing = classes_of(labels, kGrowing), holding = classes_of(labels, kHolding);
  // A selection of other things may have a few leaves, as a wall behind a plant. They are no selected plant.
  const TakenObjects whole(room.labels, selected);
  std::vector<Vec3f> places;
  for (uint32_t i = 0; i < selected.size(); ++i) {
    const uint16_t label = room.labels.label[i];
    if (selected[i] && label < growing.size() && growing[label] && whole.holds_row(i)) places.push_back(row_of(i));
  }
  if (places.empty()) return parts;
  const PointTree tree(std::move(places));
  std::vector<PointTree::Neighbour> near;
  for (const Instance& o : list_instances(model, room.labels)) {
    if (!holding[static_cast<size_t>(o.label)]) continue;
    size_t touching = 0, taken = 0;
    double above = 0;  // of the leaves that touch, over the middle of the pot
    for (size_t i = 0; i < model.size(); ++i) {
      if (room.labels.label[i] != o.label || room.labels.instance[i] != o.number) continue;
      taken += selected[i];
      tree.nearest(row_of(i), 1, near);
      if (near[0].distance >= settings.contact * room.extent) continue;
      ++touching;
      if (up) above += dot(*up, (tree.point(near[0].index) - o.centre).cast<double>());
    }
    if (above >= 0 && touching >= settings.least_touching &&
        static_cast<double>(taken) < settings.most * static_cast<double>(o.gaussians))
      parts.push_back(o);
  }
  return parts;
}

}  // namespace aligngs
