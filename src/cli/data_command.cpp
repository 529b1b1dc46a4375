// `aligngs data check SCENE`: what is wrong with a data set, per file, before hours are spent.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "core/error.h"
#include "scene/view_data.h"

namespace aligngs {
namespace {

void print_problems(const std::vector<SceneProblem>& problems) {
  for (const SceneProblem& p : problems) {
    std::printf("%s %s%s%s: %s\n", p.fatal ? "error  " : "warning", p.path.string().c_str(), p.field.empty() ? "" : ": ", p.field.c_str(), p.message.c_str());
    if (!p.remedy.empty()) std::printf("        remedy: %s\n", p.remedy.c_str());
  }
}

void check(const std::string& folder, bool json) {
  SceneOptions options;
  options.check_headers = false;  // everything is listed, not only the first problem
  const Scene scene = open_scene(folder, options);
  const std::vector<SceneProblem> problems = check_scene(scene);
  size_t fatal = 0;
  nlohmann::json list = nlohmann::json::array();
  for (const SceneProblem& p : problems) {
    fatal += p.fatal;
    list.push_back({{"fatal", p.fatal}, {"path", p.path.string()}, {"field", p.field}, {"message", p.message}, {"remedy", p.remedy}});
  }
  if (json) {
    std::printf("%s\n", nlohmann::json({{"views", scene.views.size()}, {"train", scene.train.size()}, {"test", scene.test.size()},
                                        {"errors", fatal}, {"warnings", problems.size() - fatal}, {"problems", list}})
                            .dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    print_problems(problems);
    std::printf("%zu views (%zu training, %zu test), %zu points, depth priors: %s, semantics: %s; %zu errors, %zu warnings\n", scene.views.size(),
                scene.train.size(), scene.test.size(), scene.cloud.size(), scene.has_prior_depth() ? "yes" : "no",
                scene.has_semantics() ? "yes" : "no", fatal, problems.size() - fatal);
  }
  if (fatal > 0) throw_bad_input(folder, "", std::to_string(fatal) + " problems would stop a training", "correct the files listed above");
}

}  // namespace

void add_data_command(CLI::App& program, CommandContext& context) {
  CLI::App* data = program.add_subcommand("data", "Look after data sets");
  data->group("Data");
  data->require_subcommand(1);
  data->footer("Example: aligngs data check scene");
  CLI::App* command = data->add_subcommand("check", "Open every file of a scene and list what is wrong, per image");
  command->footer("Example: aligngs data check scene");
  auto folder = std::make_shared<std::string>();
  command->add_option("scene", *folder, "scene folder")->required();
  command->callback([&context, folder] { check(*folder, context.global.json); });
}

}  // namespace aligngs
