// `aligngs models`: the published weights, listed, fetched, checked, found, imported.
#include <fmt/format.h>
#include <unistd.h>
#include <CLI/App.hpp>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/help_text.h"
#include "cli/photo_options.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "core/log.h"
#include "priors/model_download.h"
#include "priors/model_sets.h"
#include "priors/network_time.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

ModelStore store_of(const CommandContext& context) {
  return ModelStore(ModelStoreOptions::from_environment(context.global.offline));
}

/// "ours", "partly", "no"
std::string state_of(const ModelStore& store, const PublishedModel& model) {
  size_t found = 0;
  std::string place;
  for (const ModelFile& file : model.files) {
    const auto located = store.find(model, file);
    if (!located) continue;
    ++found;
    place = name_of(located->place);
  }
  if (found == 0) return "no";
  return found < model.files.size() ? "partly" : place;
}

std::string licence_line(const ModelLicence& licence) {
  return licence.id + (licence.note.empty() ? "" : " (" + licence.note + ")") +
         (licence.gated ? ", form to fill in first" : "");
}

Json model_json(const ModelStore& store, const PublishedModel& model) {
  Json files = Json::array();
  for (const ModelFile& file : model.files) {
    const auto located = store.find(model, file);
    const auto record = store.record(model, file);
    files.push_back({{"name", file.name},
                     {"url", file.url},
                     {"bytes", file.bytes},
                     {"exact_size", file.exact_size},
                     {"sha256_published", file.sha256.empty() ? Json() : Json(file.sha256)},
                     {"sha256_recorded", record ? Json(record->sha256) : Json()},
                     {"path", located ? Json(located->path.string()) : Json()}});
  }
  return {{"name", model.name},
          {"purpose", model.purpose},
          {"installed", store.installed(model)},
          {"needs", model.needs},
          {"licence",
           {{"id", model.licence.id},
            {"url", model.licence.url},
            {"note", model.licence.note},
            {"gated", model.licence.gated}}},
          {"files", files}};
}

void list_models(const CommandContext& context) {
  const ModelStore store = store_of(context);
  if (context.global.json) {
    Json document = {{"folder", store.options().folder.string()}, {"models", Json::array()}};
    for (const PublishedModel& model : published_models()) document["models"].push_back(model_json(store, model));
    print_json(document);
    return;
  }
  std::printf("%-19s %-10s %9s  %s\n", "model", "installed", "size", "what for, licence");
  for (const PublishedModel& model : published_models()) {
    std::string needs;
    for (const std::string& need : model.needs) needs += "; needs " + need;
    std::printf("%-19s %-10s %9s  %s%s\n%-41s %s\n", model.name.c_str(), state_of(store, model).c_str(),
                format_bytes(download_bytes(model)).c_str(), model.purpose.c_str(), needs.c_str(), "",
                licence_line(model.licence).c_str());
    for (const ModelFile& file : model.files) {
      const auto record = store.record(model, file);
      const std::string digest = !file.sha256.empty()
                                     ? "published " + file.sha256 + (file.sha256.size() < 64 ? "..." : "")
                                 : record ? "recorded " + record->sha256
                                          : "none published, recorded at first use";
      std::printf("%-41s %s\n%-41s sha256 %s\n", "", file.url.c_str(), "", digest.c_str());
    }
  }
  for (const ModelSet& set : model_sets()) {
    uint64_t bytes = 0;
    std::string names;
    for (const PublishedModel* model : models_of({set.name})) {
      bytes += download_bytes(*model);
      names += (names.empty() ? "" : ", ") + model->name;
    }
    std::printf("set %-15s %-10s %9s  %s: %s\n", set.name.c_str(), "", format_bytes(bytes).c_str(), set.purpose.c_str(),
                names.c_str());
  }
  const auto first = [](const std::vector<std::filesystem::path>& folders) {
    return folders.empty() ? "-" : folders.front().c_str();
  };
  std::printf("looked for, in this order: %s (HF_HUB_CACHE, HF_HOME), %s (ALIGNGS_MODELS), %s (TORCH_HOME)\n",
              first(store.options().huggingface), store.options().folder.c_str(), first(store.options().torch));
}

/// The licence is shown; going on without having said yes is not possible.
void require_acceptance(const PublishedModel& model, bool accepted) {
  std::fprintf(stderr, "%s: licence %s\n  %s\n", model.name.c_str(), licence_line(model.licence).c_str(),
               model.licence.url.c_str());
  if (!model.licence.question.empty()) std::fprintf(stderr, "  open question: %s\n", model.licence.question.c_str());
  if (accepted) return;
  if (isatty(STDIN_FILENO) && isatty(STDERR_FILENO)) {
    std::fputs("do you accept it? [y/N] ", stderr);
    std::string answer;
    std::getline(std::cin, answer);
    if (answer == "y" || answer == "Y" || answer == "yes") return;
    throw_usage("the licence of " + model.name + " was not accepted, so nothing was downloaded");
  }
  throw_usage("the licence of " + model.name + " must be accepted first",
              "read " + model.licence.url + ", then add --accept-licence");
}

