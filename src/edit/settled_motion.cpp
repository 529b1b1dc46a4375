#include "edit/settled_motion.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/median.h"
#include "edit/move_objects.h"
#include "edit/relation/class_groups.h"

namespace aligngs {
namespace {

/// Rows of the objects that a selection names.
std::vector<uint8_t> rows_named(const EditableRoom& room, const SelectionQuery& query) {
  const GaussianLabels& labels = room.gaussians.labels;
  std::vector<uint8_t> rows(labels.label.size(), 0);
  for (const SelectionTerm& term : query.include) {
    for (size_t i = 0; i < rows.size(); ++i) {
      const bool is_object = labels.label[i] == term.label && labels.instance[i] != 0 &&
                             (term.instance == 0 || labels.instance[i] == term.instance);
      if (term.named.empty() ? is_object : term.rows && (*term.rows)[i]) rows[i] = 1;
    }
  }
  return rows;
}

/// The middle value of each coordinate: strays do not move it.
Vec3d middle_place(const EditableRoom& room, const std::vector<uint8_t>& rows, const std::string& name) {
  std::array<std::vector<float>, 3> places;
  for (size_t i = 0; i < rows.size(); ++i) {
    for (size_t a = 0; rows[i] && a < 3; ++a) places[a].push_back(room.gaussians.model.positions[3 * i + a]);
  }
  if (places[0].empty())
    throw_bad_input({}, "--move", "the room has no \"" + name + "\"", "`aligngs edit RUN --list` shows what it holds");
  Vec3d out;
  for (size_t a = 0; a < 3; ++a) {
    out[static_cast<int>(a)] = median_of(std::move(places[a]));
  }
  return out;
}

void require_one_thing(const EditableRoom& room, const std::vector<uint8_t>& rows, const std::string& name) {
  std::set<std::pair<uint16_t, uint16_t>> objects;
  const GaussianLabels& labels = room.gaussians.labels;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (rows[i]) objects.insert({labels.label[i], labels.instance[i]});
  }
  std::string names;
  for (const auto& [label, number] : objects) {
    const std::string& one = room.labels.classes.at(label).name;
    if (!is_of_group(room.labels, label, ClassGroup::kThings))
      throw_bad_input({}, "--move", "\"" + name + "\" is on all sides", "say left, right, closer or away");
    names += (names.empty() ? "" : ", ") + one + "#" + std::to_string(number);
  }
  if (objects.size() > 1)
    throw_bad_input({}, "--move", "\"" + name + "\" is several things: " + names, "name one of them");
}

/// The shift to the right and towards the viewer that is level, as long as given, and leads to a thing.
Vec3d shift_toward(const EditableRoom& room, const EditOperation& edit) {
  const std::string& name = edit.motion.toward;
  const SelectionQuery moved = read_selection(room, edit.select), thing = read_selection(room, name);
  const std::vector<uint8_t> rows = rows_named(room, moved), anchor = rows_named(room, thing);
  const Vec3d from = middle_place(room, rows, edit.select), to = middle_place(room, anchor, name);
  require_one_thing(room, anchor, name);
  if (!room.up)
    throw_bad_input({}, "--move", "this room does not tell which way is up",
                    "give the scene an up direction: `up` in scene.json");
  Vec3d way = to - from;
  way -= *room.up * dot(way, *room.up);
  const double length = norm(way);
  if (!(length > 0) || edit.motion.distance >= length) {
    throw_bad_input({}, "--move", fmt::format("\"{}\" is nearer than the motion is long", name),
                    fmt::format("its middle is {:.2f} scene units away", length));
  }
  way *= edit.motion.distance / length;
  // The axes of the motion in the world.
  ObjectMotion right, toward;
  right.shift.x = toward.shift.z = 1;
  const Vec3d x = motion_in_world(room, rows, right).translation, z = motion_in_world(room, rows, toward).translation;
  return {dot(way, x), 0, dot(way, z)};
}

}  // namespace

void settle_motion(const EditableRoom& room, std::optional<double> metres, EditOperation& edit) {
  ObjectMotion& motion = edit.motion;
  if (motion.in_metres) {
    if (!metres) {
      throw_bad_input({}, "--move", "the scale of this room is not known, so that a length in metres says nothing",
                      fmt::format("give it one: aligngs room RUN, then aligngs scale RUN --object door.1 --height 2.0. "
                                  "Or move by scene units: \"by 0.5,0,0\"; the room is about {:.2g} of them wide",
                                  room.gaussians.extent));
    }
    motion.shift = motion.shift * (1 / *metres);
    motion.distance /= *metres;
    motion.in_metres = false;
  }
  if (motion.toward.empty()) return;
  motion.shift = shift_toward(room, edit);
  motion.toward.clear();
  motion.distance = 0;
}

}  // namespace aligngs
