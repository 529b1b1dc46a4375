// Every layout, two hundred random captures each: cameras, pixels, depth and the frames left out are what was meant.
#include <gmock/gmock.h>

#include <map>
#include <set>

#include "core/log.h"
#include "scene/import/import_capture.h"
#include "scene/import/testing/random_layouts.h"
#include "scene/scene_json.h"
#include "scene/view_data.h"

namespace aligngs {
namespace {

/// Difference between the imported camera and the frame's own, in world units and degrees.
void expect_camera(const Camera& camera, const RandomFrame& frame, const std::optional<Similarity>& to_original) {
  const Vec3d own = frame.world_to_camera.inverse().translation, read = camera.centre();
  const Vec3d back = to_original ? *to_original * read : read;
  EXPECT_LT(norm(back - own), 1e-6 * std::max(1.0, norm(own))) << frame.name;
  EXPECT_LT(rotation_angle_between_degrees(camera.world_to_camera.rotation, frame.world_to_camera.rotation), 1e-4)
      << frame.name;
}

/// Pixels and depth along the rays of the imported camera, in the inner half of the picture, which any lens here sees.
void expect_content(const ViewData& data, const RandomFrame& frame, bool depth, double units) {
  constexpr double kColour = 0.06;  // JPEG and one resampling of a gradient of 0.02 a pixel
  constexpr double kDepth = 0.03;   // a pixel of the steepest depth, 0.5 / 32, and the rounding to a stored value
  EXPECT_EQ(!data.prior_depth.empty(), depth) << frame.name;
  for (const double v : {0.3, 0.5, 0.7}) {
    for (const double u : {0.3, 0.5, 0.7}) {
      const int x = int(u * data.camera.width), y = int(v * data.camera.height);
      const Vec3d ray = data.camera.ray(x + 0.5, y + 0.5);
      const Vec3d colour = colour_along(frame, {ray.x, ray.y});
      EXPECT_NEAR(data.color.at(x, y, 0), colour.x, kColour) << frame.name << " red at " << x << ", " << y;
      EXPECT_NEAR(data.color.at(x, y, 1), colour.y, kColour) << frame.name << " green at " << x << ", " << y;
      EXPECT_NEAR(data.color.at(x, y, 2), colour.z, kColour) << frame.name << " blue at " << x << ", " << y;
      if (!depth) continue;
      EXPECT_NEAR(data.prior_depth.at(x, y) * units, depth_along(frame, {ray.x, ray.y}), kDepth)
          << frame.name << " depth";
    }
  }
}

class Importers : public testing::TestWithParam<Layout> {};

TEST_P(Importers, RandomCapturesComeOutAsTheyWereMeant) {
  const uint64_t seeds = random_captures(100);
  const fs::path folder = scratch_folder(fmt::format("property_{}", GetParam().name));
  set_log_level(LogLevel::kSilent);
  ThreadPool pool(1);
  for (uint64_t seed = 0; seed < seeds && !HasFailure(); ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    fs::remove_all(folder);
    const Written written = GetParam().write(seed, folder / "source");
    const Capture capture = read_capture(folder / "source", written.options);
    ImportOptions options;
    options.progress.enabled = false;
    import_capture(capture, folder / "scene", options, pool);
    const Scene scene = open_scene(folder / "scene");
    std::map<std::string, size_t> frame_of_view;
    for (const CapturedFrame& frame : capture.frames)
      frame_of_view[frame.name] = written.frame_of.at(frame.image.filename().string());
    size_t usable = 0;
    for (const RandomFrame& frame : written.capture.frames) usable += frame.fault == Fault::kNone;
    EXPECT_EQ(scene.views.size(), usable);
    for (size_t i = 0; i < scene.views.size(); ++i) {
      const ViewData data = load_view(scene, int(i));
      const RandomFrame& frame = written.capture.frames[frame_of_view.at(data.name)];
      EXPECT_EQ(frame.fault, Fault::kNone) << frame.name;
      expect_camera(data.camera, frame, capture.to_original);
      expect_content(data, frame, written.depth, capture.to_original ? capture.to_original->scale : 1);
    }
  }
  set_log_level(LogLevel::kInfo);
  fs::remove_all(folder);
}

/// A layout that is added to the program needs random captures as well.
TEST(RandomCaptures, CoverEveryLayoutOfTheProgram) {
  const fs::path folder = scratch_folder("property_layouts");
  set_log_level(LogLevel::kSilent);
  std::set<std::string> tried, known;
  for (const Layout& layout : random_layouts()) {
    fs::remove_all(folder);
    const Written written = layout.write(0, folder);
    tried.insert(read_capture(folder, written.options).layout);
  }
  set_log_level(LogLevel::kInfo);
  fs::remove_all(folder);
  for (const CaptureLayout& layout : capture_layouts()) known.insert(layout.name);
  EXPECT_EQ(tried, known);
}

INSTANTIATE_TEST_SUITE_P(Layouts, Importers, testing::ValuesIn(random_layouts()),
                         [](const auto& layout) { return std::string(layout.param.name); });

}  // namespace
}  // namespace aligngs
