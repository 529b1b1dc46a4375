#include "batch/memory_forecast.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "batch/option_words.h"
#include "core/error.h"
#include "pipeline/room_memory.h"
#include "pipeline/run_plan.h"
#include "train/run_folder.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// Defaults of `demo` without --size and --views (synth/synth_scene.h).
constexpr uint64_t kSyntheticPixels = 320 * 240, kSyntheticViews = 28;

uint64_t number_or(const std::string& text, uint64_t otherwise) {
  uint64_t value = 0;
  const auto [rest, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failed == std::errc() && rest == text.data() + text.size() ? value : otherwise;
}

uint64_t synthetic_pixels(const RoomEntry& room) {
  unsigned width = 0, height = 0;
  const std::string size = option_value(room.options, "--size");
  const uint64_t pixels =
      std::sscanf(size.c_str(), "%5ux%5u", &width, &height) == 2 ? uint64_t(width) * height : kSyntheticPixels;
  return pixels * number_or(option_value(room.options, "--views"), kSyntheticViews);
}

/// The last value of an option as its words have it, else what it is without it.
std::string value_or(const RoomEntry& room, const char* name, const char* otherwise) {
  return has_option(room.options, name) ? option_value(room.options, name) : otherwise;
}

/// Paths of options are relative to the list.
fs::path path_or_none(const Batch& batch, const RoomEntry& room, const char* name) {
  const std::string given = value_or(room, name, "");
  return given.empty() ? fs::path() : batch.base() / given;
}

/// The request that the options of a room make of its run, as far as its memory depends on it.
RunRequest request_of(const BatchFolder& folder, const Batch& batch, const RoomEntry& room) {
  RunRequest request;
  request.source = batch.source_of(room);
  request.train.run = folder.run(room.name);
  request.train.resume = true;  // which begins a run where there is none
  if (!RunFolder(request.train.run).has_run()) {
    // Settings of a run that goes on are its own.
    request.train.config.preset = value_or(room, "--preset", "");
    request.train.config.config_file = path_or_none(batch, room, "--config");
  }
  request.cameras.model = value_or(room, "--poses-model", "");
  request.cameras.cameras = path_or_none(batch, room, "--cameras").string();
  request.photos.max_side = static_cast<int>(
      number_or(option_value(room.options, "--max-size"), static_cast<uint64_t>(request.photos.max_side)));
  return request;
}

/// Its choices by name. Error{kUsage} for a word that is none.
void add_choices(const RoomEntry& room, RunRequest& request) {
  request.cameras.method = poses_method(value_or(room, "--method", "auto"));
  request.priors.depth = depth_choice(value_or(room, "--depth", "auto"));
  request.priors.semantics = semantic_choice(value_or(room, "--semantics", "auto"));
}

RunPlan plan_of(const RunRequest& request, const RoomEntry& room, const ModelStore& store) {
  if (!room.synthetic()) return plan_run(request, store);
  return plan_demo(request.train, "room", synthetic_pixels(room));
}

/// Networks that nobody knows here.
bool has_unknown_network(const RunPlan& plan, const RunRequest& request) {
  if (plan.from_photos() && request.priors.semantics.automatic() && !plan.has(RunStep::kClasses)) return true;
  return std::any_of(plan.steps.begin(), plan.steps.end(), [](const PlannedStep& step) {
    return step.network && step.outlook != Outlook::kLeftOut && !step.memory_bytes;
  });
}

}  // namespace

uint64_t predicted_room_bytes(const BatchFolder& folder, const Batch& batch, const RoomEntry& room) {
  if (const double gigabytes = std::strtod(option_value(room.options, "--memory").c_str(), nullptr); gigabytes > 0) {
    return static_cast<uint64_t>(gigabytes * 1e9);
  }
  RunRequest request = request_of(folder, batch, room);
  const ModelStore store(ModelStoreOptions::from_environment(true));
  uint64_t bytes = 0;
  bool unknown_network = false;
  try {
    add_choices(room, request);
    const RunPlan plan = plan_of(request, room, store);
    bytes = plan.memory_bytes();
    unknown_network = has_unknown_network(plan, request);
  } catch (const Error& error) {
    // The room will tell what is wrong with it. Weights or programs may be where it is worked on.
    unknown_network = error.kind() == ErrorKind::kWeights;
  }
  if (bytes == 0) bytes = expected_peak_bytes(earlier_run(request.train.run));
  if (bytes == 0) bytes = estimated_training_bytes(pixels_of(sizes_of_photos(request.source, request.photos.max_side)));
  return unknown_network ? std::max(bytes, kLargestNetworkBytes) : bytes;
}

uint64_t memory_share(uint64_t predicted, uint64_t budget, int jobs) {
  return std::min(budget, std::max(predicted, budget / static_cast<uint64_t>(std::max(1, jobs))));
}

}  // namespace aligngs
