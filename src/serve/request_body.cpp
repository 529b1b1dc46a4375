#include "serve/request_body.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/json_text.h"

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

nlohmann::json text_fields(const std::string& body, std::initializer_list<const char*> fields, size_t longest) {
  nlohmann::json json = parse_json(body);
  const auto refuse = [](const std::string& field, const std::string& message, const std::string& remedy) {
    throw Error({ErrorKind::kUsage, message, {}, field, remedy});
  };
  if (!json.is_object()) refuse("", "the request is no JSON object", "send an object of texts");
  std::string known;
  for (const char* name : fields) {
    known += (known.empty() ? "" : ", ") + std::string(name);
    const auto it = json.find(name);
    if (it == json.end() || !it->is_string())
      refuse(name, std::string("the request has no text \"") + name + "\"", "add it");
    if (it->get_ref<const std::string&>().size() > longest)
      refuse(name, std::string("\"") + name + "\" is too long", "send at most " + std::to_string(longest) + " bytes");
  }
  for (const auto& item : json.items()) {
    const std::string& name = item.key();
    const bool asked = std::any_of(fields.begin(), fields.end(), [&](const char* field) { return name == field; });
    if (!asked) refuse(name.substr(0, 40), "the request has fields that nobody knows", "send these alone: " + known);
  }
  return json;
}

}  // namespace aligngs
