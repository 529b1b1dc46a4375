#include "edit/refused_items.h"

#include "core/error.h"
#include "core/letter_case.h"
#include "edit/selection_words.h"
#include "edit/vocabulary.h"
#include "io/text_tokens.h"

namespace aligngs {

void refuse_other(std::string_view name) {
  const std::string text(name);
  throw_usage("\"other\" does not tell which objects stay",
              "say which one stays: \"every " + text + " but " + text + "#1\"");
}

void refuse_each_nth(std::string_view item) {
  std::string_view rest = trimmed(item);
  if (!take_phrase(rest, "every") && !take_phrase(rest, "each")) return;
  const int number = take_ordinal(rest);
  if (number == 0) return;
  const std::string name(rest);
  throw_usage("\"" + std::string(trimmed(item)) + "\" has two readings",
              "did you mean \"the " + ordinal_text(number) + " " + name + "\"? Name several by their numbers: \"" +
                  name + "#" + std::to_string(number) + ", " + name + "#" + std::to_string(2 * number) + "\"");
}

void refuse_one(std::string_view whole, std::string_view name) {
  constexpr std::string_view kOne = "one", kOnes = "ones";
  const std::string folded = folded_name(name);
  if (folded != kOne && folded != kOnes) return;
  std::string example(whole);
  const size_t at = lower_case(example).rfind(folded);
  if (at != std::string::npos) example.replace(at, folded.size(), folded == kOne ? "lamp" : "lamps");
  throw_usage("\"" + std::string(whole) + "\" does not name a thing", "say its name, such as \"" + example + "\"");
}

void refuse_viewer(std::string_view anchor) {
  const std::string name = without_article(folded_name(anchor));
  for (const std::string_view viewer : {"me", "us", "you", "myself", "camera", "cameras", "viewer"}) {
    if (name == viewer)
      throw_usage("\"" + name + "\" is no thing of the room", "name a thing there, such as \"the door\"");
  }
}

void refuse_numbers(std::string_view whole, std::string_view numbers) {
  const std::string shown = "\"" + std::string(whole) + "\"";
  constexpr std::string_view kDigits = "0123456789";
  const size_t part = numbers.find_first_not_of(kDigits);
  const bool begins = part != 0 && part != std::string_view::npos;
  const auto [first, ignored] = object_numbers(numbers.substr(0, begins ? part : 0));
  const int second = first > 0 && numbers[part] == '-' ? object_numbers(numbers.substr(part + 1)).first : 0;
  if (second > 0 && second < first) {
    throw_usage(shown + " counts backwards", "the smaller number comes first: \"pillow#1-3\"");
  }
  if (first > 0 && numbers[part] == ' ' && object_numbers(numbers).first == 0) {
    throw_usage(shown + " goes on after the object number", "put a comma between objects: \"pillow#1, pillow#2\"");
  }
  if (object_numbers(numbers).second - object_numbers(numbers).first >= kMostNumbersOfRange) {
    throw_usage(shown + " names more than " + std::to_string(kMostNumbersOfRange) + " objects",
                "leave the numbers out for all objects of a class");
  }
  throw_usage(shown + " has no object number after '#'", "objects are numbered from 1: \"pillow#2\" or \"pillow#1-3\"");
}

}  // namespace aligngs
