#include "train/training_scene.h"

#include <fmt/format.h>

#include <vector>

#include "core/error.h"
#include "core/log.h"
#include "io/colmap.h"
#include "scene/ignored_classes.h"

namespace aligngs {
namespace {

/// Leaves out what can be left out. Error{kBadInput} for the first problem that cannot.
void check_views(Scene& scene) {
  log_info("checking {} views", scene.train.size() + scene.test.size());
  const std::vector<SceneProblem> problems = leave_out_bad_views(scene, check_scene(scene));
  const SceneProblem* first = nullptr;
  size_t fatal = 0;
  for (const SceneProblem& problem : problems) {
    if (!problem.fatal) {
      log_warning("{}: {}: {}", problem.path.string(), problem.field, problem.message);
      continue;
    }
    if (!first) first = &problem;
    ++fatal;
  }
  if (!first) return;
  std::string message = first->message;
  if (fatal > 1) message += fmt::format(" (and {} more problems: 'aligngs data check' lists them)", fatal - 1);
  throw_bad_input(first->path, first->field, message, first->remedy);
}

}  // namespace

TrainingScene open_training_scene(const std::filesystem::path& folder, const TrainConfig& config,
                                  const TrainingSceneRules& rules) {
  TrainingScene out;
  Scene& scene = out.scene = open_scene(folder);
  scene.ignored = ignored_classes(scene.labels, config.data.ignore);
  if (scene.train.empty())
    throw_bad_input(folder, "train", "the scene has no training view", "list training views in split.json");
  if (const std::string choice = choice_of_model(folder); !choice.empty()) log_warning("{}", choice);
  check_views(scene);
  const size_t used = scene.train.size() + scene.test.size();
  require_enough(folder, used, scene.left_out, kFewestTrainingViews, rules.strict, "views");
  warn_left_out(used, scene.left_out, "views");
  out.use = decide_prior_use(scene, config);
  if (rules.labels_unwanted) std::erase(out.use.warnings, kWithoutLabels);
  if (rules.require_priors && !out.use.warnings.empty()) {
    throw Error(
        {ErrorKind::kWeights, out.use.warnings.front(), folder, {}, "make the priors, or leave --require-priors out"});
  }
  if (!out.use.depth_note.empty())
    log_info("prior depth of {}: {}", scene.prior_source.empty() ? "unknown origin" : scene.prior_source,
             out.use.depth_note);
  check_prior_confidence(scene, config, out.use);
  out.fingerprint = scene_fingerprint(scene);
  out.extent = robust_extent(scene);
  return out;
}

}  // namespace aligngs
