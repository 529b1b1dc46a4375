// The objects of a room with their places and the gaps between them, for words such as "largest" and "next to".
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "edit/relation/object_box.h"
#include "edit/selection.h"
#include "gaussians/point_tree.h"
#include "scene/label_set.h"

namespace aligngs {

/// Directions that "left" and "highest" need.
struct Viewpoint {
  std::optional<Vec3d> up;     ///< unit, world
  std::optional<Vec3d> place;  ///< world; the mean place of the photos' cameras
};

/// Boxes and gaps are found when they are asked for.
class RoomObjects {
 public:
  /// `room` and `labels` outlive this. `metre` is the length of a metre in scene units.
  RoomObjects(const LabelledGaussians& room, const LabelSet& labels, const Viewpoint& viewpoint, double metre);
  ~RoomObjects();

  size_t size() const { return objects_.size(); }
  const Instance& operator[](size_t i) const { return objects_[i].instance; }  ///< by class, then by number
  const LabelledGaussians& room() const { return room_; }
  const LabelSet& labels() const { return labels_; }
  const Viewpoint& viewpoint() const { return viewpoint_; }
  const BoxAxes& axes() const { return axes_; }
  double metre() const { return metre_; }

  std::string name(size_t i) const;                             ///< "pillow#2"
  std::string names(const std::vector<size_t>& objects) const;  ///< "pillow#1, pillow#2"; many are cut short
  const std::vector<uint32_t>& rows(size_t i) const { return *objects_[i].rows; }
  const ObjectBox& box(size_t i) const;
  /// Places of the object's solid Gaussians in its box, one for each cube of 3 cm.
  const std::vector<Vec3f>& places(size_t i) const;
  /// The gap between two objects in metres. Two of a hundred places may be nearer: strays, and labels that leak.
  double gap(size_t a, size_t b) const;

 private:
  struct Entry {
    Instance instance;
    const std::vector<uint32_t>* rows = nullptr;
    mutable std::optional<ObjectBox> box;
    mutable std::optional<std::vector<Vec3f>> places;
    mutable std::unique_ptr<PointTree> tree;
  };
  const PointTree& tree(size_t i) const;

  const LabelledGaussians& room_;
  const LabelSet& labels_;
  Viewpoint viewpoint_;
  BoxAxes axes_;
  double metre_;
  std::map<std::pair<uint16_t, uint16_t>, std::vector<uint32_t>> rows_;  ///< by class and number
  std::vector<Entry> objects_;
};

/// Unit, level, to the right of a person at the viewpoint who looks at a place; Error{kBadInput} where no direction is
/// known.
Vec3d right_of_viewer(const Viewpoint& viewpoint, const Vec3d& place);

/// Up of a viewpoint; Error{kBadInput} where it is not known.
Vec3d up_of_viewer(const Viewpoint& viewpoint);

}  // namespace aligngs
