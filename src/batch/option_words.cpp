#include "batch/option_words.h"

#include "core/error.h"

namespace aligngs {

std::vector<std::string> split_words(std::string_view text) {
  std::vector<std::string> words;
  std::string word;
  bool begun = false;
  char quote = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote == '\'' ? c == '\'' : quote == '"' && c == '"') {
      quote = 0;
    } else if (c == '\\' && quote != '\'' && i + 1 < text.size()) {
      word += text[++i];
      begun = true;
    } else if (quote != 0) {
      word += c;
    } else if (c == '\'' || c == '"') {
      quote = c;
      begun = true;
    } else if (c == ' ' || c == '\t') {
      if (begun) words.push_back(std::move(word));
      word.clear();
      begun = false;
    } else {
      word += c;
      begun = true;
    }
  }
  if (quote != 0) throw_usage("a quote is not closed: " + std::string(text), "close it, or put a backslash before it");
  if (begun) words.push_back(std::move(word));
  return words;
}

bool has_option(const std::vector<std::string>& words, const std::string& name) {
  for (const std::string& word : words) {
    if (word == name || word.rfind(name + "=", 0) == 0) return true;
  }
  return false;
}

std::string option_value(const std::vector<std::string>& words, const std::string& name) {
  std::string value;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == name && i + 1 < words.size()) value = words[i + 1];
    if (words[i].rfind(name + "=", 0) == 0) value = words[i].substr(name.size() + 1);
  }
  return value;
}

}  // namespace aligngs
