#include "cli/help_text.h"

#include <algorithm>
#include <utility>

namespace aligngs {

std::string help_footer(const HelpText& text) {
  std::string footer = text.notes;
  if (!footer.empty()) footer += "\n\n";
  return footer + "Reads:    " + text.reads + "\nWrites:   " + text.writes + "\nExample:  " + text.example +
         "\nAdvanced: " + text.advanced;
}

std::string words_in_help(const std::vector<std::string>& words) {
  std::vector<std::pair<std::string, std::string>> entries;  // all but the letter, and what the help says
  for (const std::string& word : words) {
    const bool sized = word.size() > 2 && word[word.size() - 2] == '-';
    const std::string stem = sized ? word.substr(0, word.size() - 1) : word;
    const auto known =
        std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first == stem; });
    if (known == entries.end())
      entries.emplace_back(stem, word);
    else
      known->second += std::string("|") + word.back();
  }
  std::string text;
  for (const auto& entry : entries) text += (text.empty() ? "" : ", ") + entry.second;
  return text;
}

}  // namespace aligngs
