// A complete synthetic scene: room, pictures, exact truth, simulated teachers; in memory or as a scene folder.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "scene/point_cloud.h"
#include "scene/triangle_mesh.h"
#include "synth/label_controls.h"
#include "synth/rooms.h"
#include "synth/shading.h"
#include "synth/teacher_geometry.h"
#include "synth/teacher_panoptic.h"
#include "synth/teacher_semantic.h"
#include "synth/trajectory.h"

namespace aligngs {

enum class TeacherKind { kExact, kSimulated };
enum class CloudTeacher { kFeedForward, kSfm };  ///< where sparse/points3D comes from
/// Who fills pred_depths/. kSensor also replaces the cameras by those of a phone's tracker.
enum class DepthTeacher { kFeedForward, kMono, kSensor };
/// Who fills segments/; kNone leaves the folder out.
enum class SegmentTeacher { kNone, kTeacher, kTrue };
/// How a camera exposes: each photo by itself, or an automatic exposure that drifts along the walk.
enum class ExposureKind { kPerPhoto, kWalk };

struct SynthOptions {
  std::string room = "bedroom";   ///< bedroom, living, kitchen or office
  int views = 28;                 ///< training and test together
  int test_views = 8;             ///< half near the training path, half far from it
  int width = 320, height = 240;  ///< pixels, 32 to 4096
  uint64_t seed = 1;              ///< of room, furniture, light, walk and teachers
  uint64_t teacher_seed = 0;      ///< 0: follows `seed`; otherwise another teacher for the same room
  TeacherKind teacher = TeacherKind::kSimulated;
  TeacherLevel level = TeacherLevel::kMedium;
  DepthTeacher depth_teacher = DepthTeacher::kFeedForward;
  CloudTeacher cloud = CloudTeacher::kFeedForward;
  LabelTeacher labels = LabelTeacher::kTeacher;
  SegmentTeacher segments = SegmentTeacher::kNone;
  bool unknown_similarity = false;  ///< teacher's world with unknown scale and rotation, as a real network's
  bool degrade_images = true;       ///< noise, blur, exposure, white balance, JPEG
  ExposureKind exposure = ExposureKind::kPerPhoto;
  bool glossy = true;           ///< polished floor and table tops
  bool strong_gloss = false;    ///< also dark tables, a mirror, and windows that one looks through (gloss.h)
  double semantic_scale = 0.4;  ///< size of the score maps relative to the images, at most 0.5
  int samples_per_side = 2;     ///< antialiasing: n x n rays per pixel
  bool shadows = true;          ///< false: a draft without shadows and interreflection, in a tenth of the time
};

/// One view with everything that is known of it.
struct SynthView {
  std::string name;  ///< "view_000", ... in the order of the walk
  ViewRole role = ViewRole::kTraining;
  RenderedView truth;    ///< exact camera and maps, clean colour
  Image<uint8_t> image;  ///< the photo
  TeacherView teacher;   ///< camera, depth and confidence of the (simulated) reconstruction network
  ImageF mono_depth;     ///< of the simulated single-image network; empty with exact teachers
  ScoreMap scores;
  SegmentMap segments;  ///< empty without a teacher of them
};

struct SynthScene {
  SynthOptions options;
  RoomModel room;  ///< in the world of the exact cameras
  Vec3d up;        ///< unit, world
  std::vector<SynthView> views;
  std::vector<int> train, test;
  TriangleMesh mesh;  ///< the room's surface with labels and colours
  /// sparse/points3D: confident pixels of the teacher's depth, or corners triangulated with its cameras
  PointCloud cloud;
  Similarity teacher_world;  ///< true world -> teacher's world; identity unless unknown_similarity
  double bare_share = 0;     ///< of the surface area: near-white without texture
  float exposure = 1;        ///< of the camera (LightCache::exposure)

  const ImageF& prior_depth(const SynthView& view) const;  ///< what pred_depths/ holds
};

/// How a scene's room is lit.
LightingOptions lighting_of(const SynthOptions& options);
/// The photo of view `index` whose perfect picture is `color`: every view has a noise and an exposure of its own.
Image<uint8_t> photo_of(const SynthOptions& options, size_t index, const ImageF& color);
/// Its exposure and white balance: factors of red, green and blue, linear light.
std::array<double, 3> photo_exposure(const SynthOptions& options, size_t index);
/// A room's surface with labels, and with colours under the light.
TriangleMesh truth_mesh(const RoomModel& room, const LightCache& lights);

/// Called with the share done in [0, 1] and what is being done.
using SynthProgress = std::function<void(double, const std::string&)>;

/// Makes a scene in memory. The same options give the same bits for any number of threads. Impossible options
/// are Error{kUsage}.
SynthScene make_synth_scene(const SynthOptions& options, ThreadPool& pool, const SynthProgress& progress = {});

/// Writes the scene folder of the design: images, sparse/ and priors of the teacher, truth/. priors.json says whether
/// they are exact or simulated. `pred_confidence/<stem>.npy` (float16, H x W, >= 1 as VGGT's, 0 = no value) is an extra
/// that readers may ignore. `overwrite` as in SceneWriter.
void write_synth_scene(const SynthScene& scene, const std::filesystem::path& folder, bool overwrite = false);

/// Bytes that write_synth_scene will need, within some ten per cent.
uint64_t estimate_scene_bytes(const SynthOptions& options);

/// "simulated feed-forward (medium)", "exact", ...: the names used in priors.json, reports and tables.
std::string geometry_teacher_name(const SynthOptions& options);
std::string depth_teacher_name(const SynthOptions& options);
std::string semantic_teacher_name(const SynthOptions& options);
/// "simulated EoMT panoptic (medium)"; empty without one.
std::string segment_teacher_name(const SynthOptions& options);

}  // namespace aligngs
