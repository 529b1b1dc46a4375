#include "synth/synth_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/srgb.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/npy.h"
#include "scene/mesh_ply.h"
#include "scene/scene.h"
#include "scene/view_data.h"
#include "synth/acceptance.h"

namespace aligngs {
namespace {

SynthOptions small_options() {
  SynthOptions o;
  o.views = 16;
  o.test_views = 4;
  o.width = 64;
  o.height = 48;
  o.seed = 5;
  o.samples_per_side = 1;
  o.shadows = false;
  return o;
}

/// One small scene for all tests of this file: making it takes most of their time.
const SynthScene& small_scene() {
  static ThreadPool pool(3);
  static const SynthScene scene = make_synth_scene(small_options(), pool);
  return scene;
}

TEST(SynthScene, IsTheSameForAnyNumberOfThreads) {
  ThreadPool one(1);
  const SynthScene a = make_synth_scene(small_options(), one);
  const SynthScene& b = small_scene();
  ASSERT_EQ(a.views.size(), b.views.size());
  for (size_t i = 0; i < a.views.size(); ++i) {
    EXPECT_EQ(a.views[i].image.data, b.views[i].image.data);
    EXPECT_EQ(a.views[i].truth.depth.data, b.views[i].truth.depth.data);
    EXPECT_EQ(a.views[i].teacher.depth.data, b.views[i].teacher.depth.data);
    EXPECT_EQ(a.views[i].teacher.confidence.data, b.views[i].teacher.confidence.data);
    EXPECT_EQ(a.views[i].scores.values, b.views[i].scores.values);
    EXPECT_EQ(a.views[i].mono_depth.data, b.views[i].mono_depth.data);
  }
  ASSERT_EQ(a.cloud.size(), b.cloud.size());
  for (size_t i = 0; i < a.cloud.size(); ++i) ASSERT_EQ(a.cloud.positions[i].x, b.cloud.positions[i].x);
}

TEST(SynthScene, HasTheRequestedViewsAndSplit) {
  const SynthScene& s = small_scene();
  EXPECT_EQ(s.train.size(), 12u);
  EXPECT_EQ(s.test.size(), 4u);
  int far = 0;
  for (const SynthView& v : s.views) far += v.role == ViewRole::kTestFar;
  EXPECT_EQ(far, 2);
}

TEST(SynthScene, ExactDepthReprojectsIntoOtherViews) {
  const SynthScene& s = small_scene();
  size_t compared = 0, agree = 0;
  for (const int i : s.train) {
    const RenderedView& a = s.views[i].truth;
    for (const int j : s.train) {
      const RenderedView& b = s.views[j].truth;
      for (size_t p = 0; p < a.depth.data.size(); p += 29) {
        const Vec3d point =
            a.camera.unproject(static_cast<double>(p % 64) + 0.5, static_cast<double>(p / 64) + 0.5, a.depth.data[p]);
        const Vec3d q = b.camera.world_to_camera * point;
        if (q.z < 0.1 || !b.camera.contains(b.camera.project(q))) continue;
        const Vec2d u = b.camera.project(q);
        const float z = b.depth.at(static_cast<int>(u.x), static_cast<int>(u.y));
        if (q.z > z * 1.15) continue;  // hidden there
        ++compared;
        agree += std::fabs(q.z - z) < 0.06 * z;
      }
    }
  }
  ASSERT_GT(compared, 1000u);
  EXPECT_GT(static_cast<double>(agree) / static_cast<double>(compared), 0.93);
}

TEST(SynthScene, EveryPixelShowsALabelledSurface) {
  for (const SynthView& v : small_scene().views) {
    for (size_t p = 0; p < v.truth.depth.data.size(); ++p) {
      ASSERT_GT(v.truth.depth.data[p], 0.1f);  // no camera inside furniture, no hole in the walls
      ASSERT_LT(v.truth.depth.data[p], 9.0f);
      ASSERT_LT(v.truth.labels.data[p], 150);
      const uint16_t object = v.truth.instances.data[p];
      ASSERT_EQ(small_scene().room.objects[object].label, v.truth.labels.data[p]);
    }
  }
}

TEST(SynthScene, FarTestViewsAreFarFromEveryTrainingView) {
  const SynthScene& s = small_scene();
  for (const int i : s.test) {
    const SynthView& test = s.views[i];
    if (test.role != ViewRole::kTestFar) continue;
    for (const int j : s.train) {
      const Camera &a = test.truth.camera, &b = s.views[j].truth.camera;
      EXPECT_TRUE(norm(a.centre() - b.centre()) >= kFarMetres ||
                  rotation_angle_between_degrees(a.world_to_camera.rotation, b.world_to_camera.rotation) >=
                      kFarDegrees);
    }
  }
}

TEST(SynthScene, CamerasAreHeldAtEyeHeightAndUpright) {
  const SynthScene& s = small_scene();
  const Rigidd to_room = s.room.room_to_world.inverse();
  for (const SynthView& v : s.views) {
    const double height = (to_room * v.truth.camera.centre()).z;
    EXPECT_GE(height, 1.09);
    EXPECT_LE(height, 1.71);
    EXPECT_LT((v.truth.camera.world_to_camera.rotation * s.up).y, -0.7);
  }
}

TEST(SynthScene, TheTruthMeshIsTheSurfaceThatTheDepthShows) {
  const SynthScene& s = small_scene();
  ASSERT_EQ(s.mesh.vertices.size(), s.mesh.labels.size());
  ASSERT_EQ(s.mesh.vertices.size(), s.mesh.colors.size());
  const RoomRays rays(s.room);
  const RenderedView& v = s.views[3].truth;
  const Rigidd pose = v.camera.world_to_camera.inverse();
  for (int y = 2; y < 48; y += 9) {
    const RayHit hit = rays.intersect(pose.translation, pose.rotation * v.camera.ray(20.5, y + 0.5));
    ASSERT_TRUE(hit.hit);
    EXPECT_NEAR(hit.distance, v.depth.at(20, y), 1e-6);
    EXPECT_EQ(s.mesh.labels[s.mesh.triangles[hit.triangle][0]], v.labels.at(20, y));
  }
}

TEST(SynthScene, AnotherTeacherSeedChangesTheTeacherAndNotTheRoom) {
  SynthOptions o = small_options();
  o.teacher_seed = 99;
  ThreadPool pool(2);
  const SynthScene other = make_synth_scene(o, pool);
  EXPECT_EQ(other.views[2].image.data, small_scene().views[2].image.data);
  EXPECT_NE(other.views[2].teacher.depth.data, small_scene().views[2].teacher.depth.data);
}

/// Mean of a channel of the photo, in levels of 255.
double mean_level(const Image<uint8_t>& image, int channel) {
  double sum = 0;
  for (size_t i = static_cast<size_t>(channel); i < image.data.size(); i += 3) sum += image.data[i];
  return sum * 3 / static_cast<double>(image.data.size());
}

TEST(SynthScene, WithoutTheHarderOptionsARoomIsTheOneOfItsSeed) {
  // Taken before there were such options. Other processors round a few pixels differently.
  const SynthScene& s = small_scene();
  EXPECT_EQ(s.room.positions.size(), 228210u);
  const double levels[3] = {172.055, 150.700, 133.087};
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean_level(s.views[3].image, c), levels[c], 0.1) << c;
  EXPECT_TRUE(s.views[3].truth.mirrored.empty());
}

TEST(SynthScene, AGlossyRoomDiffersInItsPicturesAlone) {
  SynthOptions o = small_options();
  o.strong_gloss = true;
  ThreadPool pool(2);
  const SynthScene glossy = make_synth_scene(o, pool);
  EXPECT_EQ(glossy.views[3].truth.depth.data, small_scene().views[3].truth.depth.data);
  EXPECT_NE(glossy.views[3].image.data, small_scene().views[3].image.data);
  EXPECT_EQ(glossy.views[3].truth.mirrored.data.size(), 64u * 48u);
}

TEST(PhotoExposure, IsTheRatioOfThePhotoToTheCleanPicture) {
  SynthOptions o = small_options();
  o.exposure = ExposureKind::kWalk;
  const ImageF grey(64, 48, 3, 0.4f);
  for (const size_t index : {0, 7, 15}) {
    const Image<uint8_t> photo = photo_of(o, index, grey);
    const std::array<double, 3> gains = photo_exposure(o, index);
    for (int c = 0; c < 3; ++c) {
      const double ratio = srgb_decode(static_cast<float>(mean_level(photo, c) / 255)) / srgb_decode(0.4f);
      EXPECT_NEAR(ratio, gains[static_cast<size_t>(c)], 0.03 * ratio) << index << " " << c;
    }
  }
}

TEST(PhotoExposure, OfAWalkIsWrittenAsTruth) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "aligngs_synth_exposure";
  std::filesystem::remove_all(folder);
  SynthScene s = small_scene();
  s.options.exposure = ExposureKind::kWalk;
  write_synth_scene(s, folder);
  const nlohmann::json truth = nlohmann::json::parse(read_file(folder / "truth" / "exposure.json"));
  ASSERT_EQ(truth["log_gains"].size(), s.views.size());  // test views, too
  EXPECT_NEAR(truth["log_gains"]["view_004"][1], std::log(photo_exposure(s.options, 4)[1]), 1e-12);
  std::filesystem::remove_all(folder);
}