/// Sizes, licences and expected times of what is to be fetched, before anything is.
void print_plan(const ModelStore& store, const std::vector<const PublishedModel*>& wanted, int threads) {
  ThreadPool pool(threads);
  nn::Compute compute(pool, {nn::fastest_precision(), true, true});
  const double rate = measure_network_rate(compute);
  uint64_t missing = 0;
  std::fprintf(stderr, "%-19s %9s  %-24s %s\n", "model", "size", "a photo on this machine", "licence");
  for (const PublishedModel* model : wanted) {
    const std::optional<double> seconds = network_seconds(model->name, 1, rate);
    const std::string time = seconds ? fmt::format("about {:.2g} s", *seconds) : "-";
    const bool here = store.installed(*model);
    if (!here) missing += download_bytes(*model);
    std::fprintf(stderr, "%-19s %9s  %-24s %s%s\n", model->name.c_str(), format_bytes(download_bytes(*model)).c_str(),
                 time.c_str(), licence_line(model->licence).c_str(), here ? "; installed" : "");
    if (!model->licence.question.empty())
      std::fprintf(stderr, "%-30s  open question: %s\n", "", model->licence.question.c_str());
  }
  std::fprintf(stderr, "to fetch: %s\n", format_bytes(missing).c_str());
}

struct DownloadArguments {
  std::vector<std::string> names;
  std::string mirror;
  bool accept = false;
};

void download_models(const CommandContext& context, const DownloadArguments& arguments) {
  const ModelStore store = store_of(context);
  ModelDownloadOptions options;
  options.mirror = arguments.mirror;
  options.progress = context.progress();
  if (const char* token = std::getenv("HF_TOKEN")) options.huggingface_token = token;
  const std::vector<const PublishedModel*> wanted = models_of(arguments.names);
  if (!context.global.quiet) print_plan(store, wanted, context.global.threads);
  Json document = Json::array();
  for (const PublishedModel* model : wanted) {
    bool missing = false;
    for (const ModelFile& file : model->files) missing = missing || !store.find(*model, file);
    if (missing && !store.options().offline) require_acceptance(*model, arguments.accept);
    download_model(store, *model, options);
    document.push_back(model_json(store, *model));
    if (context.global.json) continue;
    for (const ModelFile& file : model->files)
      std::printf("%s: %s%s\n", model->name.c_str(), store.find(*model, file)->path.c_str(),
                  missing ? "" : " (was there already)");
  }
  if (context.global.json) print_json(document);
}

void verify_models(const CommandContext& context, const std::vector<std::string>& names) {
  const ModelStore store = store_of(context);
  std::vector<const PublishedModel*> wanted;
  for (const PublishedModel& model : published_models()) {
    if (names.empty() && state_of(store, model) != "no") wanted.push_back(&model);
  }
  for (const std::string& name : names) wanted.push_back(&published_model(name));
  Json document = Json::array();
  const ModelFileState* bad = nullptr;
  std::vector<ModelFileState> states;
  for (const PublishedModel* model : wanted) {
    for (ModelFileState& state : verify_model(store, *model)) states.push_back(std::move(state));
  }
  for (const ModelFileState& state : states) {
    if (!state.good && !bad) bad = &state;
    document.push_back({{"model", state.model->name},
                        {"file", state.file->name},
                        {"path", state.path.string()},
                        {"good", state.good},
                        {"sha256", state.sha256},
                        {"compared_with", state.compared_with},
                        {"problem", state.problem}});
    if (context.global.json) continue;
    std::printf(
        "%-4s %s: %s\n", state.good ? "ok" : "!!", state.model->name.c_str(),
        state.good
            ? fmt::format("{}, sha256 {} (compared with: {})", state.path.string(), state.sha256, state.compared_with)
                  .c_str()
            : fmt::format("{}: {}", state.path.empty() ? state.file->name : state.path.string(), state.problem)
                  .c_str());
  }
  if (context.global.json)
    print_json(document);
  else if (states.empty())
    std::printf("no weights are on this machine; `aligngs models list` shows what there is\n");
  if (bad) {
    throw Error(
        {ErrorKind::kWeights,
         state_of(store, *bad->model) == "no" ? "the weights are missing" : "the weights differ from their digest",
         bad->path, bad->model->name,
         bad->path.empty() ? how_to_get(store, *bad->model)
                           : "remove the file, then `aligngs models download " + bad->model->name + "`"});
  }
}

