// `poses --method given` on two hundred random captures of each layout that it reads: cameras, pixels and the photos left
// out are what was meant.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/log.h"
#include "priors/scene_from_photos.h"
#include "scene/import/testing/random_layouts.h"
#include "scene/scene_json.h"
#include "scene/view_data.h"

namespace aligngs {
namespace {

/// A layout, and where its photos lie.
struct GivenLayout {
  Layout layout;
  const char* photos;
};
void PrintTo(const GivenLayout& given, std::ostream* out) { *out << given.layout.name; }

const RandomFrame* frame_called(const Written& written, const std::string& view) {
  const std::string name = fs::path(view).filename().string();
  for (const auto& [file, index] : written.frame_of)
    if (fs::path(file).stem().string() == name) return &written.capture.frames[index];
  return nullptr;
}

void expect_as_meant(const ViewData& data, const RandomFrame& frame, const std::optional<Similarity>& to_original) {
  constexpr double kColour = 0.06;  // JPEG and one resampling of a gradient of 0.02 a pixel
  const Vec3d own = frame.world_to_camera.inverse().translation, read = data.camera.centre();
  EXPECT_LT(norm((to_original ? *to_original * read : read) - own), 1e-6 * std::max(1.0, norm(own))) << frame.name;
  for (const double v : {0.3, 0.7}) {
    for (const double u : {0.3, 0.7}) {
      const int x = int(u * data.camera.width), y = int(v * data.camera.height);
      const Vec3d ray = data.camera.ray(x + 0.5, y + 0.5), colour = colour_along(frame, {ray.x, ray.y});
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(data.color.at(x, y, c), colour[c], kColour) << frame.name << ' ' << x << ", " << y;
    }
  }
}

class GivenPosesOfCaptures : public testing::TestWithParam<GivenLayout> {};

TEST_P(GivenPosesOfCaptures, ComeOutAsTheyWereMeant) {
  const uint64_t seeds = random_captures(100);
  const fs::path folder = scratch_folder(fmt::format("given_{}", GetParam().layout.name));
  set_log_level(LogLevel::kSilent);
  for (uint64_t seed = 0; seed < seeds && !HasFailure(); ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    fs::remove_all(folder);
    const Written written = GetParam().layout.write(seed, folder / "source");
    ScenePhotosOptions options;
    options.method = PosesMethod::kGiven;
    options.threads = 1;
    options.progress.enabled = false;
    make_scene_from_photos(folder / "source" / GetParam().photos, folder / "scene", ModelStore({}), options);
    const Scene scene = open_scene(folder / "scene");
    const auto to_original = read_scene_json(folder / "scene" / "scene.json").to_original;
    const auto& frames = written.capture.frames;
    const auto usable = [](const RandomFrame& frame) { return frame.fault == Fault::kNone; };
    EXPECT_EQ(scene.views.size(), size_t(std::count_if(frames.begin(), frames.end(), usable)));
    for (size_t i = 0; i < scene.views.size(); ++i) {
      const ViewData data = load_view(scene, int(i));
      const RandomFrame* frame = frame_called(written, data.name);
      ASSERT_TRUE(frame) << data.name;
      EXPECT_TRUE(usable(*frame)) << data.name;
      expect_as_meant(data, *frame, to_original);
    }
  }
  set_log_level(LogLevel::kInfo);
  fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Layouts, GivenPosesOfCaptures,
                         testing::Values(GivenLayout{{"transforms", transforms}, "images"},
                                         GivenLayout{{"blender", blender}, "train"},
                                         GivenLayout{{"colmap", colmap}, "images"}),
                         [](const auto& given) { return std::string(given.param.layout.name); });

}  // namespace
}  // namespace aligngs
