#include "edit/export/aligned_room.h"

#include <utility>

#include "edit/export/moved_room.h"

namespace aligngs {

Similarity export_frame(const Similarity& to_room) {
  const Mat3d y_down{{1, 0, 0, 0, 0, -1, 0, 1, 0}};
  return {to_room.scale, y_down * to_room.rotation, y_down * to_room.translation};
}

EditableRoom aligned(EditableRoom room, const Similarity& to_room) {
  EditableRoom out = moved(std::move(room), export_frame(to_room));
  out.up = Vec3d{0, -1, 0};
  return out;
}

}  // namespace aligngs
