#include "io/json_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace aligngs {
namespace {

constexpr int kOneLine = -1, kIndentation = 2;  // as nlohmann::json has them

template <typename Json>
std::string text_of(const Json& value, int indentation) {
  return value.dump(indentation, ' ', false, Json::error_handler_t::replace);
}

/// The text with Python's words of numbers that are not finite in quotes; strings keep them.
std::string without_python_words(std::string_view text) {
  std::string out;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      out += c;
      if (c == '\\' && i + 1 < text.size())
        out += text[++i];
      else if (c == '"')
        in_string = false;
      continue;
    }
    in_string = c == '"';
    bool replaced = false;
    for (const std::string_view word : {"NaN", "Infinity", "-Infinity"}) {
      if (text.substr(i, word.size()) != word) continue;
      const size_t next = text.find_first_not_of(" \t\r\n", i + word.size());
      if (next != text.npos && text[next] == ':') break;  // a key without quotes, which is no JSON
      out += '"';
      out += word;
      out += '"';
      i += word.size() - 1;
      replaced = true;
      break;
    }
    if (!replaced) out += c;
  }
  return out;
}

template <typename Json>
Json parsed(std::string_view text) {
  Json value = Json::parse(text, nullptr, false);
  if (value.is_discarded() && (text.find("NaN") != text.npos || text.find("Infinity") != text.npos)) {
    value = Json::parse(without_python_words(text), nullptr, false);
  }
  return value;
}

}  // namespace

std::string json_line(const nlohmann::json& value) { return text_of(value, kOneLine); }
std::string json_line(const nlohmann::ordered_json& value) { return text_of(value, kOneLine); }
std::string json_document(const nlohmann::json& value) { return text_of(value, kIndentation) + "\n"; }
std::string json_document(const nlohmann::ordered_json& value) { return text_of(value, kIndentation) + "\n"; }
nlohmann::json parse_json(std::string_view text) { return parsed<nlohmann::json>(text); }
nlohmann::ordered_json parse_ordered_json(std::string_view text) { return parsed<nlohmann::ordered_json>(text); }

std::string without_comments(std::string_view text) {
  std::string out(text);
  size_t comma = out.npos;  // the last character that counts, if it is one
  for (size_t i = 0; i < out.size(); ++i) {
    const std::string_view two = std::string_view(out).substr(i, 2);
    if (two == "//" || two == "/*") {
      const size_t found = two == "//" ? out.find('\n', i) : out.find("*/", i + 2);
      const size_t end = found == out.npos ? out.size() : two == "//" ? found : found + 2;
      std::replace_if(
          out.begin() + ptrdiff_t(i), out.begin() + ptrdiff_t(end), [](char c) { return c != '\n'; }, ' ');
      i = end - 1;
    } else if (out[i] == '"') {
      for (++i; i < out.size() && out[i] != '"'; ++i) i += out[i] == '\\';
      comma = out.npos;
    } else if (out[i] == ',') {
      comma = i;
    } else if (std::string_view(" \t\r\n").find(out[i]) == std::string_view::npos) {
      if ((out[i] == ']' || out[i] == '}') && comma != out.npos) out[comma] = ' ';
      comma = out.npos;
    }
  }
  return out;
}

std::string place_of_json_fault(std::string_view text) {
  size_t end = text.size();
  try {
    const nlohmann::json value = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    if (error.byte > 0) end = std::min(end, error.byte - 1);  // counted from one
  } catch (const nlohmann::json::exception&) {                // of it the parser tells no place
    return "a number beyond all";
  }
  const std::string_view before = text.substr(0, end);
  const size_t line = before.rfind('\n');
  return "line " + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ", column " +
         std::to_string(line == before.npos ? end + 1 : end - line);
}

}  // namespace aligngs