TEST(SynthScene, RefusesImpossibleOptions) {
  ThreadPool pool(1);
  for (int k = 0; k < 4; ++k) {
    SynthOptions o = small_options();
    if (k == 0) o.width = 8;
    if (k == 1) o.views = 5, o.test_views = 4;
    if (k == 2) o.semantic_scale = 0.9;
    if (k == 3) o.room = "cellar";
    try {
      make_synth_scene(o, pool);
      FAIL() << k;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kUsage);
      EXPECT_FALSE(e.details().remedy.empty());
    }
  }
}

TEST(SynthFolder, OpensAsASceneWithEverythingInPlace) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "aligngs_synth_folder";
  std::filesystem::remove_all(folder);
  const SynthScene& s = small_scene();
  write_synth_scene(s, folder);
  const Scene scene = open_scene(folder);
  EXPECT_TRUE(scene.metric);
  ASSERT_TRUE(scene.up.has_value());
  EXPECT_NEAR(dot(*scene.up, s.up), 1, 1e-6);
  EXPECT_EQ(scene.train.size(), 12u);
  EXPECT_EQ(scene.test.size(), 4u);
  EXPECT_EQ(scene.semantic_kind, SemanticKind::kScores);
  EXPECT_EQ(scene.prior_source, "simulated feed-forward (medium)");
  EXPECT_TRUE(scene.has_prior_depth());
  EXPECT_TRUE(scene.has_semantics());
  for (const SceneProblem& problem : check_scene(scene)) EXPECT_FALSE(problem.fatal) << problem.path << problem.message;
  // Poses: sparse/ has the teacher's, truth/sparse the exact ones.
  const View& view = scene.views[0];
  ASSERT_TRUE(view.truth_camera.has_value());
  EXPECT_LT(norm(view.camera.centre() - s.views[0].teacher.camera.centre()), 1e-6);
  EXPECT_LT(norm(view.truth_camera->centre() - s.views[0].truth.camera.centre()), 1e-6);
  EXPECT_GT(norm(view.camera.centre() - view.truth_camera->centre()), 1e-4);
  EXPECT_EQ(read_image(view.image).data, s.views[0].image.data);
  const ArrayHeader confidence = read_npy_header(folder / "pred_confidence" / "view_000.npy");
  EXPECT_EQ(confidence.shape, (std::vector<int64_t>{48, 64}));
  EXPECT_EQ(read_mesh_ply(scene.truth_mesh).vertices.size(), s.mesh.vertices.size());
  const ImageF depth = load_truth_depth(scene, 0, view.camera);
  EXPECT_NEAR(depth.at(30, 20), s.views[0].truth.depth.at(30, 20), 6e-4);
  EXPECT_EQ(load_truth_labels(scene, 0, view.camera).data, s.views[0].truth.labels.data);

  uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  EXPECT_NEAR(static_cast<double>(bytes), static_cast<double>(estimate_scene_bytes(small_options())),
              0.25 * static_cast<double>(bytes));
  std::filesystem::remove_all(folder);
}

