// For tests: the box room of refine/box_room_for_tests.h as a scene folder.
#pragma once

#include <filesystem>

#include "refine/box_room_for_tests.h"
#include "scene/test_scene_folder.h"
#include "train/trained_room_for_tests.h"

namespace aligngs::box_room {

inline SceneViewParts scene_view(int index, const Camera& camera) {
  const LayoutView seen = look(camera);
  SceneViewParts view;
  view.name = "v" + std::to_string(index);
  view.camera = camera;
  view.image = Image<uint8_t>(camera.width, camera.height, 3);
  for (size_t i = 0; i < view.image.data.size(); ++i) view.image.data[i] = static_cast<uint8_t>(255 * seen.color.data[i]);
  view.prior_depth = seen.plane.depth;
  view.semantics = {4, camera.width, camera.height, std::vector<float>(4 * seen.plane.labels.data.size(), 0.01f)};
  for (size_t i = 0; i < seen.plane.labels.data.size(); ++i) {
    view.semantics.values[seen.plane.labels.data[i] * seen.plane.labels.data.size() + i] = 0.97f;
  }
  return view;
}

/// A scene of five training photos and a test photo, with exact depth and labels.
inline std::filesystem::path write_room() {
  const std::filesystem::path folder = test_scene::fresh_folder("room");
  SceneWriter writer(folder, false);
  SceneParts parts = test_scene::scene_parts();
  parts.split.train = {std::vector<std::string>()};
  parts.split.test = {{"v5"}};
  parts.labels = room_labels();
  parts.cloud = {};
  for (const LayoutView& view : photos()) {
    for (int y = 4; y < view.plane.camera.height; y += 8) {
      for (int x = 4; x < view.plane.camera.width; x += 8) {
        parts.cloud.positions.push_back(view.plane.camera.unproject(x + 0.5, y + 0.5, view.plane.depth.at(x, y)).cast<float>());
        parts.cloud.colors.push_back(kColors[view.plane.labels.at(x, y)]);
      }
    }
  }
  int index = 0;
  for (const Camera& camera : cameras()) {
    writer.add_view(scene_view(index, camera.resized(camera.width / 2, camera.height / 2)));
    if (index < 5) parts.split.train->push_back("v" + std::to_string(index));
    ++index;
  }
  writer.finish(parts);
  return folder;
}

}  // namespace aligngs::box_room
