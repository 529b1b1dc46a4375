#include "batch/shard.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "core/error.h"

namespace aligngs {
namespace {

/// A whole number and nothing else, from 0.
std::optional<int> whole_number(std::string_view text) {
  int value = 0;
  const auto [rest, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || rest != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

/// A cluster's names for the number of a task, the first number, and the count.
struct ArrayVariables {
  const char* index;
  const char* first;  ///< null: it is 0
  const char* step;   ///< null: 1
  const char* count;  ///< null: it is not told
};
constexpr ArrayVariables kClusters[] = {
    {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_STEP", "SLURM_ARRAY_TASK_COUNT"},
    {"JOB_COMPLETION_INDEX", nullptr, nullptr, nullptr},
    {"AWS_BATCH_JOB_ARRAY_INDEX", nullptr, nullptr, "AWS_BATCH_JOB_ARRAY_SIZE"}};

}  // namespace

Shard parse_shard(const std::string& text) {
  const size_t slash = text.find('/');
  const auto index = whole_number(std::string_view(text).substr(0, slash));
  const auto count = slash == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count) {
    throw_usage("--shard must be i/N with i from 1 to N, got \"" + text + "\"", "for example --shard 2/8");
  }
  return {*index, *count, "--shard"};
}

Shard shard_from_environment(const std::function<const char*(const char*)>& get, int count) {
  for (const ArrayVariables& cluster : kClusters) {
    const char* const text = get(cluster.index);
    if (!text) continue;
    const auto number_of = [&](const char* name) -> std::optional<int> {
      const char* const value = name ? get(name) : nullptr;
      if (!value) return std::nullopt;
      const auto number = whole_number(value);
      if (!number)
        throw_usage(std::string(name) + " is no whole number: \"" + value + "\"", "give the part by hand: --shard i/N");
      return number;
    };
    const int task = *number_of(cluster.index);
    // With a count by hand the numbers are 0 to N-1, so that an array may hold some of them: sbatch --array=3,7.
    const int first = count > 0 ? 0 : number_of(cluster.first).value_or(0);
    const int step = count > 0 ? 1 : std::max(1, number_of(cluster.step).value_or(1));
    const int tasks = count > 0 ? count : number_of(cluster.count).value_or(0);
    if (tasks == 0) {
      throw_usage(std::string(cluster.index) + " is set, but not how many tasks there are",
                  "give it with --shards N, or the part with --shard i/N");
    }
    if (task < first || (task - first) % step != 0 || (task - first) / step >= tasks) {
      throw_usage(std::string(cluster.index) + " is " + text + ", which is none of " + std::to_string(tasks) + " tasks",
                  "number the tasks 0 to N-1, and give N with --shards");
    }
    return {(task - first) / step + 1, tasks, cluster.index};
  }
  return {};
}

std::vector<RoomEntry> rooms_of_shard(const std::vector<RoomEntry>& rooms, const Shard& shard) {
  std::vector<RoomEntry> part;
  for (size_t i = static_cast<size_t>(shard.index - 1); i < rooms.size(); i += static_cast<size_t>(shard.count))
    part.push_back(rooms[i]);
  return part;
}

}  // namespace aligngs
