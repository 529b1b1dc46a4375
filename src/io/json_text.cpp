#include "io/json_text.h"

#include <nlohmann/json.hpp>

namespace aligngs {
namespace {

constexpr int kOneLine = -1, kIndentation = 2;  // as nlohmann::json has them

template <typename Json>
std::string text_of(const Json& value, int indentation) {
  return value.dump(indentation, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string json_line(const nlohmann::json& value) { return text_of(value, kOneLine); }
std::string json_line(const nlohmann::ordered_json& value) { return text_of(value, kOneLine); }
std::string json_document(const nlohmann::json& value) { return text_of(value, kIndentation) + "\n"; }
std::string json_document(const nlohmann::ordered_json& value) { return text_of(value, kIndentation) + "\n"; }
nlohmann::json parse_json(std::string_view text) { return nlohmann::json::parse(text, nullptr, false); }
nlohmann::ordered_json parse_ordered_json(std::string_view text) { return nlohmann::ordered_json::parse(text, nullptr, false); }

}  // namespace aligngs
