#include "edit/export/aligned_room.h"

#include <cmath>

#include "edit/export/upright.h"

namespace aligngs {

Similarity export_frame(const Similarity& to_room) {
  const Mat3d y_down{{1, 0, 0, 0, 0, -1, 0, 1, 0}};
  return {to_room.scale, y_down * to_room.rotation, y_down * to_room.translation};
}

EditableRoom aligned(const EditableRoom& room, const Similarity& to_room) {
  const Similarity frame = export_frame(to_room);
  EditableRoom out = room;
  GaussianModel& model = out.gaussians.model;
  model = rotated(room.gaussians.model, frame.rotation);
  const float grown = static_cast<float>(std::log(frame.scale));
  for (size_t i = 0; i < model.positions.size(); ++i) {
    model.positions[i] = static_cast<float>(frame.scale * static_cast<double>(model.positions[i]) + frame.translation[static_cast<int>(i % 3)]);
  }
  for (float& s : model.log_scales) s += grown;
  out.gaussians.extent *= frame.scale;
  for (Vec3f& v : out.mesh.vertices) v = (frame * v.cast<double>()).cast<float>();
  for (Vec3f& n : out.mesh.normals) n = (frame.rotation * n.cast<double>()).cast<float>();
  out.up = Vec3d{0, -1, 0};
  return out;
}

}  // namespace aligngs
