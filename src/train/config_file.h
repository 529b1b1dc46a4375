// Settings from presets, files and --set, and their written form.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "train/config.h"

namespace aligngs {

/// Sources of the settings of a run; later ones win: preset, config file, sets, iterations, seed.
struct ConfigSources {
  std::string preset;                 ///< empty: the file's train.preset, else "default"
  std::filesystem::path config_file;  ///< empty: none
  std::vector<std::string> sets;      ///< "key=value"
  std::optional<int64_t> iterations;  ///< -n
  std::optional<int64_t> seed;        ///< --seed
  bool any() const {
    return !preset.empty() || !config_file.empty() || !sets.empty() || iterations.has_value() || seed.has_value();
  }
};

/// Error{kUsage} naming the key (and the file) for unknown keys, wrong types, values out of range and
/// contradictions between settings.
TrainConfig resolve_config(const ConfigSources& sources);

/// Applies the keys of a TOML file to `config`. Values are in groups ([loss] l1 = 0.8) or dotted.
void apply_config_file(const std::filesystem::path& path, TrainConfig& config);
/// Applies one "key=value".
void apply_config_set(const std::string& assignment, TrainConfig& config);
/// Conditions between settings: start before stop, and so on. Error{kUsage}.
void check_config(const TrainConfig& config);

/// The whole configuration as TOML, grouped, every key with its documentation as a comment.
std::string config_to_toml(const TrainConfig& config);
/// Keys whose values differ, as "key: a -> b".
std::vector<std::string> config_differences(const TrainConfig& a, const TrainConfig& b);
/// The reference of all keys as a Markdown table with the value per preset.
std::string config_reference_markdown();

}  // namespace aligngs
