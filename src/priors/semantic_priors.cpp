#include <fmt/format.h>

#include <optional>

#include "core/error.h"
#include "core/half.h"
#include "core/stop_signal.h"
#include "priors/prior_files.h"
#include "priors/scene_priors.h"
#include "priors/semantic_teacher.h"
#include "priors/teacher_list.h"
#include "scene/prior_maps.h"
#include "scene/scene_json.h"

namespace aligngs {
namespace {

/// A map of classes as its file has it: [classes, height, width] in float16.
std::vector<uint16_t> halves_by_class(nn::Compute& compute, const nn::FeatureMap& map) {
  const int64_t places = map.places(), classes = map.channels;
  constexpr int64_t kChunk = 256;  // places: their values of all classes stay in the second cache
  std::vector<uint16_t> half(static_cast<size_t>(places * classes));
  const float* const values = map.data.data();
  compute.for_rows(places, kChunk, [&](int64_t begin, int64_t count, nn::Scratch&) {
    for (int64_t c = 0; c < classes; ++c) {
      for (int64_t p = begin; p < begin + count; ++p)
        half[size_t(c * places + p)] = float_to_half(values[p * classes + c]);
    }
  });
  return half;
}

}  // namespace

ScenePriorsReport fill_semantics(const std::filesystem::path& folder, const ModelStore& store,
                                 const PublishedModel& model, const ScenePriorsOptions& options) {
  const Scene scene = open_scene(folder);
  PriorsJson notes = read_priors_json(folder / "priors.json");
  ScenePriorsReport report;
  report.model = model.name;
  report.makes_segments = makes_segments(model);
  const bool complete = !report.makes_segments || has_segments(scene);
  if (standing_of_prior(scene, {"semantics", &View::semantics, notes.semantics, model.name, options.overwrite,
                                complete}) == PriorStanding::kKeep) {
    report.was_there = true;
    return report;
  }
  ThreadPool pool(options.threads);
  MemoryBudget budget(options.memory_limit);
  add_semantic_memory(budget, store, model, options.augment, sizes_of_training_photos(scene),
                      {options.precision, pool.size()});
  const Teacher* const row = find_teacher(model.name);
  budget.require(model.name, row && *row->lighter != '\0'
                                 ? row->lighter
                                 : "use a light network (--semantics linear-s), or more memory with --memory");
  nn::Compute compute(pool, {options.precision, true, true, options.make_device ? options.make_device() : nullptr});
  const std::unique_ptr<SemanticTeacher> teacher =
      load_semantic_teacher(compute, store, model, options.augment, options.mask2former_heads);
  const int64_t classes = teacher->classes();
  if (scene.labels.size() != int(classes)) {
    throw_bad_input(folder / "labels.csv", "classes",
                    fmt::format("the scene has {} classes, the network knows {}", scene.labels.size(), classes),
                    "remove labels.csv: without it the classes are ADE20K's 150");
  }
  notes.semantics = PriorJson{model.name, digest_of_weights(store, model), {}};
  if (options.augment) notes.semantics->settings["augmented"] = "yes";
  notes.kind = teacher->kind();
  PriorFiles fill(scene, "segmentation_logits", false);
  Progress progress(options.progress, "semantics", scene.train.size());
  for (const int i : scene.train) {
    stop_if_requested();
    const View& view = scene.views[size_t(i)];
    const TeacherMapSize size = teacher->map_size(view.camera.width, view.camera.height);
    const Image<uint8_t> rgb = photo_for_network(view);
    const nn::FeatureMap map = teacher->map(compute, rgb, size.width, size.height);
    fill.add_semantics(view.name, {classes, map.height, map.width}, halves_by_class(compute, map));
    if (const std::optional<SegmentMap> segments = teacher->segments(compute, rgb)) {
      fill.add_segments(view.name, *segments);
      report.segments += segments->list.size();
    }
    report.width = size.width;
    report.height = size.height;
    progress.update(++report.written);
  }
  fill.finish(&PriorsJson::semantics, notes);
  return report;
}

}  // namespace aligngs
