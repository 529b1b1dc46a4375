#include "edit/export/moved_room.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "edit/export/upright.h"

namespace aligngs {

namespace {

/// Diagonal of the box around the Gaussians.
double size_of(const GaussianModel& model) {
  Vec3d low, high;
  for (size_t i = 0; i < model.positions.size(); ++i) {
    const int axis = static_cast<int>(i % 3);
    const double p = model.positions[i];
    low[axis] = i < 3 ? p : std::min(low[axis], p);
    high[axis] = i < 3 ? p : std::max(high[axis], p);
  }
  return norm(high - low);
}

}  // namespace

EditableRoom moved(EditableRoom room, const Similarity& to) {
  GaussianModel& model = room.gaussians.model;
  model = rotated(std::move(model), to.rotation);
  const float grown = static_cast<float>(std::log(to.scale));
  for (size_t i = 0; i < model.positions.size(); ++i) {
    model.positions[i] = static_cast<float>(to.scale * static_cast<double>(model.positions[i]) +
                                            to.translation[static_cast<int>(i % 3)]);
  }
  for (float& s : model.log_scales) s += grown;
  room.gaussians.extent *= to.scale;
  for (Vec3f& v : room.mesh.vertices) v = (to * v.cast<double>()).cast<float>();
  for (Vec3f& n : room.mesh.normals) n = (to.rotation * n.cast<double>()).cast<float>();
  if (room.up) room.up = to.rotation * *room.up;
  return room;
}

EditableRoom without_row_names(const EditableRoom& room) {
  return {.gaussians = room.gaussians,
          .origins = {},
          .mesh = room.mesh,
          .mesh_rows = {},
          .labels = room.labels,
          .up = room.up,
          .metric = room.metric,
          .cameras = room.cameras,
          .selections = room.selections};
}

OffsetRoom in_original_coordinates(EditableRoom room, const Similarity& to_original,
                                   const std::filesystem::path& scene_json, bool holds_offset) {
  constexpr double kLargestShare = 1e-4;  // of the room: half a millimetre in a room of five metres
  constexpr double kFewDigits = 10;       // times the room: texts have six digits
  const Vec3d& t = to_original.translation;
  const double largest = std::max({std::abs(t.x), std::abs(t.y), std::abs(t.z)});
  const double spacing = largest * std::numeric_limits<float>::epsilon(),
               size = to_original.scale * size_of(room.gaussians.model);
  const bool fits = spacing <= kLargestShare * size && !(holds_offset && largest > kFewDigits * size);
  if (!fits && !holds_offset) {
    throw_bad_input(
        scene_json, "to_original",
        fmt::format("coordinates near {:.4g} do not fit the files' 32-bit floats: points would move by {:.2g}", largest,
                    spacing),
        "export glb, obj or usda, which hold the offset apart; or leave out --original-coordinates, and apply "
        "to_original of scene.json in the other program");
  }
  if (fits) return {moved(std::move(room), to_original), Vec3d{}};
  return {moved(std::move(room), {to_original.scale, to_original.rotation, Vec3d{}}), t};
}

}  // namespace aligngs
