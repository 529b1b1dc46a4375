#include "synth/removal_truth.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "scene/mesh_ply.h"

namespace aligngs {

RemovalTruth make_removal_truth(const SynthScene& scene, const Removal& removal, ThreadPool& pool) {
  RemovalTruth truth;
  truth.removal = removal;
  const RoomModel room = room_without(scene.room, removal);
  const RoomRays rays(room);
  LightCache lights = light_room(rays, pool, lighting_of(scene.options));
  lights.exposure = scene.exposure;  // of the camera in the room as it was
  truth.mesh = truth_mesh(room, lights);
  for (const int index : scene.test) {
    const RenderedView& before = scene.views[static_cast<size_t>(index)].truth;
    const RenderedView after = render_view(rays, &lights, before.camera, {true, scene.options.samples_per_side}, pool);
    truth.pictures.push_back(photo_of(scene.options, static_cast<size_t>(index), after.color));
    Image<uint8_t> mask(before.instances.width, before.instances.height, 1, 0);
    for (size_t p = 0; p < mask.data.size(); ++p) {
      if (std::binary_search(removal.objects.begin(), removal.objects.end(), size_t(before.instances.data[p])))
        mask.data[p] = 255;
    }
    truth.masks.push_back(std::move(mask));
  }
  return truth;
}

std::string room_objects_json(const RoomModel& room) {
  std::vector<std::pair<uint32_t, uint32_t>> vertices(room.objects.size(), {~0u, 0});
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    auto& [first, end] = vertices[room.triangle_object[t]];
    for (const uint32_t v : room.triangles[t]) {
      first = std::min(first, v);
      end = std::max(end, v + 1);
    }
  }
  nlohmann::ordered_json objects = nlohmann::ordered_json::array();
  for (size_t i = 0; i < room.objects.size(); ++i) {
    const AxisAlignedBox box = box_of(room, i);
    if (vertices[i].first >= vertices[i].second) continue;  // nothing of it is left
    objects.push_back({{"object", object_name(room, i)},
                       {"class", room.objects[i].class_name},
                       {"low", {box.low.x, box.low.y, box.low.z}},
                       {"high", {box.high.x, box.high.y, box.high.z}},
                       {"vertices", {vertices[i].first, vertices[i].second}}});
  }
  return json_document(nlohmann::ordered_json{{"schema", 1}, {"objects", objects}});
}

void write_removal_truth(const SynthScene& scene, const RemovalTruth& truth, const std::filesystem::path& folder) {
  const std::filesystem::path place = folder / truth.removal.name;
  for (size_t i = 0; i < truth.pictures.size(); ++i) {
    const std::string file = scene.views[static_cast<size_t>(scene.test[i])].name + ".png";
    write_png(place / "rgb" / file, truth.pictures[i]);
    write_png(place / "mask" / file, truth.masks[i]);
  }
  write_mesh_ply(place / "mesh.ply", truth.mesh);
  nlohmann::ordered_json objects = nlohmann::ordered_json::array();
  for (const size_t i : truth.removal.objects) {
    const AxisAlignedBox box = box_of(scene.room, i);
    objects.push_back({{"object", object_name(scene.room, i)},
                       {"class", scene.room.objects[i].class_name},
                       {"low", {box.low.x, box.low.y, box.low.z}},
                       {"high", {box.high.x, box.high.y, box.high.z}}});
  }
  write_file_atomically(place / "removal.json",
                        json_document(nlohmann::ordered_json{{"schema", 1}, {"objects", objects}}));
}

}  // namespace aligngs
