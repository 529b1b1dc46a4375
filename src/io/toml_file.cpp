// Format: https://toml.io/en/v1.0.0
#include "io/toml_file.h"

#include <toml++/toml.h>

#include <array>
#include <charconv>
#include <stdexcept>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/text_encoding.h"

namespace aligngs {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t(16) << 20;  // settings of 16 MiB are no settings
const char* const kTomlRemedy = "correct the file; config.toml of any run shows the form";

std::string line_field(const toml::source_region& source) { return "line " + std::to_string(source.begin.line); }

class Flattener {
 public:
  explicit Flattener(const std::filesystem::path& name) : name_(name) {}

  TomlTable flatten(const toml::table& table) {
    add_table(table, "");
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& message) const {
    throw_bad_input(name_, line_field(node.source()) + ", " + key, message, kTomlRemedy);
  }

  void add_table(const toml::table& table,
                 const std::string& prefix) {  // depth is bounded by the TOML parser
    for (const auto& [toml_key, node] : table) {
      const std::string key(toml_key.str());
      if (key.empty() || key.find('.') != std::string::npos) fail(node, prefix + key, "a key is empty or has a dot");
      if (const toml::table* inner = node.as_table()) {
        add_table(*inner, prefix + key + ".");
      } else {
        out_[prefix + key] = {value_of(node, prefix + key), static_cast<int>(node.source().begin.line)};
      }
    }
  }

  TomlValue value_of(const toml::node& node, const std::string& key) const {
    if (const auto* value = node.as_boolean()) return value->get();
    if (const auto* value = node.as_integer()) return value->get();
    if (const auto* value = node.as_floating_point()) return value->get();
    if (const auto* value = node.as_string()) return value->get();
    if (const auto* array = node.as_array()) return list_of(*array, key);
    fail(node, key, "dates and times are not supported");
  }

  TomlValue list_of(const toml::array& array, const std::string& key) const {
    std::vector<double> numbers;
    std::vector<std::string> strings;
    for (const toml::node& item : array) {
      if (const auto* integer = item.as_integer()) {
        numbers.push_back(static_cast<double>(integer->get()));
      } else if (const auto* real = item.as_floating_point()) {
        numbers.push_back(real->get());
      } else if (const auto* string = item.as_string()) {
        strings.push_back(string->get());
      } else {
        fail(item, key, "a list holds numbers or strings");
      }
    }
    if (!numbers.empty() && !strings.empty()) fail(array, key, "a list holds either numbers or strings");
    if (!strings.empty()) return strings;
    return numbers;
  }

  const std::filesystem::path& name_;
  TomlTable out_;
};

std::string format_double(double value) {
  if (value != value) return "nan";
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  std::string text(digits.data(), end);
  // "1" would come back as an integer; "inf" and "1e+22" are floats as they are.
  if (text.find_first_not_of("-0123456789") == std::string::npos) text += ".0";
  return text;
}

std::string format_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += std::string("\\") + c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      constexpr char kHex[] = "0123456789ABCDEF";
      out += std::string("\\u00") + kHex[c >> 4 & 15] + kHex[c & 15];
    } else {
      out += c;
    }
  }
  return out + '"';
}

struct Formatter {
  std::string operator()(bool v) const { return v ? "true" : "false"; }
  std::string operator()(int64_t v) const { return std::to_string(v); }
  std::string operator()(double v) const { return format_double(v); }
  std::string operator()(const std::string& v) const { return format_string(v); }
  template <class T>
  std::string operator()(const std::vector<T>& list) const {
    std::string out = "[";
    for (const T& item : list) out += (out.size() > 1 ? ", " : "") + (*this)(item);
    return out + "]";
  }
};

/// A dotted key with those parts quoted that are more than letters, digits, "_" and "-".
std::string format_key(std::string_view key) {
  std::string out;
  while (true) {
    const size_t dot = key.find('.');
    const std::string_view part = key.substr(0, dot);
    const bool bare = !part.empty() && part.find_first_not_of(
                                           "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                           "0123456789_-") == std::string_view::npos;
    out += bare ? std::string(part) : format_string(part);
    if (dot == std::string_view::npos) return out;
    out += '.';
    key.remove_prefix(dot + 1);
  }
}

}  // namespace

TomlTable parse_toml(std::string_view text, const std::filesystem::path& name_for_errors) {
  toml::table table;
  try {
    table = toml::parse(text, name_for_errors.string());
  } catch (const toml::parse_error& error) {
    throw_bad_input(name_for_errors, line_field(error.source()), std::string(error.description()), kTomlRemedy);
  }
  return Flattener(name_for_errors).flatten(table);
}

TomlTable read_toml(const std::filesystem::path& path) {
  return parse_toml(text_of_file(read_file(path, kMaxFileBytes), path), path);
}

TomlValue parse_toml_value(std::string_view text, const std::string& field_for_errors) {
  if (text.find('\n') != std::string_view::npos) throw_bad_input({}, field_for_errors, "a value of several lines");
  try {
    return parse_toml("value = " + std::string(text), "").at("value").value;
  } catch (const Error& error) {
    throw_bad_input({}, field_for_errors, error.details().message, "write strings in quotes");
  } catch (const std::out_of_range&) {
    throw_bad_input({}, field_for_errors, "not a value", "write strings in quotes");
  }
}

std::string format_toml(const std::map<std::string, TomlValue>& values) {
  // Top-level keys must come before the first [table].
  std::map<std::string, std::string> tables;
  for (const auto& [key, value] : values) {
    const size_t dot = key.rfind('.');
    const std::string table = dot == std::string::npos ? "" : key.substr(0, dot);
    const std::string name = dot == std::string::npos ? key : key.substr(dot + 1);
    tables[table] += format_key(name) + " = " + std::visit(Formatter{}, value) + "\n";
  }
  std::string out;
  for (const auto& [table, lines] : tables) {
    if (!table.empty()) out += (out.empty() ? "[" : "\n[") + format_key(table) + "]\n";
    out += lines;
  }
  return out;
}

void write_toml(const std::filesystem::path& path, const std::map<std::string, TomlValue>& values) {
  const std::string text = format_toml(values);
  try {  // what cannot be read back (text that is not UTF-8, "a" beside "a.b") is refused now, not
         // on resuming
    parse_toml(text, path);
  } catch (const Error& error) {
    throw Error(
        {ErrorKind::kFailed, "cannot be written as TOML: " + error.details().message, path, error.details().field, ""});
  }
  write_file_atomically(path, text);
}

}  // namespace aligngs
