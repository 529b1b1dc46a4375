#include "synth/gloss.h"

#include <map>
#include <set>
#include <string>
#include <utility>

#include "scene/label_set.h"

namespace aligngs {
namespace {

constexpr size_t kNoObject = static_cast<size_t>(-1);

enum class GlossRole { kNone, kFloor, kTable, kScreen, kPane, kMirror };

/// The painting with the largest picture; kNoObject when there is none.
size_t largest_painting(const RoomModel& room) {
  std::vector<double> areas(room.objects.size(), 0.0);
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    if (room.materials[room.triangle_material[t]].kind == TextureKind::kPainting &&
        room.objects[room.triangle_object[t]].class_name == "painting")
      areas[room.triangle_object[t]] += room.triangle_area(t);
  }
  size_t best = kNoObject;
  for (size_t i = 0; i < areas.size(); ++i) {
    if (areas[i] > 0 && (best == kNoObject || areas[i] > areas[best])) best = i;
  }
  return best;
}

GlossRole role_of(const RoomObject& object, const Material& material, bool is_mirror) {
  static const std::set<std::string> kTables = {"table", "coffee table", "desk", "countertop"};
  if (material.kind == TextureKind::kOutside) return GlossRole::kPane;
  if (is_mirror) return material.kind == TextureKind::kPainting ? GlossRole::kMirror : GlossRole::kNone;
  if (object.class_name == "monitor" || object.class_name == "television")
    return material.unreliable_depth ? GlossRole::kScreen : GlossRole::kNone;
  if (object.class_name == "floor") return GlossRole::kFloor;
  return kTables.count(object.class_name) != 0 ? GlossRole::kTable : GlossRole::kNone;
}

Material glossy_material(Material m, GlossRole role, const GlossSettings& s) {
  m.gloss = 1;
  switch (role) {
    case GlossRole::kFloor:
      m.reflectance = s.floor_reflectance;
      m.roughness = s.floor_roughness;
      m.mirror_rays = s.rays;
      break;
    case GlossRole::kTable:
      m.reflectance = s.table_reflectance;
      m.roughness = s.table_roughness;
      m.mirror_rays = s.rays;
      for (Vec3f* color : {&m.a, &m.b, &m.c}) *color = *color * s.table_darkness;
      break;
    case GlossRole::kScreen:
      m.reflectance = s.screen_reflectance;
      m.roughness = s.screen_roughness;
      break;
    case GlossRole::kPane:
      m.reflectance = s.pane_reflectance;
      m.roughness = 0;
      m.emission = s.day;
      m.see_through = true;
      break;
    case GlossRole::kMirror: {
      Material mirror;
      mirror.a = {0.02f, 0.02f, 0.02f};
      mirror.gloss = 1;
      mirror.reflectance = s.mirror_reflectance;
      mirror.roughness = 0;
      mirror.unreliable_depth = true;  // of networks; a sensor measures the room in it
      return mirror;
    }
    case GlossRole::kNone:
      break;
  }
  return m;
}

}  // namespace

void add_gloss(RoomModel& room, const GlossSettings& settings) {
  const size_t mirror = largest_painting(room);
  std::map<std::pair<uint16_t, GlossRole>, uint16_t> changed;  // materials may be shared with dull things
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    const uint16_t object = room.triangle_object[t], material = room.triangle_material[t];
    const GlossRole role = role_of(room.objects[object], room.materials[material], object == mirror);
    if (role == GlossRole::kNone) continue;
    const auto [place, is_new] = changed.try_emplace({material, role}, static_cast<uint16_t>(room.materials.size()));
    if (is_new) room.materials.push_back(glossy_material(room.materials[material], role, settings));
    room.triangle_material[t] = place->second;
  }
  if (mirror != kNoObject) {
    RoomObject& object = room.objects[mirror];
    object.class_name = "mirror";
    object.label = static_cast<uint16_t>(ade20k_labels().find(object.class_name));
  }
  room.strong_gloss = true;
}

}  // namespace aligngs
