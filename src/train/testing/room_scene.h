// For tests: the box room of refine/testing/box_room.h as a scene folder, and runs on it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/log.h"
#include "core/stop_signal.h"
#include "refine/testing/box_room.h"
#include "scene/testing/scene_folder.h"
#include "train/testing/trained_room.h"
#include "train/train_run.h"

namespace aligngs::box_room {

inline SceneViewParts scene_view(int index, const Camera& camera) {
  const LayoutView seen = look(camera);
  SceneViewParts view;
  view.name = "v" + std::to_string(index);
  view.camera = camera;
  view.image = Image<uint8_t>(camera.width, camera.height, 3);
  for (size_t i = 0; i < view.image.data.size(); ++i)
    view.image.data[i] = static_cast<uint8_t>(255 * seen.color.data[i]);
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
  parts.cloud = shown_points(8);
  int index = 0;
  for (const Camera& camera : cameras()) {
    writer.add_view(scene_view(index, camera.resized(camera.width / 2, camera.height / 2)));
    if (index < 5) parts.split.train->push_back("v" + std::to_string(index));
    ++index;
  }
  writer.finish(parts);
  return folder;
}

/// Quiet runs on one such scene, each in a folder of its own.
class RoomTraining : public testing::Test {
 protected:
  void SetUp() override {
    set_log_level(LogLevel::kSilent);
    clear_stop_request();
    static const std::filesystem::path scene = write_room();
    scene_ = scene;
    base_ = test_scene::fresh_folder("runs");
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  TrainOptions run_of(const std::string& name, int64_t iterations) const {
    TrainOptions o;
    o.scene = scene_;
    o.run = base_ / name;
    o.config.iterations = iterations;
    o.progress.enabled = false;
    o.threads = 2;
    return o;
  }

 private:
  std::filesystem::path scene_, base_;
};

}  // namespace aligngs::box_room
