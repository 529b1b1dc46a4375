#include "synth/synth_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/scene.h"
#include "synth/image_degradation.h"
#include "synth/mesh_builder.h"
#include "synth/sfm_cloud.h"
#include "synth/synth_purpose.h"
#include "synth/teacher_cloud.h"
#include "synth/teacher_monodepth.h"
#include "synth/teacher_sensor.h"

namespace aligngs {
namespace {

constexpr int kMinSize = 32, kMaxSize = 4096;  // pixels
constexpr int kMaxViews = 1000;

void check_options(const SynthOptions& o) {
  const auto require = [](bool ok, const char* message, const char* remedy) {
    if (!ok) throw_usage(message, remedy);
  };
  require(o.width >= kMinSize && o.height >= kMinSize && o.width <= kMaxSize && o.height <= kMaxSize,
          "the picture size must be 32 to 4096 pixels a side", "use for example --size 320x240");
  require(o.test_views >= 0 && o.views - o.test_views >= 2, "at least two training views are needed",
          "raise --views or lower the number of test views");
  require(o.views <= kMaxViews, "at most 1000 views can be made", "lower --views");
  require(o.semantic_scale > 0 && o.semantic_scale <= 0.5, "score maps are at most half the image's size",
          "use a semantic scale in (0, 0.5]");
  require(o.depth_teacher != DepthTeacher::kSensor || !o.unknown_similarity,
          "a depth sensor measures metres: its world has no unknown scale", "leave --unknown-similarity out");
  require(o.samples_per_side >= 1 && o.samples_per_side <= 8, "1 to 8 samples per pixel side are possible",
          "use 2 or 3");
}

/// A world as scanners and networks leave it: y points down, turned by any angle, the origin inside the room.
Rigidd world_frame(const RoomModel& room, Random random) {
  const double a = random.uniform(0, 360);
  const Mat3d y_down{{1, 0, 0, 0, 0, -1, 0, 1, 0}};  // room (x, y, z up) -> (x, -z, y)
  const Mat3d rotation = y_down * placement({}, a).rotation;
  const Vec3d middle{room.width / 2, room.depth / 2, 1.2};
  return {rotation, -(rotation * middle) +
                        Vec3d{random.uniform(-0.5, 0.5), random.uniform(-0.2, 0.2), random.uniform(-0.5, 0.5)}};
}

PointCloud sparse_cloud(const SynthScene& scene, const Random& random) {
  if (scene.options.cloud == CloudTeacher::kFeedForward) {
    std::vector<TeacherCloudView> teachers;
    for (const int i : scene.train)
      teachers.push_back({&scene.views[static_cast<size_t>(i)].teacher, &scene.views[static_cast<size_t>(i)].image});
    return teacher_cloud(teachers, random);
  }
  std::vector<SfmView> views;
  for (const int i : scene.train) {
    const SynthView& view = scene.views[static_cast<size_t>(i)];
    views.push_back({&view.truth, &view.image, view.teacher.camera});
  }
  return simulate_sfm_cloud(views, {}, random);
}

/// The number of a room's kind.
uint64_t kind_of(const SynthOptions& options) {
  uint64_t kind = 0;
  while (room_kinds()[kind] != options.room) ++kind;
  return kind;
}

/// The stream of random numbers of a scene's room.
Random room_random(const SynthOptions& options) {
  return stream_of(Random(options.seed), SynthPurpose::kPictures, kind_of(options));
}

}  // namespace

LightingOptions lighting_of(const SynthOptions& options) { return {48, 3, options.shadows}; }

namespace {

ImageDegradationSettings degradation_of(const SynthOptions& options, size_t index) {
  ImageDegradationSettings settings;
  if (options.exposure == ExposureKind::kWalk)
    settings.log_gain = exposure_walk(stream_of(room_random(options), PicturePurpose::kExposure), index);
  return settings;
}

/// The stream of random numbers of a photo.
Random photo_random(const SynthOptions& options, size_t index) {
  return stream_of(room_random(options), PicturePurpose::kPhoto).fork(index);
}

}  // namespace

Image<uint8_t> photo_of(const SynthOptions& options, size_t index, const ImageF& color) {
  if (!options.degrade_images) return to_bytes(color);
  return degrade_image(color, degradation_of(options, index), photo_random(options, index));
}

std::array<double, 3> photo_exposure(const SynthOptions& options, size_t index) {
  if (!options.degrade_images) return {1, 1, 1};
  return photo_gains(degradation_of(options, index), photo_random(options, index));
}

TriangleMesh truth_mesh(const RoomModel& room, const LightCache& lights) {
  TriangleMesh mesh;
  mesh.vertices = room.positions;
  mesh.normals = room.normals;
  mesh.triangles = room.triangles;
  mesh.labels.assign(room.positions.size(), kNoLabel);
  for (size_t t = 0; t < room.triangles.size(); ++t) {
    for (const uint32_t v : room.triangles[t]) mesh.labels[v] = room.objects[room.triangle_object[t]].label;
  }
  for (const Vec3f& c : vertex_colors(room, lights)) {
    mesh.colors.push_back({static_cast<uint8_t>(std::lround(c.x * 255)), static_cast<uint8_t>(std::lround(c.y * 255)),
                           static_cast<uint8_t>(std::lround(c.z * 255))});
  }
  return mesh;
}

const ImageF& SynthScene::prior_depth(const SynthView& view) const {
  return options.teacher == TeacherKind::kSimulated && options.depth_teacher == DepthTeacher::kMono
             ? view.mono_depth
             : view.teacher.depth;
}

std::string geometry_teacher_name(const SynthOptions& o) {
  if (o.teacher == TeacherKind::kSimulated && o.depth_teacher == DepthTeacher::kSensor) return kSimulatedSensorDepth;
  return o.teacher == TeacherKind::kExact ? "exact"
                                          : fmt::format("simulated feed-forward ({})", teacher_level_name(o.level));
}

std::string depth_teacher_name(const SynthOptions& o) {
  if (o.teacher == TeacherKind::kExact || o.depth_teacher != DepthTeacher::kMono) return geometry_teacher_name(o);
  return fmt::format("simulated mono-depth ({})", teacher_level_name(o.level));
}

std::string semantic_teacher_name(const SynthOptions& o) {
  if (o.labels == LabelTeacher::kTrue) return "exact";
  if (o.labels != LabelTeacher::kTeacher) return fmt::format("placebo, {} labels", label_teacher_name(o.labels));
  return o.teacher == TeacherKind::kExact ? "exact"
                                          : fmt::format("simulated Mask2Former ({})", teacher_level_name(o.level));
}

std::string segment_teacher_name(const SynthOptions& o) {
  if (o.segments == SegmentTeacher::kNone) return "";
  return o.segments == SegmentTeacher::kTrue || o.teacher == TeacherKind::kExact
             ? "exact"
             : fmt::format("simulated EoMT panoptic ({})", teacher_level_name(o.level));
}

namespace {

/// Segments of all views; nothing without a teacher of them. `random`: of the semantic teacher, whose confusions are
/// also those of its segments.
std::vector<SegmentMap> segments_of(const SynthOptions& o, const std::vector<RenderedView>& views,
                                    const RoomModel& room, const Random& random, ThreadPool& pool) {
  std::vector<SegmentMap> out(views.size());
  if (o.segments == SegmentTeacher::kNone) return out;
  if (o.segments == SegmentTeacher::kTeacher && o.teacher == TeacherKind::kSimulated) {
    const SemanticTeacherSettings semantic = semantic_teacher_settings(o.level);
    return simulate_panoptic_teacher(
        views, room, draw_object_confusions(views, room, semantic, stream_of(random, ClassPurpose::kConfusions)),
        panoptic_teacher_settings(o.level), semantic, stream_of(random, ClassPurpose::kSegments), pool);
  }
  for (size_t i = 0; i < views.size(); ++i) out[i] = exact_segments(views[i]);
  return out;
}

}  // namespace

SynthScene make_synth_scene(const SynthOptions& options, ThreadPool& pool, const SynthProgress& progress) {
  check_options(options);
  const auto report = [&](double share, const char* what) {
    if (progress) progress(share, what);
  };
  report(0, "furnishing the room");
  SynthScene scene;
  scene.options = options;
  scene.room = build_room({options.room, options.seed, options.glossy, options.strong_gloss});
  scene.bare_share = scene.room.bare_area_share();
  const Random teacher_base = stream_of(Random(options.teacher_seed != 0 ? options.teacher_seed : options.seed),
                                        SynthPurpose::kTeacherBase, kind_of(options));
  const auto teacher_random = [&](TeacherPurpose purpose) { return stream_of(teacher_base, purpose); };
  scene.room.move_to_world(world_frame(scene.room, stream_of(room_random(options), PicturePurpose::kWorldFrame)));
  scene.up = scene.room.room_to_world.rotation.column(2);

  report(0.02, "lighting the room");
  const RoomRays rays(scene.room);
  const LightCache lights = light_room(rays, pool, lighting_of(options));
  scene.exposure = lights.exposure;
  scene.mesh = truth_mesh(scene.room, lights);

  report(0.3, "walking through the room");
  TrajectoryOptions walk;
  walk.training_views = options.views - options.test_views;
  walk.test_views = options.test_views;
  walk.width = options.width;
  walk.height = options.height;
  walk.seed = options.seed;
  const std::vector<PlannedView> plan = plan_views(rays, walk, pool);

  std::vector<RenderedView> rendered;
  for (size_t i = 0; i < plan.size(); ++i) {
    report(0.35 + 0.4 * static_cast<double>(i) / static_cast<double>(plan.size()), "taking pictures");
    rendered.push_back(render_view(rays, &lights, plan[i].camera, {true, options.samples_per_side}, pool));
  }

  report(0.75, "running the geometry teacher");
  const bool exact = options.teacher == TeacherKind::kExact;
  GeometryTeacherSettings settings = geometry_teacher_settings(options.level);
  settings.similarity = options.unknown_similarity;
  const Vec3d centre =
      scene.room.room_to_world * Vec3d{scene.room.width / 2, scene.room.depth / 2, scene.room.height / 2};
  GeometryTeacher geometry =
      exact ? exact_geometry_teacher(rendered)
      : options.depth_teacher == DepthTeacher::kSensor
          ? simulate_depth_sensor(rendered, {}, teacher_random(TeacherPurpose::kGeometry), pool)
          : simulate_geometry_teacher(rendered, settings, centre, std::max(scene.room.width, scene.room.depth),
                                      scene.up, teacher_random(TeacherPurpose::kGeometry), pool);
  scene.teacher_world = geometry.world;
  report(0.85, "running the semantic teacher");
  std::vector<ScoreMap> scores =
      exact || options.labels == LabelTeacher::kTrue
          ? exact_semantic_teacher(rendered, options.semantic_scale, pool)
          : simulate_semantic_teacher(rendered, scene.room, semantic_teacher_settings(options.level),
                                      options.semantic_scale, teacher_random(TeacherPurpose::kClasses), pool);
  apply_label_control(options.labels, scores, teacher_random(TeacherPurpose::kLabelControl));
  std::vector<SegmentMap> segments =
      segments_of(options, rendered, scene.room, teacher_random(TeacherPurpose::kClasses), pool);

  report(0.95, "developing the pictures");
  scene.views.resize(plan.size());
  const MonoDepthSettings mono = mono_depth_settings(options.level);
  const Random mono_random = teacher_random(TeacherPurpose::kMonoDepth);
  pool.parallel_for(plan.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      SynthView& view = scene.views[i];
      view.name = fmt::format("view_{:03d}", i);
      view.role = plan[i].role;
      view.teacher = std::move(geometry.views[i]);
      view.scores = std::move(scores[i]);
      view.segments = std::move(segments[i]);
      if (!exact) view.mono_depth = simulate_mono_depth(rendered[i], i, mono, mono_random);
      view.image = photo_of(options, i, rendered[i].color);
      view.truth = std::move(rendered[i]);
    }
  });
  for (size_t i = 0; i < scene.views.size(); ++i) {
    (scene.views[i].role == ViewRole::kTraining ? scene.train : scene.test).push_back(static_cast<int>(i));
  }
  scene.cloud = sparse_cloud(scene, teacher_random(TeacherPurpose::kSparseCloud));
  report(1, "done");
  return scene;
}

}  // namespace aligngs
