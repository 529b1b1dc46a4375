#include "edit/listed_objects.h"

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

}  // namespace aligngs
