// The one table of all settings: name, field, range, value, documentation; presets.cpp has what the presets change.
// Command line, config.toml, --print-config, error messages and the manual are all made from it.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "train/config.h"

namespace aligngs {

using ConfigValue = std::variant<double, int64_t, bool, std::string>;

/// A field that is one of several words (config_choices.h). The functions take `field`.
struct ChoiceField {
  void* field;
  std::string_view (*word)(const void* field);
  bool (*set)(void* field, std::string_view word);  ///< false: there is no such word
  std::string (*words)();                           ///< all of them: "a|b|c"
};
using ConfigField = std::variant<double*, int64_t*, bool*, std::string*, ChoiceField>;

struct ConfigKey {
  std::string_view name;                           ///< dotted, e.g. "loss.l1"
  ConfigField (*field)(TrainConfig&);              ///< where it lives
  double low, high;                                ///< inclusive range of numbers
  ConfigValue standard;                            ///< of preset `default`
  std::string_view doc;                            ///< one line
  std::array<ConfigValue, kPresets> presets = {};  ///< indexed by Preset; made from `standard` and presets.cpp
};

/// In the order in which they are written to config.toml.
const std::vector<ConfigKey>& config_keys();
/// nullptr when there is none.
const ConfigKey* find_config_key(std::string_view name);
/// The nearest key names, best first, at most three; empty when nothing is near.
std::vector<std::string> suggest_config_keys(std::string_view name);

/// Sets one key from text ("0.8", "true", "median"). Error{kUsage} naming key, range and, for an unknown
/// key, the nearest ones.
void set_config(TrainConfig& config, std::string_view name, const std::string& text);
void set_config(TrainConfig& config, std::string_view name, const ConfigValue& value);
ConfigValue get_config(const TrainConfig& config, const ConfigKey& key);
/// The words of a setting that is one of several: "a|b|c"; empty for the others.
std::string choices_of(const ConfigKey& key);
/// As written in TOML: shortest text that reads back to the same value; strings in quotes.
std::string config_value_text(const ConfigValue& value);

namespace config_table {  // the parts of the table, one file each

template <class Choice>
ChoiceField choice_field(Choice& choice) {
  return {&choice, [](const void* field) { return word_of(*static_cast<const Choice*>(field)); },
          [](void* field, std::string_view word) {
            const std::optional<Choice> named = choice_named<Choice>(word);
            if (named) *static_cast<Choice*>(field) = *named;
            return named.has_value();
          },
          [] { return joined_words<Choice>("|", "|"); }};
}

template <auto Group, auto Member>
ConfigField field(TrainConfig& config) {
  auto& member = config.*Group.*Member;
  if constexpr (std::is_enum_v<std::remove_reference_t<decltype(member)>>)
    return choice_field(member);
  else
    return &member;
}

inline ConfigValue value(double v) { return v; }
inline ConfigValue value(int v) { return static_cast<int64_t>(v); }
inline ConfigValue value(bool v) { return v; }
inline ConfigValue value(const char* v) { return std::string(v); }
template <class Choice>
requires std::is_enum_v<Choice> ConfigValue value(Choice v) { return std::string(word_of(v)); }

/// A preset as the values that differ from those of another preset.
struct PresetChanges {
  Preset basis;
  std::vector<std::pair<std::string_view, ConfigValue>> values;  ///< by key
};
PresetChanges preview_changes();
PresetChanges paper_changes();
PresetChanges high_changes();
PresetChanges pgsr_changes();

inline constexpr double kAny = std::numeric_limits<double>::infinity();
inline constexpr double kIterationsMax = 1e7;  ///< far beyond any use; guards sums against overflow

std::vector<ConfigKey> data_init_train_keys();
std::vector<ConfigKey> loss_semantic_keys();
std::vector<ConfigKey> densify_optimizer_keys();
std::vector<ConfigKey> checkpoint_mesh_keys();

}  // namespace config_table
}  // namespace aligngs
