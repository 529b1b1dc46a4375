// For tests: a small scene folder on disk, three cameras before a textured slope.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/random.h"
#include "io/npy.h"
#include "scene/scene_writer.h"

namespace aligngs::test_scene {

namespace fs = std::filesystem;

constexpr int kWidth = 40, kHeight = 30;

/// An empty folder for one test.
inline fs::path fresh_folder(const std::string& name) {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  const fs::path folder =
      fs::path(testing::TempDir()) / "aligngs_scene" / info->test_suite_name() / info->name() / name;
  fs::remove_all(folder);
  fs::create_directories(folder.parent_path());
  return folder;
}

/// Gives a view scores of its own instead of those that write_scene() gave it.
inline void replace_semantics(const fs::path& scene, const std::string& view, const std::vector<int64_t>& shape,
                              const std::vector<float>& scores) {
  const fs::path maps = scene / "segmentation_logits";
  fs::remove(maps / (view + ".npz"));
  write_npy_float32(maps / (view + ".npy"), shape, scores.data());
}

inline Camera camera_at(double x) {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 40;
  camera.cx = kWidth / 2.0;
  camera.cy = kHeight / 2.0;
  camera.world_to_camera.translation = {-x, 0, 0};
  return camera;
}

/// Depth of the surface z = 2 + x / 2 (world), seen by a camera that looks along z.
inline float surface_depth(const Camera& camera, double u, double v) {
  const Vec3d centre = camera.centre(), ray = camera.ray(u, v);
  return static_cast<float>((2 + 0.5 * centre.x) / (1 - 0.5 * ray.x));
}

inline ImageF surface_depth_map(const Camera& camera, int width, int height) {
  const Camera resized = camera.resized(width, height);
  ImageF depth(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) depth.at(x, y) = surface_depth(resized, x + 0.5, y + 0.5);
  return depth;
}

inline Image<uint8_t> textured_image(uint64_t seed, int channels = 3) {
  Random random(seed);
  Image<uint8_t> image(kWidth, kHeight, channels, 255);
  for (size_t i = 0; i < image.pixels(); ++i)
    for (int c = 0; c < 3; ++c) image.data[i * channels + c] = static_cast<uint8_t>(random.below(256));
  return image;
}

/// Scores of three classes: class 0 left, class 2 right.
inline SemanticMap three_class_scores(int width, int height) {
  SemanticMap map{3, width, height, std::vector<float>(size_t(3) * width * height, 0.0f)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) map.values[(size_t(x < width / 2 ? 0 : 2) * height + y) * width + x] = 0.9f;
  return map;
}

inline LabelSet three_labels() {
  LabelSet labels;
  labels.classes = {{"wall", {}, {1, 1, 1}}, {"floor", {}, {2, 2, 2}}, {"chair", {"seat"}, {3, 3, 3}}};
  return labels;
}

/// View "v0", "v1", ... with all maps; prior depth at full size, semantics at half size.
inline SceneViewParts view_parts(int i) {
  SceneViewParts view;
  view.name = "v" + std::to_string(i);
  view.camera = camera_at(0.1 * i);
  view.image = textured_image(static_cast<uint64_t>(i) + 1);
  view.prior_depth = surface_depth_map(view.camera, kWidth, kHeight);
  view.semantics = three_class_scores(kWidth / 2, kHeight / 2);
  view.truth_depth = view.prior_depth;
  view.truth_labels = Image<uint16_t>(kWidth, kHeight, 1, 2);
  view.truth_labels.at(0, 0) = kNoLabel;
  view.truth_camera = view.camera;
  return view;
}

/// Points on the surface, visible in all views, with normals.
inline SceneParts scene_parts() {
  SceneParts parts;
  parts.description.metric = true;
  parts.description.up = Vec3d{0, -1, 0};
  parts.description.source = "test";
  parts.split.train = {{"v0", "v1"}};
  parts.split.test = {{"v2"}};
  parts.priors.depth = PriorJson{"simulated", "", {}};
  parts.priors.depth_scale = DepthScale::kScene;
  parts.priors.semantics = PriorJson{"simulated", "", {}};
  parts.priors.kind = SemanticKind::kScores;
  parts.labels = three_labels();
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const double x = random.uniform(-0.5, 0.7), y = random.uniform(-0.5, 0.5);
    parts.cloud.positions.push_back(Vec3d{x, y, 2 + 0.5 * x}.cast<float>());
    parts.cloud.colors.push_back({0.2f, 0.4f, 1.0f});
    parts.cloud.normals.push_back(normalized(Vec3d{0.5, 0, -1}).cast<float>());
  }
  return parts;
}

/// The scene written once per process: flushing its files to disk for each test would take seconds.
class SharedScene {
 public:
  SharedScene() : folder_(fs::path(testing::TempDir()) / ("aligngs_scene_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    SceneWriter writer(folder_, false);
    for (int i = 0; i < 3; ++i) writer.add_view(view_parts(i));
    writer.finish(scene_parts());
  }
  ~SharedScene() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

/// A copy of a scene of three views, for one test to change.
inline fs::path write_scene(const std::string& name = "scene") {
  static const SharedScene shared;
  const fs::path folder = fresh_folder(name);
  fs::copy(shared.folder(), folder, fs::copy_options::recursive);
  return folder;
}

inline void write_text(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

inline std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace aligngs::test_scene
