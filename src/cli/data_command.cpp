// `aligngs data check SCENE`: what is wrong with a data set, per file, before hours are spent. `aligngs data simulate
// SCENE`: a capture as a network would see it.
#include <CLI/App.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/number_checks.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "scene/view_data.h"
#include "synth/simulated_priors.h"

namespace aligngs {
namespace {

void print_problems(const std::vector<SceneProblem>& problems) {
  for (const SceneProblem& p : problems) {
    std::printf("%s %s%s%s: %s\n", p.fatal ? "error  " : "warning", p.path.string().c_str(),
                p.field.empty() ? "" : ": ", p.field.c_str(), p.message.c_str());
    if (!p.remedy.empty()) std::printf("        remedy: %s\n", p.remedy.c_str());
  }
}

void check(const std::string& folder, bool json) {
  SceneOptions options;
  options.check_headers = false;  // everything is listed, not only the first problem
  const Scene scene = open_scene(folder, options);
  std::vector<SceneProblem> problems;
  for (const LeftOut& view : scene.left_out)
    problems.push_back({scene.folder / view.name, "", view.reason, view.remedy, true, view.name});
  for (SceneProblem& problem : check_scene(scene)) problems.push_back(std::move(problem));
  size_t fatal = 0;
  nlohmann::json list = nlohmann::json::array();
  for (const SceneProblem& p : problems) {
    fatal += p.fatal;
    list.push_back({{"fatal", p.fatal},
                    {"path", p.path.string()},
                    {"field", p.field},
                    {"message", p.message},
                    {"remedy", p.remedy}});
  }
  if (json) {
    const nlohmann::json document = {{"views", scene.views.size()},         {"train", scene.train.size()},
                                     {"test", scene.test.size()},           {"errors", fatal},
                                     {"warnings", problems.size() - fatal}, {"problems", list}};
    print_json(document);
  } else {
    print_problems(problems);
    std::printf(
        "%zu views (%zu training, %zu test), %zu points, depth priors: %s, semantics: %s; %zu errors, %zu warnings\n",
        scene.views.size(), scene.train.size(), scene.test.size(), scene.cloud.size(),
        scene.has_prior_depth() ? "yes" : "no", scene.has_semantics() ? "yes" : "no", fatal, problems.size() - fatal);
  }
  if (fatal > 0)
    throw_bad_input(folder, "", std::to_string(fatal) + " problems would stop a training or leave views out of it",
                    "correct the files listed above");
}

struct SimulateOptions {
  std::string scene, output, level = "medium";
  SimulatedPriorOptions priors;
};

void simulate(const CommandContext& context, SimulateOptions options) {
  options.priors.level = parse_teacher_level(options.level);
  ThreadPool pool(context.global.threads);
  write_simulated_priors(open_scene(options.scene), options.output, options.priors, pool);
  std::printf("%s: cameras, depth and points of a simulated network (%s, seed %llu)\n", options.output.c_str(),
              options.level.c_str(), static_cast<unsigned long long>(options.priors.seed));
}

void add_simulate(CLI::App& data, CommandContext& context) {
  CLI::App* command =
      data.add_subcommand("simulate", "Give a capture with a true surface the simulated priors of a network");
  command->footer(help_footer(
      {.reads = "a scene folder in metres with truth/mesh.ply",
       .writes = "a scene folder",
       .example = "aligngs data simulate kitchen -o kitchen_simulated",
       .advanced = "aligngs data simulate kitchen -o kitchen_simulated --level high --seed 2",
       .notes = "Cameras, depth, confidence and points get the errors of the simulated teacher of `aligngs synth`.\n"
                "Labels are not made."}));
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("scene", options->scene, "scene folder in metres with truth/mesh.ply")->required();
  command->add_option("-o,--output", options->output, "scene folder to write")->required()->group("Output folder");
  command->add_option("--level", options->level, "size of the simulated errors")
      ->check(CLI::IsMember(teacher_level_names()))
      ->capture_default_str();
  command->add_option("--seed", options->priors.seed, "seed of all errors")
      ->check(seed_number())
      ->capture_default_str();
  command->add_flag("--overwrite", options->priors.overwrite, "replace a scene that aligngs wrote");
  command->callback([&context, options] { simulate(context, *options); });
}

}  // namespace

void add_data_command(CLI::App& program, CommandContext& context) {
  CLI::App* data = program.add_subcommand("data", "Check data sets, or simulate priors for them");
  data->group("Data");
  data->require_subcommand(1);
  data->footer(help_footer({.reads = "a scene folder",
                            .writes = "nothing (check), or a scene folder (simulate)",
                            .example = "aligngs data check scene",
                            .advanced = "aligngs data simulate kitchen -o kitchen_simulated"}));
  CLI::App* command = data->add_subcommand("check", "Open every file of a scene and list the faults of each image");
  command->footer(help_footer({.reads = "every file of a scene folder",
                               .writes = "nothing",
                               .example = "aligngs data check scene",
                               .advanced = "aligngs data check scene --json"}));
  auto folder = std::make_shared<std::string>();
  command->add_option("scene", *folder, "scene folder")->required();
  command->callback([&context, folder] { check(*folder, context.global.json); });
  add_simulate(*data, context);
}

}  // namespace aligngs
