#include "train/config_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/edit_distance.h"
#include "core/error.h"

namespace aligngs {
namespace {

void add_preset(Preset preset, const config_table::PresetChanges& changes, std::vector<ConfigKey>& keys) {
  const auto value_of = [](ConfigKey& key, Preset p) -> ConfigValue& { return key.presets[static_cast<size_t>(p)]; };
  for (ConfigKey& key : keys) value_of(key, preset) = value_of(key, changes.basis);
  for (const auto& [name, value] : changes.values) {
    const auto key =
        std::find_if(keys.begin(), keys.end(), [name = name](const ConfigKey& k) { return k.name == name; });
    if (key == keys.end() || value_of(*key, preset) == value) {
      throw Error({ErrorKind::kFailed,
                   fmt::format("preset '{}' changes nothing by '{}'", word_of(preset), name),
                   {},
                   std::string(name),
                   {}});
    }
    value_of(*key, preset) = value;
  }
}

std::vector<ConfigKey> build_table() {
  using namespace config_table;
  std::vector<ConfigKey> keys;
  for (auto part : {data_init_train_keys, loss_semantic_keys, densify_optimizer_keys, checkpoint_mesh_keys}) {
    const std::vector<ConfigKey> rows = part();
    keys.insert(keys.end(), rows.begin(), rows.end());
  }
  for (ConfigKey& key : keys) key.presets[static_cast<size_t>(Preset::kDefault)] = key.standard;
  // A basis comes before what builds on it.
  add_preset(Preset::kPreview, preview_changes(), keys);
  add_preset(Preset::kPaper, paper_changes(), keys);
  add_preset(Preset::kHigh, high_changes(), keys);
  add_preset(Preset::kPgsr, pgsr_changes(), keys);
  return keys;
}

[[noreturn]] void fail(std::string_view name, const std::string& message, const std::string& remedy) {
  throw Error({ErrorKind::kUsage, message, {}, std::string(name), remedy});
}

std::string range_text(const ConfigKey& key) {
  if (key.high == config_table::kAny) return fmt::format("at least {}", key.low);
  return fmt::format("{} to {}", key.low, key.high);
}

void check_number(const ConfigKey& key, double v) {
  if (std::isfinite(v) && v >= key.low && v <= key.high) return;
  fail(key.name, fmt::format("{} is out of range", v), fmt::format("use {}: {}", range_text(key), key.doc));
}

template <class T>
bool parse_whole(const std::string& text, T& out) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), out);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() && !text.empty();
}

ConfigValue parse_value(const ConfigKey& key, const std::string& text) {
  TrainConfig scratch;
  const ConfigField field = key.field(scratch);
  if (std::holds_alternative<double*>(field)) {
    double v = 0;
    if (parse_whole(text, v)) return v;
    fail(key.name, fmt::format("'{}' is no number", text), fmt::format("use a number, {}", range_text(key)));
  }
  if (std::holds_alternative<int64_t*>(field)) {
    int64_t v = 0;
    if (parse_whole(text, v)) return v;
    fail(key.name, fmt::format("'{}' is no whole number", text),
         fmt::format("use a whole number, {}", range_text(key)));
  }
  if (std::holds_alternative<bool*>(field)) {
    if (text == "true") return true;
    if (text == "false") return false;
    fail(key.name, fmt::format("'{}' is neither true nor false", text), "use true or false");
  }
  return text;
}

const ConfigKey& require_key(std::string_view name) {
  if (const ConfigKey* key = find_config_key(name)) return *key;
  std::string remedy;
  for (const std::string& s : suggest_config_keys(name)) remedy += (remedy.empty() ? "did you mean " : ", ") + s;
  remedy += remedy.empty() ? "'aligngs train --print-config' lists every key"
                           : "? 'aligngs train --print-config' lists every key";
  fail(name, fmt::format("unknown setting '{}'", name), remedy);
}

}  // namespace

const std::vector<ConfigKey>& config_keys() {
  static const std::vector<ConfigKey> keys = build_table();
  return keys;
}

const ConfigKey* find_config_key(std::string_view name) {
  for (const ConfigKey& key : config_keys()) {
    if (key.name == name) return &key;
  }
  return nullptr;
}

