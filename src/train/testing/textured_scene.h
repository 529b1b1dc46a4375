// For tests: the slope of scene/testing/scene_folder.h with a texture of its own, at any scale of the world.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "core/log.h"
#include "core/stop_signal.h"
#include "scene/testing/scene_folder.h"

namespace aligngs::test_train {

struct TexturedScene {
  double scale = 1;  ///< of cameras, points and depth, so that the photos are the same; the scene is metric at 1
  double bump = 0;   ///< relative error of the prior depth, a wave over the image, so that no loss is zero
  /// Changes parts before they are written: `view` of the depth of each view, `scene` of the rest.
  std::function<void(int index, SceneViewParts&)> view = [](int, SceneViewParts&) {};
  std::function<void(SceneParts&)> scene = [](SceneParts&) {};
};

/// A scene of two training photos and a test photo, with exact depth and labels.
inline std::filesystem::path write_textured_scene(const std::string& name, const TexturedScene& how = {}) {
  const std::filesystem::path folder = test_scene::fresh_folder(name);
  SceneWriter writer(folder, false);
  for (int i = 0; i < 3; ++i) {
    SceneViewParts view = test_scene::view_parts(i);
    for (int y = 0; y < view.image.height; ++y) {
      for (int x = 0; x < view.image.width; ++x) {
        float& z = view.prior_depth.at(x, y);
        const Vec3d p = view.camera.unproject(x + 0.5, y + 0.5, z);
        const double wave[3] = {std::sin(9 * p.x), std::sin(7 * p.y + 4 * p.x), std::cos(11 * p.y)};
        for (int c = 0; c < 3; ++c) view.image.at(x, y, c) = static_cast<uint8_t>(128 + 100 * wave[c]);
        z *= static_cast<float>((1 + how.bump * std::sin(0.9 * x + i) * std::cos(0.7 * y)) * how.scale);
      }
    }
    view.camera.world_to_camera.translation = view.camera.world_to_camera.translation * how.scale;
    how.view(i, view);
    writer.add_view(view);
  }
  SceneParts parts = test_scene::scene_parts();
  for (Vec3f& p : parts.cloud.positions) p = p * static_cast<float>(how.scale);
  parts.description.metric = how.scale == 1;
  how.scene(parts);
  writer.finish(parts);
  return folder;
}

/// Trainings without a log, in a folder of the test's own.
class QuietRuns : public testing::Test {
 protected:
  void SetUp() override {
    set_log_level(LogLevel::kSilent);
    clear_stop_request();
    base_ = test_scene::fresh_folder("runs");
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  std::filesystem::path base_;
};

}  // namespace aligngs::test_train
