#include "edit/fill/hidden_places.h"

#include "edit/row_flags.h"

namespace aligngs {

HiddenPlaces::HiddenPlaces(const GaussianModel& model, const std::vector<uint8_t>& selected,
                           const std::vector<Camera>& cameras, double cube)
    : cameras_(cameras), removed_(model, selected, cube), rest_(model, inverted(selected), cube) {}

HiddenPlaces::Views HiddenPlaces::views_of(const Vec3d& place, bool always_free) const {
  Views views;
  std::vector<Vec3d> eyes;  // of the photos whose view the removed objects do not block
  for (const Camera& camera : cameras_) {
    const Vec3d local = camera.world_to_camera * place;
    if (!(local.z > 0) || !camera.contains(camera.project(local))) continue;
    const Vec3d eye = camera.centre();
    if (removed_.hides(eye, place))
      ++views.hidden;
    else
      eyes.push_back(eye);
  }
  // The removed objects are a small part of the room. Most places are not behind them, and nobody asks for the rest
  // there.
  if (views.hidden == 0 && !always_free) return views;
  for (const Vec3d& eye : eyes) views.free += !rest_.hides(eye, place);
  return views;
}

bool HiddenPlaces::from_all(const Vec3d& place) const {
  const Views views = views_of(place);
  return views.hidden > 0 && views.free == 0;
}

bool HiddenPlaces::from_most(const Vec3d& place) const {
  const Views views = views_of(place);
  return views.hidden > views.free;
}

bool HiddenPlaces::is_shown(const Vec3d& place) const { return views_of(place, true).free > 0; }

bool HiddenPlaces::is_open(const Vec3d& place) const {
  const Views views = views_of(place, true);
  return views.free > 0 && views.free >= views.hidden;
}

}  // namespace aligngs
