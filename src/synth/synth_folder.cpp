// Writing a synthetic scene as a scene folder.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/half.h"
#include "io/atomic_file.h"
#include "room/room_json.h"
#include "scene/scene_writer.h"
#include "synth/removal_truth.h"
#include "synth/room_truth.h"
#include "synth/synth_scene.h"
#include "synth/teacher_sensor.h"

namespace aligngs {
namespace {

PriorsJson priors_of(const SynthScene& scene) {
  const SynthOptions& o = scene.options;
  const bool exact = o.teacher == TeacherKind::kExact;
  const GeometryTeacherSettings g = geometry_teacher_settings(o.level);
  const SemanticTeacherSettings s = semantic_teacher_settings(o.level);
  const auto number = [](double x) { return fmt::format("{:g}", x); };
  PriorsJson priors;
  priors.depth = PriorJson{depth_teacher_name(o), "", {}};
  const bool mono = !exact && o.depth_teacher == DepthTeacher::kMono;
  priors.depth_scale = mono ? DepthScale::kMetres : DepthScale::kScene;
  auto& d = priors.depth->settings;
  d["poses"] = geometry_teacher_name(o);
  d["world"] = o.unknown_similarity && !exact ? "unknown scale and rotation" : "metric, true scale and rotation";
  d["confidence"] = "pred_confidence/<stem>.npy, float16, >= 1, 0 = no value";
  const bool sensor = !exact && o.depth_teacher == DepthTeacher::kSensor;
  if (sensor) {
    const DepthSensorSettings t;
    d["seed"] = std::to_string(o.teacher_seed != 0 ? o.teacher_seed : o.seed);
    d["range_m"] = number(t.range);
    d["noise_m"] = fmt::format("{:g} + {:g} z^2", t.noise, t.noise_growth);
    d["multipath_m"] = number(t.multipath);
    d["columns"] = std::to_string(t.columns);
    d["rotation_degrees"] = number(t.rotation_degrees);
    d["translation_m"] = number(t.translation);
  } else if (!exact) {
    d["seed"] = std::to_string(o.teacher_seed != 0 ? o.teacher_seed : o.seed);
    d["bend_rms_m"] = number(g.bend_rms);
    d["bend_degrees"] = number(g.bend_degrees);
    d["rotation_degrees"] = number(g.rotation_degrees);
    d["translation_m"] = number(g.translation);
    d["outlier_share"] = number(g.outlier_share);
    d["shared_focal"] = number(g.shared_focal);
    d["view_focal"] = number(g.view_focal);
    d["warp_rms"] = number(g.warp_rms);
    d["edge_width_px"] = number(g.edge_width);
  }
  priors.semantics = PriorJson{semantic_teacher_name(o), "", {}};
  priors.kind = SemanticKind::kScores;
  if (o.segments != SegmentTeacher::kNone) priors.semantics->settings["segments"] = segment_teacher_name(o);
  if (!exact) {
    priors.semantics->settings["outline_rms_px"] = number(s.outline_rms);
    priors.semantics->settings["confused_share"] = number(s.confused_share);
    priors.semantics->settings["flip"] = number(s.flip);
  }
  return priors;
}

/// Log gains of all photos, in the layout of exposure.json.
std::string exposure_truth(const SynthScene& scene) {
  nlohmann::json gains = nlohmann::json::object();
  for (size_t i = 0; i < scene.views.size(); ++i) {
    nlohmann::json& log_gain = gains[scene.views[i].name] = nlohmann::json::array();
    for (const double gain : photo_exposure(scene.options, i)) log_gain.push_back(std::log(gain));
  }
  return nlohmann::json{{"log_gains", std::move(gains)}}.dump(1) + "\n";
}

SemanticMap map_of(const ScoreMap& scores) {
  SemanticMap map{scores.channels, scores.width, scores.height, {}};
  map.values.reserve(scores.values.size());
  for (const uint16_t v : scores.values) map.values.push_back(half_to_float(v));
  return map;
}

}  // namespace

void write_synth_scene(const SynthScene& scene, const std::filesystem::path& folder, bool overwrite,
                       const std::vector<RemovalTruth>& removals) {
  const SynthOptions& o = scene.options;
  SceneWriter writer(folder, overwrite);
  if (o.segments != SegmentTeacher::kNone) std::filesystem::create_directories(writer.folder() / "segments");
  SceneParts parts;
  parts.split.train.emplace();
  parts.split.test.emplace();
  for (const SynthView& view : scene.views) {
    SceneViewParts v{};
    v.name = view.name;
    v.camera = view.teacher.camera;
    v.image = view.image;  // already coded as JPEG once; PNG keeps exactly those pixels
    v.prior_depth = scene.prior_depth(view);
    v.prior_confidence = view.teacher.confidence;
    v.semantics = map_of(view.scores);
    v.truth_depth = view.truth.depth;
    v.truth_labels = view.truth.labels;
    v.truth_camera = view.truth.camera;
    writer.add_view(v);
    if (!view.segments.empty()) write_segments(writer.folder() / "segments" / (view.name + ".png"), view.segments);
    (view.role == ViewRole::kTraining ? parts.split.train : parts.split.test)->push_back(view.name);
  }
  const bool arbitrary = o.unknown_similarity && o.teacher == TeacherKind::kSimulated;
  parts.description.metric = !arbitrary;
  if (!arbitrary) parts.description.up = scene.up;
  parts.description.source = fmt::format(
      "synthetic {}, seed {}{}, {}, world axes arbitrary", o.room, o.seed, o.strong_gloss ? ", strong gloss" : "",
      o.teacher == TeacherKind::kExact ? std::string("exact teachers")
                                       : fmt::format("simulated teachers ({})", teacher_level_name(o.level)));
  parts.priors = priors_of(scene);
  parts.cloud = scene.cloud;
  parts.truth_mesh = scene.mesh;
  writer.write(parts);
  write_room(writer.folder() / "truth" / "room.json", room_truth(scene.room));
  write_file_atomically(writer.folder() / "truth" / "objects.json", room_objects_json(scene.room));
  if (o.exposure == ExposureKind::kWalk)
    write_file_atomically(writer.folder() / "truth" / "exposure.json", exposure_truth(scene));
  for (const RemovalTruth& removal : removals)
    write_removal_truth(scene, removal, writer.folder() / "truth" / "without");
  writer.commit();
}

void write_synth_scene(const SynthScene& scene, const std::filesystem::path& folder, bool overwrite) {
  write_synth_scene(scene, folder, overwrite, {});
}

uint64_t estimate_scene_bytes(const SynthOptions& o) {
  const uint64_t pixels = static_cast<uint64_t>(o.width) * static_cast<uint64_t>(o.height);
  // Most of the 150 values of two bytes are zero: maps take this share once they are compressed.
  constexpr double kCompressed = 0.05;
  const uint64_t scores =
      static_cast<uint64_t>(150 * 2 * kCompressed * static_cast<double>(pixels) * o.semantic_scale * o.semantic_scale);
  // Per pixel: noisy PNG 2.3, depth 4, confidence 2, truth depth about 1.2, labels 0.1 bytes.
  const uint64_t view = scores + pixels * 96 / 10;
  constexpr uint64_t kMesh = 13000000;     // about 230,000 vertices of 27 bytes and 400,000 faces of 13
  constexpr uint64_t kCloud = 30000 * 51;  // COLMAP points with a track of one
  return static_cast<uint64_t>(o.views) * view + kMesh + kCloud;
}

}  // namespace aligngs
