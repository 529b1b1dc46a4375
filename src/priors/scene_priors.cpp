#include "priors/scene_priors.h"

#include <fmt/format.h>

#include "core/error.h"
#include "priors/depth_teacher.h"
#include "priors/prior_files.h"
#include "priors/teacher_list.h"
#include "scene/scene_json.h"

namespace aligngs {
namespace {

const DepthFamily& depth_family(const PublishedModel& model) {
  const Teacher* const row = find_teacher(model.name);
  if (row && row->depth) return *row->depth;
  throw_usage(model.name + " is no network for depth", "see `aligngs priors --help` for the names");
}

}  // namespace

void add_depth_memory(MemoryBudget& budget, const ModelStore& store, const PublishedModel& model,
                      const std::vector<NetworkInput>& photos, const NetworkMemoryOptions& options) {
  depth_family(model).add_memory(budget, store, model, photos, options);
}

ScenePriorsReport fill_depth(const std::filesystem::path& folder, const ModelStore& store, const PublishedModel& model,
                             const ScenePriorsOptions& options) {
  const Scene scene = open_scene(folder);
  PriorsJson notes = read_priors_json(folder / "priors.json");
  ScenePriorsReport report;
  report.model = model.name;
  if (standing_of_prior(scene, {"depth", &View::prior_depth, notes.depth, model.name, options.overwrite}) ==
      PriorStanding::kKeep) {
    report.was_there = true;
    return report;
  }
  ThreadPool pool(options.threads);
  const DepthFamily& family = depth_family(model);
  MemoryBudget budget(options.memory_limit);
  family.add_memory(budget, store, model, sizes_of_training_photos(scene), {options.precision, pool.size()});
  budget.require(model.name, std::string(family.lighter) + ", or more memory with --memory");
  notes.depth = PriorJson{model.name, "", {}};
  if (family.has_confidence) notes.depth->settings["drop_percent"] = fmt::format("{:g}", options.drop_percent);
  notes.depth_scale = family.scale;
  family.fill(scene, store, model, notes, options, pool, report);
  return report;
}

}  // namespace aligngs
