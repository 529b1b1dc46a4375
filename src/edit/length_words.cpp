#include "edit/length_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <regex>
#include <string_view>
#include <vector>

#include "core/letter_case.h"

namespace aligngs {
namespace {

constexpr std::string_view kSmallNumbers[] = {
    "zero", "one",    "two",    "three",    "four",     "five",    "six",     "seven",     "eight",    "nine",
    "ten",  "eleven", "twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen"};
constexpr std::string_view kTensNumbers[] = {"",      "",      "twenty",  "thirty", "forty",
                                             "fifty", "sixty", "seventy", "eighty", "ninety"};

/// Units of a length in words. "In" is none: "the two in the corner".
constexpr std::string_view kSaidUnit =
    "(?:m|metres?|meters?|cm|centimetres?|centimeters?|mm|millimetres?|millimeters?|inch|inches|ft|foot|feet)\\b";

struct LengthFraction {
  const char *sign, *digits, *decimals;
};
constexpr LengthFraction kLengthFractions[] = {
    {"\xc2\xbd", "1/2", "5"}, {"\xc2\xbc", "1/4", "25"}, {"\xc2\xbe", "3/4", "75"}};

/// 0 for no word.
int number_in_words(const std::string& given) {
  const std::string word = lower_case(given);
  for (size_t n = 0; n < std::size(kSmallNumbers); ++n) {
    if (word == kSmallNumbers[n]) return static_cast<int>(n);
  }
  for (size_t n = 2; n < std::size(kTensNumbers); ++n) {
    if (word == kTensNumbers[n]) return static_cast<int>(10 * n);
  }
  return 0;
}

size_t marks_in(const std::string& text, char letter) {
  return static_cast<size_t>(std::count(text.begin(), text.end(), letter));
}

/// 5' and 12".
void say_feet_and_inches(std::string& text) {
  const bool feet = marks_in(text, '\'') == 1, inches = marks_in(text, '"') == 1;
  static const std::regex both("(^| )([0-9]{1,3})' *([0-9]{1,2})\"(?= |$)"),
      one_foot("(^| )([0-9]+[.,]?[0-9]*)'(?= |$)"), one_inch("(^| )([0-9]+[.,]?[0-9]*)\"(?= |$)");
  std::smatch match;
  if (feet && inches && std::regex_search(text, match, both)) {
    const int sum = 12 * std::stoi(match[2].str()) + std::stoi(match[3].str());
    const std::string plain = match[1].str() + fmt::format("{} in", sum);
    text.replace(static_cast<size_t>(match.position(0)), static_cast<size_t>(match.length(0)), plain);
    return;
  }
  if (feet) text = std::regex_replace(text, one_foot, "$1$2 ft");
  if (inches) text = std::regex_replace(text, one_inch, "$1$2 in");
}

struct FractionPattern {
  std::regex after_a_number, alone;
  std::string decimals;
};

const std::vector<FractionPattern>& fraction_patterns() {
  static const std::vector<FractionPattern> all = [] {
    std::vector<FractionPattern> out;
    const std::string unit = fmt::format("(?= *(?:in\\b|{}))", kSaidUnit);
    for (const LengthFraction& f : kLengthFractions) {
      const std::string after = fmt::format("(^| )([0-9]+)(?: +{}| *{})", f.digits, f.sign),
                        alone = fmt::format("(^| )(?:{}|{})(?: +of +an?\\b)?", f.sign, f.digits);
      out.push_back(
          {std::regex(after + unit, std::regex::icase), std::regex(alone + unit, std::regex::icase), f.decimals});
    }
    return out;
  }();
  return all;
}

/// "1/2 m", "1 1/2 m" and the signs for these fractions.
void say_fractions(std::string& text) {
  for (const FractionPattern& f : fraction_patterns()) {
    text = std::regex_replace(text, f.after_a_number, "$1$2." + f.decimals);
    text = std::regex_replace(text, f.alone, "$010." + f.decimals);
  }
}

/// "1 and a half metres" and "1 metre and a half".
void say_halves(std::string& text) {
  static const std::regex before(fmt::format("(^| )([0-9]+) +and +a +half(?= +{})", kSaidUnit), std::regex::icase),
      after(fmt::format("(^| )([0-9]+) *({}) +and +a +half\\b", kSaidUnit), std::regex::icase);
  text = std::regex_replace(text, before, "$1$2.5");
  text = std::regex_replace(text, after, "$1$2.5 $3");
}

/// "Two hundred and fifty cm", "twenty-five cm".
void say_numbers(std::string& text) {
  static const std::regex pattern = [] {
    std::string ones, tens;
    for (const std::string_view word : kSmallNumbers) ones += (ones.empty() ? "" : "|") + std::string(word);
    for (size_t n = 2; n < std::size(kTensNumbers); ++n)
      tens += (tens.empty() ? "" : "|") + std::string(kTensNumbers[n]);
    const std::string number = fmt::format("(?:({1})(?:[- ]+({0}))?|({0}))", ones, tens);
    const std::string text_of = fmt::format(
        "(^| )(?:(?:(an?|{0}) +hundred)(?: +(?:and +)?{1})?|{1})(?= +(?:and +a +half "
        "+)?{2})",
        ones, number, kSaidUnit);
    return std::regex(text_of, std::regex::icase);
  }();
  std::smatch match;
  while (std::regex_search(text, match, pattern)) {
    int sum = 0;
    if (match[2].matched) sum = 100 * std::max(1, number_in_words(match[2].str()));
    for (size_t part = 3; part <= 8; ++part) sum += match[part].matched ? number_in_words(match[part].str()) : 0;
    const std::string plain = match[1].str() + std::to_string(sum);
    text.replace(static_cast<size_t>(match.position(0)), static_cast<size_t>(match.length(0)), plain);
  }
}

}  // namespace

std::string with_plain_lengths(std::string text) {
  constexpr size_t kLongestSaid = 400;  // bytes: the patterns recurse over each letter
  if (text.size() > kLongestSaid) return text;
  say_feet_and_inches(text);
  say_fractions(text);
  say_numbers(text);
  say_halves(text);
  return text;
}

}  // namespace aligngs