std::vector<std::string> suggest_config_keys(std::string_view name) {
  std::vector<std::pair<size_t, std::string>> near;
  const auto last_part = [](std::string_view text) { return text.substr(text.find('.') + 1); };
  for (const ConfigKey& key : config_keys()) {
    // The group is often left out or another one: "iterations" and "loss.iterations" should find "train.iterations".
    const std::string_view last = last_part(key.name);
    const size_t distance =
        last == last_part(name) ? 0 : std::min(edit_distance(name, key.name), edit_distance(name, last));
    if (distance <= std::max<size_t>(2, name.size() / 4)) near.emplace_back(distance, key.name);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (size_t i = 0; i < std::min<size_t>(3, near.size()); ++i) names.push_back(near[i].second);
  return names;
}

void set_config(TrainConfig& config, std::string_view name, const std::string& text) {
  const ConfigKey& key = require_key(name);
  set_config(config, name, parse_value(key, text));
}

void set_config(TrainConfig& config, std::string_view name, const ConfigValue& value) {
  const ConfigKey& key = require_key(name);
  const ConfigField field = key.field(config);
  if (double* const* f = std::get_if<double*>(&field)) {
    // A whole number is a fine value of a real setting: "loss.l1 = 1".
    const int64_t* whole = std::get_if<int64_t>(&value);
    const double* real = std::get_if<double>(&value);
    if (!whole && !real) fail(name, "a number is expected", fmt::format("use a number, {}", range_text(key)));
    const double v = real ? *real : static_cast<double>(*whole);
    check_number(key, v);
    **f = v;
  } else if (int64_t* const* fi = std::get_if<int64_t*>(&field)) {
    const int64_t* v = std::get_if<int64_t>(&value);
    if (!v) fail(name, "a whole number is expected", fmt::format("use a whole number, {}", range_text(key)));
    check_number(key, static_cast<double>(*v));
    **fi = *v;
  } else if (bool* const* fb = std::get_if<bool*>(&field)) {
    const bool* v = std::get_if<bool>(&value);
    if (!v) fail(name, "true or false is expected", "use true or false");
    **fb = *v;
  } else {
    const std::string* v = std::get_if<std::string>(&value);
    const std::string words = choices_of(key);
    if (!v) fail(name, "a text is expected", words.empty() ? "write it in quotes" : "use one of " + words);
    if (const ChoiceField* choice = std::get_if<ChoiceField>(&field)) {
      if (!choice->set(choice->field, *v)) fail(name, fmt::format("'{}' is no choice", *v), "use one of " + words);
      return;
    }
    *std::get<std::string*>(field) = *v;
  }
}

ConfigValue get_config(const TrainConfig& config, const ConfigKey& key) {
  TrainConfig copy = config;
  const ConfigField field = key.field(copy);
  if (const ChoiceField* choice = std::get_if<ChoiceField>(&field)) return std::string(choice->word(choice->field));
  if (double* const* f = std::get_if<double*>(&field)) return **f;
  if (int64_t* const* f = std::get_if<int64_t*>(&field)) return **f;
  if (bool* const* f = std::get_if<bool*>(&field)) return **f;
  return *std::get<std::string*>(field);
}

std::string choices_of(const ConfigKey& key) {
  TrainConfig scratch;
  const ConfigField field = key.field(scratch);
  const ChoiceField* choice = std::get_if<ChoiceField>(&field);
  return choice ? choice->words() : std::string();
}

std::string config_value_text(const ConfigValue& value) {
  if (const bool* b = std::get_if<bool>(&value)) return *b ? "true" : "false";
  if (const std::string* s = std::get_if<std::string>(&value)) return "\"" + *s + "\"";
  if (const int64_t* i = std::get_if<int64_t>(&value)) return std::to_string(*i);
  std::string text = fmt::format("{}", std::get<double>(value));     // shortest that reads back the same
  if (text.find_first_of(".en") == std::string::npos) text += ".0";  // TOML tells reals from whole numbers
  return text;
}

Preset parse_preset(const std::string& name) {
  if (const std::optional<Preset> preset = choice_named<Preset>(name)) return *preset;
  throw Error({ErrorKind::kUsage,
               fmt::format("unknown preset '{}'", name),
               {},
               "--preset",
               "use " + joined_words<Preset>(", ", " or ")});
}

TrainConfig make_preset(Preset preset) {
  TrainConfig config;
  for (const ConfigKey& key : config_keys()) set_config(config, key.name, key.presets[static_cast<size_t>(preset)]);
  return config;
}

}  // namespace aligngs
