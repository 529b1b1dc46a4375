// `aligngs doctor`: what this machine has, what aligngs will use of it, and what is missing.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>
#include <CLI/App.hpp>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/help_text.h"
#include "cli/photo_options.h"
#include "cli/print_json.h"
#include "core/memory_budget.h"
#include "core/version.h"
#include "device/cuda_device.h"
#include "nn/cpu/matrix_backend.h"
#include "priors/depth_teacher.h"
#include "priors/teacher_list.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

struct Check {
  std::string name;
  bool ok = true;
  std::string value, remedy;
};

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown processor";
}

Check check_instructions() {
#if defined(ALIGNGS_SCALAR_ONLY)
  return {"instructions", true, "scalar only (built with ALIGNGS_SCALAR_ONLY)",
          "configure without ALIGNGS_SCALAR_ONLY for speed"};
#elif defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw"))
    return {"instructions", true, "AVX-512", ""};
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return {"instructions", true, "AVX2", ""};
  return {"instructions", true, "SSE4.2", "training is about four times slower without AVX2"};
#else
  return {"instructions", true, "portable", ""};
#endif
}

Check check_memory() {
  constexpr uint64_t kComfortable = uint64_t(4) << 30;  // a 640x480 room with 150 classes stays below 3 GB
  const uint64_t available = available_memory_bytes();
  return {"memory", available >= kComfortable, format_bytes(available) + " available",
          available >= kComfortable ? "" : "close other programs, or use --preset preview"};
}

