#include "edit/listed_objects.h"

#include <fmt/format.h>

#include "edit/relation/room_objects.h"

namespace aligngs {

std::vector<ListedObject> listed_objects(const EditableRoom& room) {
  const RoomObjects objects(room.gaussians, room.labels, {room.up, {}}, 1);
  std::vector<ListedObject> out;
  for (size_t i = 0; i < objects.size(); ++i) {
    ListedObject listed{objects[i], objects.name(i), {}};
    if (room.up) {
      const ObjectBox& box = objects.box(i);
      listed.sides = Vec3d{box.length, box.width, box.height()};
    }
    out.push_back(std::move(listed));
  }
  return out;
}

std::string sides_text(const Vec3d& sides, std::optional<double> metres) {
  if (!metres) return fmt::format("{:.2f} x {:.2f} x {:.2f} units", sides.x, sides.y, sides.z);
  const double cm = 100 * *metres;
  return fmt::format("{:.0f} x {:.0f} x {:.0f} cm", cm * sides.x, cm * sides.y, cm * sides.z);
}

}  // namespace aligngs
