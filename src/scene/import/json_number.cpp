#include "scene/import/json_number.h"

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/json_text.h"
#include "io/text_encoding.h"

namespace aligngs {
namespace {

std::optional<double> stated_number(const nlohmann::json& value) {
  if (value.is_number()) return value.get<double>();
  if (!value.is_string()) return {};
  const std::string text = value.get<std::string>();  // "1920", as some programs write it
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || end != text.c_str() + text.size()) return {};
  return number;
}

}  // namespace

double number_of_json(const nlohmann::json& value) { return stated_number(value).value_or(NAN); }

bool is_number_of_json(const nlohmann::json& value) { return stated_number(value).has_value(); }

std::string no_number(const nlohmann::json& value) {
  constexpr size_t kLongest = 40;  // bytes: enough to find the value in the file
  std::string text = json_line(value);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + " ...";
  return "expected a number, found " + as_utf8(text);
}

}  // namespace aligngs
