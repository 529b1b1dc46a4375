#include "serve/request_body.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace aligngs {

int json_depth(std::string_view text) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\')
        ++i;  // the next character is not the end of the string
      else if (c == '"')
        in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      deepest = std::max(deepest, ++depth);
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return deepest;
}

std::optional<std::string> json_fault(std::string_view body, int deepest) {
  if (json_depth(body) > deepest) return "the JSON is nested deeper than " + std::to_string(deepest) + " levels";
  if (!nlohmann::json::accept(body)) return "the body is not JSON";
  return {};
}

}  // namespace aligngs
