#include "synth/removal.h"

#include <algorithm>
#include <set>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr std::string_view kShell[] = {"wall", "floor", "ceiling", "windowpane", "door"};

bool is_shell(const RoomObject& object) {
  return std::find(std::begin(kShell), std::end(kShell), object.class_name) != std::end(kShell);
}

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(' ');
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

std::string names_of(const RoomModel& room) {
  std::string text;
  for (size_t i = 0; i < room.objects.size(); ++i) {
    if (!is_shell(room.objects[i])) text += (text.empty() ? "" : ", ") + object_name(room, i);
  }
  return text;
}

}  // namespace

std::string object_name(const RoomModel& room, size_t object) {
  size_t number = 0;
  for (size_t i = 0; i <= object; ++i) number += room.objects[i].class_name == room.objects[object].class_name;
  return room.objects[object].class_name + "#" + std::to_string(number);
}

Removal parse_removal(const RoomModel& room, std::string_view text) {
  Removal removal;
  std::set<size_t> objects;
  while (true) {
    const size_t comma = text.find(',');
    const std::string item(trimmed(text.substr(0, comma)));
    bool found = false;
    for (size_t i = 0; i < room.objects.size(); ++i) {
      if (is_shell(room.objects[i]) || (item != object_name(room, i) && item != room.objects[i].class_name)) continue;
      objects.insert(i);
      found = true;
    }
    if (!found)
      throw_usage("this room has no object \"" + item.substr(0, 60) + "\" to leave out", "it has: " + names_of(room));
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  removal.objects.assign(objects.begin(), objects.end());
  for (const size_t i : removal.objects) removal.name += (removal.name.empty() ? "" : "+") + object_name(room, i);
  std::replace(removal.name.begin(), removal.name.end(), ' ', '_');
  return removal;
}

AxisAlignedBox box_of(const RoomModel& room, size_t object) {
  AxisAlignedBox box;
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    if (room.triangle_object[t] != object) continue;
    for (const uint32_t v : room.triangles[t]) {
      for (int a = 0; a < 3; ++a) {
        box.low[a] = std::min(box.low[a], room.positions[v][a]);
        box.high[a] = std::max(box.high[a], room.positions[v][a]);
      }
    }
  }
  return box;
}

RoomModel room_without(const RoomModel& room, const Removal& removal) {
  RoomModel out = room;
  std::vector<uint8_t> gone(room.objects.size(), 0);
  std::vector<AxisAlignedBox> boxes;
  for (const size_t i : removal.objects) {
    gone[i] = 1;
    boxes.push_back(box_of(room, i));
  }
  size_t kept = 0;
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    if (gone[room.triangle_object[t]]) continue;
    out.triangles[kept] = room.triangles[t];
    out.triangle_object[kept] = room.triangle_object[t];
    out.triangle_material[kept++] = room.triangle_material[t];
  }
  out.triangles.resize(kept);
  out.triangle_object.resize(kept);
  out.triangle_material.resize(kept);
  std::erase_if(out.lights, [&](const AreaLight& light) {
    constexpr double kNear = 0.02;  // metres: a lamp's light may be on its surface
    const Vec3d p = light.origin + 0.5 * (light.edge_u + light.edge_v);
    return std::any_of(boxes.begin(), boxes.end(), [&](const AxisAlignedBox& box) {
      for (int a = 0; a < 3; ++a) {
        if (p[a] < box.low[a] - kNear || p[a] > box.high[a] + kNear) return false;
      }
      return true;
    });
  });
  out.remove_unused_vertices();
  return out;
}

}  // namespace aligngs