Check check_writable() {
  const bool writable = access(".", W_OK) == 0;
  std::error_code error;
  const auto space = std::filesystem::space(".", error);
  constexpr uint64_t kRunSize = uint64_t(1) << 30;  // a run with checkpoints stays below 1 GB
  const bool enough = !error && space.available >= kRunSize;
  return {"current folder", writable && enough,
          fmt::format("{}, {} free", writable ? "writable" : "not writable",
                      error ? "unknown" : format_bytes(space.available)),
          writable && enough ? "" : "change to a folder that you may write to, with 1 GB free"};
}

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  if (!path) return false;
  for (const std::string& folder : CLI::detail::split(path, ':')) {
    if (access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// Number format of networks, and its speed.
Check check_networks() {
  ThreadPool pool(1);
  const nn::Precision precision = nn::fastest_precision();
  const nn::Compute compute(pool, {precision, true, true});
  const std::string what =
      fmt::format("{}, {}{}", word_of(precision), compute.matrices()->name(), compute.amx() ? ", matrix unit" : "");
  bool slow = false;
#ifdef __x86_64__
  slow = precision != nn::Precision::kBfloat16 && __builtin_cpu_supports("avx512bf16");
#endif
  return {"networks", true, what,
          slow ? "twice as slow as with oneDNN: apt-get install libdnnl-dev, then build again" : ""};
}

/// Place of each model's weights, and its missing files.
std::vector<Check> check_weights(const ModelStore& store) {
  std::vector<Check> found;
  size_t whole = 0;
  for (const PublishedModel& model : published_models()) {
    std::string places, missing;
    for (const ModelFile& file : model.files) {
      const auto located = store.find(model, file);
      std::error_code unknown;
      if (located) {
        places += fmt::format("{}{} ({})", places.empty() ? "" : ", ", located->path.string(),
                              format_bytes(fs::file_size(located->path, unknown)));
      } else {
        missing += " " + file.name;
      }
    }
    if (places.empty()) continue;
    for (const std::string& need : model.needs) {
      if (!store.installed(published_model(need))) missing += " " + need;
    }
    whole += missing.empty();
    found.push_back({"weights", true, model.name + ": " + places,
                     missing.empty()
                         ? ""
                         : fmt::format("of no use yet without{}: aligngs models download {}", missing, model.name)});
  }
  std::string looked;
  for (const fs::path& folder : store.options().huggingface) looked += folder.string() + ", ";
  looked += store.options().folder.string();
  for (const fs::path& folder : store.options().torch) looked += ", " + folder.string();
  const std::string summary =
      fmt::format("{} of {} models are complete; looked in {}", whole, published_models().size(), looked);
  found.insert(found.begin(), {"network weights", true, summary,
                               whole > 0 ? ""
                                         : "without them: cameras from COLMAP, no class labels, no lpips; `aligngs "
                                           "models list` shows what there is"});
  return found;
}

/// A row of doctor's lists: place in the order, name, why it is there, and whether it is installed.
Check place_of(const char* list, size_t place, const std::string& name, const std::string& reason,
               const ModelStore& store, const char* model) {
  const bool here = store.installed(published_model(model));
  return {list, true, fmt::format("  {}. {}: {}{}", place, name, reason, here ? "; installed" : ""), ""};
}

Check no_network(const char* list, const char* option) {
  return {list, true, fmt::format("no network is installed for {} auto", option),
          "aligngs models download recommended, or light"};
}

void add_camera_choices(const ModelStore& store, std::vector<Check>& found) {
  const Teacher* const best = installed_camera_teacher(store);
  found.push_back(best ? Check{"cameras", true, fmt::format("auto takes {}: {}", best->model, best->cameras.reason), ""}
                       : no_network("cameras", "--method"));
  size_t place = 0;
  for (const Teacher* network : camera_teachers())
    found.push_back(place_of("cameras", ++place, network->model, network->cameras.reason, store, network->model));
}

void add_depth_choices(const ModelStore& store, std::vector<Check>& found) {
  const PublishedModel* const best = installed_depth_model(store);
  found.push_back(best ? Check{"depth", true,
                               fmt::format("auto takes {}: {}", best->name, find_teacher(best->name)->depth->gives), ""}
                       : no_network("depth", "--depth"));
  size_t place = 0;
  for (const std::string& word : depth_choices()) {
    const Teacher& network = depth_teacher(word);
    found.push_back(place_of("depth", ++place, word, network.depth->gives, store, network.model));
  }
}

void add_class_choices(const ModelStore& store, std::vector<Check>& found) {
  const PublishedModel* const best = installed_semantic_model(store);
  found.push_back(best ? Check{"classes", true, "auto takes " + best->name, ""} : no_network("classes", "--semantics"));
  found.push_back(
      {"classes", true, fmt::format("  by accuracy on ADE20K: {}", fmt::join(semantic_choices(), ", ")), ""});
}

/// The order in which `run`, `poses` and `priors` look for networks, and those that they take now.
std::vector<Check> check_choices(const ModelStore& store) {
  std::vector<Check> found;
  add_camera_choices(store, found);
  add_depth_choices(store, found);
  add_class_choices(store, found);
  return found;
}

/// Device of `--device auto`.
Check check_device() {
  const cuda::CudaDevices found = cuda::list_cuda_devices();
  if (found.devices.empty()) return {"device", true, "cpu: " + found.reason, ""};
  std::string value;
  for (const cuda::CudaDevice& d : found.devices) {
    value += fmt::format("cuda:{} {}, compute capability {}.{}, {}; ", d.index, d.name, d.major, d.minor,
                         format_bytes(d.memory_bytes));
  }
  return {"device", true, value + cuda::cuda_build(), ""};
}

std::vector<Check> run_checks(const ModelStore& store) {
  std::vector<Check> checks;
  checks.push_back({"processor", true,
                    fmt::format("{}, {} hardware threads", cpu_model(), std::thread::hardware_concurrency()), ""});
  checks.push_back(check_instructions());
  checks.push_back(check_memory());
  checks.push_back(check_writable());
  checks.push_back(check_device());
  checks.push_back(check_networks());
  for (Check& check : check_weights(store)) checks.push_back(std::move(check));
  for (Check& check : check_choices(store)) checks.push_back(std::move(check));
  const bool colmap = on_path("colmap");
  checks.push_back({"colmap program", true, colmap ? "found" : "not found",
                    colmap ? ""
                           : "a way to find cameras for your own photos without a network (VGGT, Depth Anything 3): "
                             "apt-get install colmap"});
  return checks;
}

}  // namespace

void add_doctor_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("doctor", "Check this machine and list missing parts");
  command->group("Look");
  command->footer(help_footer({.reads = "the machine: processor, memory, programs, weights, devices",
                               .writes = "nothing",
                               .example = "aligngs doctor",
                               .advanced = "aligngs doctor --json"}));
  command->callback([&context] {
    const std::vector<Check> checks = run_checks(model_store(context));
    bool all = true;
    nlohmann::json document = {{"version", version()}, {"checks", nlohmann::json::array()}};
    for (const Check& check : checks) {
      all = all && check.ok;
      document["checks"].push_back(
          {{"name", check.name}, {"ok", check.ok}, {"value", check.value}, {"remedy", check.remedy}});
      if (context.global.json) continue;
      std::printf("%-4s %-16s %s\n", check.ok ? "ok" : "!!", check.name.c_str(), check.value.c_str());
      if (!check.remedy.empty()) std::printf("     %-16s %s\n", "", check.remedy.c_str());
    }
    document["ok"] = all;
    if (context.global.json)
      print_json(document);
    else
      std::printf("%s\n", all ? "ready: try `aligngs demo`" : "see the lines marked !!");
  });
}

}  // namespace aligngs