void print_paths(const CommandContext& context, const std::string& name) {
  const std::vector<std::filesystem::path> paths = store_of(context).require(published_model(name));
  Json document = Json::array();
  for (const std::filesystem::path& path : paths) {
    document.push_back(path.string());
    if (!context.global.json) std::printf("%s\n", path.c_str());
  }
  if (context.global.json) print_json(document);
}

void import_files(const CommandContext& context, const std::string& name, const std::vector<std::string>& files) {
  const ModelStore store = store_of(context);
  const PublishedModel& model = published_model(name);
  log_info("{}: licence {}, {}", model.name, licence_line(model.licence), model.licence.url);
  Json document = Json::array();
  for (const std::string& file : files) {
    const std::filesystem::path path = import_model_file(store, model, file);
    document.push_back(path.string());
    if (!context.global.json) std::printf("%s: %s\n", model.name.c_str(), path.c_str());
    for (const ModelFile& part : model.files) {
      const auto used = store.find(model, part);
      if (used && store.own_path(model, part) == path && used->path != path)
        log_warning("{} is used instead, because the {} comes first", used->path.string(), name_of(used->place));
    }
  }
  if (context.global.json) print_json(document);
  if (!store.installed(model)) log_warning("{} is not complete yet: {}", model.name, how_to_get(store, model));
}

}  // namespace

void add_models_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("models", "Network weights: list, download, verify, path, import");
  command->group("Data");
  command->footer(help_footer({.reads = "the weight folders of this machine",
                               .writes = "the program's own weight folder (download, import)",
                               .example = "aligngs models list",
                               .advanced = "aligngs models download recommended lpips-vgg --accept-licence"}));
  command->require_subcommand(1);
  command->fallthrough();

  CLI::App* list = command->add_subcommand(
      "list", "List all weights: size, licence, source, digest, and whether they are installed");
  list->footer(help_footer({.reads = "the weight folders of this machine",
                            .writes = "nothing",
                            .example = "aligngs models list",
                            .advanced = "aligngs models list --json"}));
  list->callback([&context] { list_models(context); });

  CLI::App* download = command->add_subcommand("download", "Download weights; an interrupted download resumes");
  download->footer(help_footer(
      {.reads = "the publisher's site, or the mirror of --from",
       .writes = "the program's own weight folder",
       .example = "aligngs models download recommended",
       .advanced = "aligngs models download lpips-vgg --accept-licence --from https://mirror.example.org/weights"}));
  auto arguments = std::make_shared<DownloadArguments>();
  download->add_option("models", arguments->names, "light, recommended or paper, or names as in `aligngs models list`")
      ->required();
  download->add_flag("--accept-licence,--accept-license", arguments->accept, "accept the licences without a question");
  download->add_option("--from", arguments->mirror, "URL of a mirror that holds the files by their names")
      ->group("Source");
  download->callback([&context, arguments] { download_models(context, *arguments); });

  CLI::App* verify =
      command->add_subcommand("verify", "Read the weights again and compare their digests; status 4 if one differs");
  verify->footer(help_footer({.reads = "all weight files",
                              .writes = "nothing",
                              .example = "aligngs models verify",
                              .advanced = "aligngs models verify vggt-1b --json"}));
  auto verified = std::make_shared<std::vector<std::string>>();
  verify->add_option("models", *verified, "names (default: all installed weights)");
  verify->callback([&context, verified] { verify_models(context, *verified); });

  CLI::App* path = command->add_subcommand("path", "Print the paths of a model's files; status 4 if they are missing");
  path->footer(help_footer({.reads = "the weight folders of this machine",
                            .writes = "nothing",
                            .example = "aligngs models path vggt-1b",
                            .advanced = "aligngs models path ade20k-m2f --json"}));
  auto asked = std::make_shared<std::string>();
  path->add_option("model", *asked, "name as in `aligngs models list`")->required();
  path->callback([&context, asked] { print_paths(context, *asked); });

  CLI::App* import = command->add_subcommand("import", "Copy a weight file to the folder of aligngs");
  import->footer(help_footer({.reads = "a weight file",
                              .writes = "the program's own weight folder",
                              .example = "aligngs models import vggt-1b Downloads/model.safetensors",
                              .advanced = "aligngs models import vggt-1b Downloads/model.safetensors --json"}));
  auto imported = std::make_shared<std::string>();
  auto files = std::make_shared<std::vector<std::string>>();
  import->add_option("model", *imported, "name as in `aligngs models list`")->required();
  import->add_option("files", *files, "safetensors, .pth or .pt")->required();
  import->callback([&context, imported, files] { import_files(context, *imported, *files);
});
}  // namespace aligngs

}  // namespace aligngs