TEST(SynthFolder, SegmentsAreWrittenWhenAskedFor) {
  SynthOptions options = small_options();
  options.segments = SegmentTeacher::kTeacher;
  ThreadPool pool(2);
  const SynthScene made = make_synth_scene(options, pool);
  EXPECT_EQ(made.views[0].scores.values, small_scene().views[0].scores.values) << "the labels stay as they are";
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "synth_segments";
  write_synth_scene(made, folder, true);
  const Scene scene = open_scene(folder);
  EXPECT_TRUE(has_segments(scene));
  EXPECT_EQ(read_segments(segment_file_of(scene, scene.views[0]), scene.labels.size()).of_pixel,
            made.views[0].segments.of_pixel);
  const AcceptanceReport report = measure_acceptance(made, pool);
  EXPECT_GT(report.value("panoptic quality"), 0.1);
  EXPECT_NE(report.table().find("0.506"), std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST(SynthFolder, TrueSegmentsHaveNoError) {
  SynthOptions options = small_options();
  options.segments = SegmentTeacher::kTrue;
  ThreadPool pool(2);
  EXPECT_DOUBLE_EQ(measure_acceptance(make_synth_scene(options, pool), pool).value("panoptic quality"), 1);
}

TEST(SynthFolder, ADefaultSceneStaysBelow200Megabytes) { EXPECT_LT(estimate_scene_bytes({}), 200000000u); }

TEST(Acceptance, AnExactTeacherHasNoErrors) {
  SynthOptions o = small_options();
  o.teacher = TeacherKind::kExact;
  ThreadPool pool(2);
  const AcceptanceReport report = measure_acceptance(make_synth_scene(o, pool), pool);
  EXPECT_LT(report.value("point accuracy mean"), 0.01);
  EXPECT_LT(report.value("pair pose error mean (max 3)"), 1e-5);
  EXPECT_GT(report.value("semantic pixel accuracy"), 0.9);
  EXPECT_GT(report.value("test pixels seen in training"), 0.85);
}

TEST(Acceptance, TheMediumTeacherErrsLikeANetwork) {
  ThreadPool pool(2);
  const AcceptanceReport report = measure_acceptance(small_scene(), pool);
  // At this tiny size outlines and depth edges fill more of the picture than at 320 x 240: wide margins.
  EXPECT_GT(report.value("point accuracy mean"), 2);
  EXPECT_LT(report.value("point accuracy mean"), 9);
  EXPECT_NEAR(report.value("pair pose error mean (max 3)"), 1.3, 0.8);
  EXPECT_NEAR(report.value("confidence rank correlation"), 0.5, 0.2);
  EXPECT_NEAR(report.value("mono depth RMSE"), 0.3, 0.2);
  EXPECT_GT(report.value("semantic pixel accuracy"), 0.5);
  EXPECT_LT(report.value("semantic pixel accuracy"), 0.95);
  EXPECT_NE(report.table().find("simulated"), std::string::npos);
}

}  // namespace
}  // namespace aligngs
