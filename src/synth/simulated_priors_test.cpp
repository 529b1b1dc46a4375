#include "synth/simulated_priors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "scene/testing/scene_folder.h"
#include "scene/view_data.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// A capture of the slope of test_scene with its true surface, as `aligngs import` leaves one.
fs::path write_capture(bool metric = true, bool mesh = true) {
  const fs::path folder = test_scene::fresh_folder("capture");
  SceneWriter writer(folder, true);
  for (int i = 0; i < 3; ++i) {
    SceneViewParts view = test_scene::view_parts(i);
    view.prior_depth = {};
    view.semantics = {};
    view.truth_labels = {};
    writer.add_view(view);
  }
  SceneParts parts = test_scene::scene_parts();
  parts.priors = {};
  parts.labels = {};
  parts.description.metric = metric;
  parts.description.up = {};
  if (mesh) {
    parts.truth_mesh.vertices = {{-3, -3, 0.5f}, {3, -3, 3.5f}, {3, 3, 3.5f}, {-3, 3, 0.5f}};
    parts.truth_mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  }
  writer.finish(parts);
  return folder;
}

Scene simulated(const SimulatedPriorOptions& options, const std::string& name = "simulated") {
  ThreadPool pool(2);
  const fs::path folder = test_scene::fresh_folder(name);
  write_simulated_priors(open_scene(write_capture()), folder, options, pool);
  return open_scene(folder);
}

double depth_error(const Scene& scene) {
  double sum = 0;
  size_t count = 0;
  for (const int i : scene.train) {
    LoadOptions load;
    const ViewData view = load_view(scene, i, load);
    const ImageF truth = test_scene::surface_depth_map(scene.evaluation_cameras[static_cast<size_t>(i)],
                                                       view.camera.width, view.camera.height);
    for (size_t p = 0; p < truth.data.size(); ++p) {
      if (!(view.prior_depth.data[p] > 0)) continue;
      sum += std::abs(std::log(view.prior_depth.data[p] / truth.data[p]));
      ++count;
    }
  }
  EXPECT_GT(count, 1000u);
  return sum / static_cast<double>(count);
}

TEST(SimulatedPriors, AreNearTheTruthAndSayWhatTheyAre) {
  const Scene scene = simulated({});
  EXPECT_TRUE(scene.has_prior_depth());
  EXPECT_FALSE(scene.has_semantics());
  EXPECT_NE(scene.prior_source.find("simulated"), std::string::npos);
  EXPECT_EQ(scene.train.size(), 2u);
  EXPECT_EQ(scene.test.size(), 1u);
  EXPECT_GT(scene.cloud.size(), 500u);
  EXPECT_FALSE(scene.truth_mesh.empty());
  const double error = depth_error(scene);
  EXPECT_GT(error, 0.002);
  EXPECT_LT(error, 0.2);
}

TEST(SimulatedPriors, CamerasAreDisturbedAndTheTrueOnesKept) {
  const Scene scene = simulated({});
  double moved = 0;
  for (size_t i = 0; i < scene.views.size(); ++i) {
    const Camera truth = test_scene::camera_at(0.1 * static_cast<double>(i));
    EXPECT_NEAR(norm(scene.evaluation_cameras[i].centre() - truth.centre()), 0, 1e-9);
    moved += norm(scene.views[i].camera.centre() - truth.centre());
  }
  EXPECT_GT(moved, 0.003);
  EXPECT_LT(moved, 0.5);
}

TEST(SimulatedPriors, AnotherSeedIsAnotherDrawAndTheSameOneTheSame) {
  SimulatedPriorOptions other;
  other.seed = 2;
  const Scene a = simulated({}, "a"), b = simulated({}, "b"), c = simulated(other, "c");
  EXPECT_EQ(a.views[0].camera.world_to_camera.translation.x, b.views[0].camera.world_to_camera.translation.x);
  EXPECT_NE(a.views[0].camera.world_to_camera.translation.x, c.views[0].camera.world_to_camera.translation.x);
}

TEST(SimulatedPriors, WithoutTrueSurfaceOrMetresTheyAreRefused) {
  ThreadPool pool(1);
  const fs::path out = test_scene::fresh_folder("out");
  for (const bool metric : {true, false}) {
    const Scene scene = open_scene(write_capture(metric, !metric));
    try {
      write_simulated_priors(scene, out, {}, pool);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    }
    EXPECT_FALSE(fs::exists(out));
  }
}

}  // namespace
}  // namespace aligngs
