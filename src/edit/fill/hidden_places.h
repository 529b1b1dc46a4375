// Places that photos could not show because of what is removed now.
#pragma once

#include <vector>

#include "edit/fill/solid_space.h"
#include "scene/camera.h"

namespace aligngs {

class HiddenPlaces {
 public:
  /// `selected` marks the rows that go; `cube` is the edge of the cubes that tell what hides what, scene units. The
  /// cameras must outlive this.
  HiddenPlaces(const GaussianModel& model, const std::vector<uint8_t>& selected, const std::vector<Camera>& cameras,
               double cube);

  /// The removed objects hid the place from some photo, and no photo shows it.
  bool from_all(const Vec3d& place) const;
  /// They hid it from more photos than show it: a photo or two may look past an object's edge.
  bool from_most(const Vec3d& place) const;
  /// Some photo shows it.
  bool is_shown(const Vec3d& place) const;
  /// At least as many photos look at the place past everything as the removed objects keep from it. Without a surface
  /// there, those photos looked through it.
  bool is_open(const Vec3d& place) const;

 private:
  struct Views {
    /// photos whose view of the place the removed objects block, and those that show it; without the former the latter are
    /// counted on demand only
    int hidden = 0, free = 0;
  };
  Views views_of(const Vec3d& place, bool always_free = false) const;

  const std::vector<Camera>& cameras_;
  SolidSpace removed_, rest_;
};

}  // namespace aligngs
