#include "train/config_file.h"

#include <fmt/format.h>

#include "core/error.h"
#include "io/toml_file.h"
#include "train/config_keys.h"
#include "train/loss_schedule.h"

namespace aligngs {
namespace {

/// The same error, with the file and line of the wrong setting.
[[noreturn]] void rethrow_with_place(const Error& error, const std::filesystem::path& path, int line) {
  Error::Details details = error.details();
  details.path = path;
  details.message += fmt::format(" (line {})", line);
  throw Error(details);
}

ConfigValue value_of(const TomlValue& value, const std::string& key) {
  if (const auto* v = std::get_if<bool>(&value)) return *v;
  if (const auto* v = std::get_if<int64_t>(&value)) return *v;
  if (const auto* v = std::get_if<double>(&value)) return *v;
  if (const auto* v = std::get_if<std::string>(&value)) return *v;
  throw Error({ErrorKind::kUsage, "a number, a text, true or false is expected", {}, key, "see --print-config"});
}

void require(bool good, const char* field, const char* message, const char* remedy) {
  if (!good) throw Error({ErrorKind::kUsage, message, {}, field, remedy});
}

}  // namespace

void apply_config_file(const std::filesystem::path& path, TrainConfig& config) {
  for (const auto& [key, entry] : read_toml(path)) {
    try {
      set_config(config, key, value_of(entry.value, key));
    } catch (const Error& error) {
      rethrow_with_place(error, path, entry.line);
    }
  }
}

void apply_config_set(const std::string& assignment, TrainConfig& config) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw_usage(fmt::format("--set {} has no value", assignment), "write --set key=value");
  }
  const std::string key = assignment.substr(0, equals);
  if (key == "train.preset") throw_usage("train.preset only tells what a configuration began as", "use --preset");
  set_config(config, key, assignment.substr(equals + 1));
}

void check_config(const TrainConfig& config) {
  const DensifyConfig& d = config.densify;
  require(!d.enabled || d.start <= d.stop, "densify.start", "density control would end before it starts",
          "make densify.stop at least densify.start, or set densify.enabled=false");
  require(config.semantic.coupling_start <= config.semantic.coupling_stop, "semantic.coupling_start",
          "the coupling would end before it starts", "make semantic.coupling_stop at least semantic.coupling_start");
  const double share = config.semantic.pixel_share;
  require(share == 1 || share == 0.5 || share == 0.25, "semantic.pixel_share", "of four squares 4, 2 or 1 are taken",
          "use 1, 0.5 or 0.25");
  const OptimizerConfig& o = config.optimizer;
  const char* remedy = "make it positive; a start value of 0 turns the term off";
  const char* to_zero = "a log-linear schedule cannot reach zero";
  require(o.position == 0 || o.position_end > 0, "optimizer.position_end", to_zero, remedy);
  require(o.aspect_max == 0 || o.aspect_max >= 1, "optimizer.aspect_max",
          "the largest scale cannot be below the middle one", "use 0 (off) or at least 1");
  const LossConfig& l = config.loss;
  for (const ScheduledLoss& row : scheduled_losses()) {
    const bool reached = row.end == nullptr || row.start(config) == 0 || row.end(config) > 0;
    require(reached, (std::string(row.key) + "_end").c_str(), to_zero, remedy);
  }
  require(l.l1 + l.ssim > 0, "loss.l1", "there is no photometric loss", "make loss.l1 or loss.ssim positive");
}

TrainConfig resolve_config(const ConfigSources& sources) {
  std::string preset = sources.preset;
  if (preset.empty() && !sources.config_file.empty()) {
    const TomlTable table = read_toml(sources.config_file);
    const auto entry = table.find("train.preset");
    if (entry != table.end() && std::holds_alternative<std::string>(entry->second.value)) {
      preset = std::get<std::string>(entry->second.value);
    }
  }
  TrainConfig config = make_preset(parse_preset(preset.empty() ? std::string(word_of(Preset::kDefault)) : preset));
  if (!sources.config_file.empty()) apply_config_file(sources.config_file, config);
  for (const std::string& assignment : sources.sets) apply_config_set(assignment, config);
  if (sources.iterations) set_config(config, "train.iterations", ConfigValue(*sources.iterations));
  if (sources.seed) set_config(config, "train.seed", ConfigValue(*sources.seed));
  check_config(config);
  return config;
}

std::string config_to_toml(const TrainConfig& config) {
  std::string text, group;
  for (const ConfigKey& key : config_keys()) {
    const std::string_view this_group = key.name.substr(0, key.name.find('.'));
    if (this_group != group) {
      group = this_group;
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", group);
    }
    const std::string choices = choices_of(key);
    text += fmt::format("# {}{}\n{} = {}\n", key.doc, choices.empty() ? "" : " (" + choices + ")",
                        key.name.substr(group.size() + 1), config_value_text(get_config(config, key)));
  }
  return text;
}

std::vector<std::string> config_differences(const TrainConfig& a, const TrainConfig& b) {
  std::vector<std::string> differences;
  for (const ConfigKey& key : config_keys()) {
    const ConfigValue x = get_config(a, key), y = get_config(b, key);
    if (x != y)
      differences.push_back(fmt::format("{}: {} -> {}", key.name, config_value_text(x), config_value_text(y)));
  }
  return differences;
}

std::string config_reference_markdown() {
  std::string text = "| key | preview | default | paper | high | pgsr | meaning |\n|---|---|---|---|---|---|---|\n";
  for (const ConfigKey& key : config_keys()) {
    text += fmt::format("| `{}` |", key.name);
    for (const ConfigValue& v : key.presets) text += fmt::format(" {} |", config_value_text(v));
    text += fmt::format(" {} |\n", key.doc);
  }
  return text;
}

}  // namespace aligngs
