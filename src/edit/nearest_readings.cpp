#include "edit/nearest_readings.h"

#include <algorithm>
#include <regex>
#include <utility>

#include "core/edit_distance.h"
#include "core/letter_case.h"
#include "edit/edit_text.h"
#include "edit/selection_text.h"
#include "edit/sentence_signs.h"
#include "edit/spoken_edit.h"
#include "edit/undo_words.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

constexpr size_t kReadings = 3;
constexpr std::ptrdiff_t kMostNameWords = 4;  // of a name
constexpr size_t kLongestSentence = 200;      // bytes; longer ones are no slip of the fingers

bool is_known_verb(const std::string& word) {
  const std::vector<std::string> verbs = edit_verbs();
  return std::find(verbs.begin(), verbs.end(), word) != verbs.end();
}

/// Answers to another verb than any. The first one changes nothing that stays hard to see.
std::vector<std::string> answers_to(const std::string& word) {
  constexpr std::string_view kAdding[] = {"add", "insert", "create", "spawn"};
  constexpr std::string_view kSparing[] = {"leave", "spare", "preserve", "protect", "save", "retain"};
  if (std::find(std::begin(kAdding), std::end(kAdding), word) != std::end(kAdding)) return {"duplicate", "highlight"};
  if (std::find(std::begin(kSparing), std::end(kSparing), word) != std::end(kSparing)) return {"highlight"};
  return {"highlight", "delete", "extract"};
}

/// The verbs nearest to a word; only itself where it is one.
std::vector<std::string> verbs_near(const std::string& word) {
  if (is_known_verb(word)) return {word};
  std::vector<std::string> verbs = edit_verbs();
  std::stable_sort(verbs.begin(), verbs.end(), [&](const std::string& a, const std::string& b) {
    return edit_distance(a, word) < edit_distance(b, word);
  });
  verbs.resize(std::min(verbs.size(), kReadings));
  return 3 * edit_distance(verbs.front(), word) > word.size() ? answers_to(word) : verbs;
}

bool is_understood(const std::string& sentence, const Vocabulary& vocabulary) {
  try {
    parse_selection(parse_edit(sentence).select, vocabulary);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Whether a sentence takes the whole room: no word that is left out may do that.
bool takes_all(const std::string& sentence, const Vocabulary& vocabulary) {
  const SelectionQuery query = parse_selection(parse_edit(sentence).select, vocabulary);
  return query.everything && query.exclude.empty();
}

bool is_undo(const std::string& sentence) {
  try {
    return parse_undo(sentence).has_value();
  } catch (const Error&) {
    return false;
  }
}

/// Whether the words ask for an undo, and do not tell which: the message about that says more than readings.
bool is_unclear_undo(const std::string& sentence) {
  try {
    parse_undo(sentence);
    return false;
  } catch (const Error&) {
    return true;
  }
}

/// A word that is not known. Other errors have remedies of their own.
bool is_about_a_word(const Error& error) {
  const std::string& message = error.details().message;
  return message.find("is no edit") != std::string::npos || message.find("there is no class") != std::string::npos ||
         error.details().remedy.empty();
}

/// Words that change what is meant where they are left out.
bool is_small_word(const std::string& word) {
  constexpr std::string_view kSmall[] = {"but", "except", "without", "not", "no", "and", "or", "on", "in", "to", "of"};
  return std::find(std::begin(kSmall), std::end(kSmall), word) != std::end(kSmall);
}

bool has_small_word(const std::string& words) {
  for (size_t begin = 0; begin < words.size();) {
    const size_t end = std::min(words.find(' ', begin), words.size());
    if (is_small_word(words.substr(begin, end - begin))) return true;
    begin = end + 1;
  }
  return false;
}

/// A name in place of words that it has little to do with.
bool is_far(const std::string& words, size_t distance) { return distance > std::max<size_t>(1, words.size() / 2); }

/// "Make the armchair lighter" as the colour of it.
std::vector<std::string> shade_reading(const std::string& text, const Vocabulary& vocabulary) {
  static const std::regex pattern(
      "(?:make|turn|paint|color|colour) +(\\S.*?) +(?:(?:much|slightly|a +bit|a +little) "
      "+)?(lighter|brighter|paler|darker)");
  std::smatch match;
  if (!std::regex_match(text, match, pattern)) return {};
  const std::string sentence = "recolor " + match[1].str() + (match[2].str() == "darker" ? " dim gray" : " light gray");
  return is_understood(sentence, vocabulary) ? std::vector<std::string>{sentence} : std::vector<std::string>{};
}

/// Sizes, sides, ordinals and colours near a mistyped word, nearest first. It is half right at least.
std::vector<std::string_view> describing_words_near(const std::string& word) {
  constexpr std::string_view kWords[] = {"largest", "biggest", "smallest", "tallest", "shortest", "left",   "right",
                                         "middle",  "first",   "second",   "third",   "last",     "dark",   "light",
                                         "pale",    "bright",  "red",      "green",   "blue",     "yellow", "orange",
                                         "brown",   "white",   "black",    "grey",    "gray",     "purple", "pink"};
  std::vector<std::pair<size_t, std::string_view>> near;
  for (const std::string_view known : kWords) {
    const size_t distance = edit_distance(word, std::string(known));
    if (distance > 0 && 2 * distance <= word.size()) near.emplace_back(distance, known);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string_view> out;
  for (const auto& [distance, known] : near) out.push_back(known);
  return out;
}

/// `object` with one stretch of its words replaced by a known name, so that it is understood; nearest first.
std::vector<std::string> objects_near(const std::string& verb, const std::string& object,
                                      const Vocabulary& vocabulary) {
  if (is_understood(verb + " " + object, vocabulary)) return {object};
  std::vector<size_t> begins = {0}, ends;
  for (size_t i = 0; i < object.size(); ++i) {
    if (object[i] == ' ' || object[i] == ',') {
      ends.push_back(i);
      begins.push_back(i + 1);
    }
  }
  ends.push_back(object.size());
  struct Reading {
    size_t distance;
    std::string text;
    bool far = false;
  };
  std::vector<Reading> readings;
  for (const size_t begin : begins) {
    for (const size_t end : ends) {
      if (end <= begin) continue;
      if (std::count(object.begin() + static_cast<std::ptrdiff_t>(begin),
                     object.begin() + static_cast<std::ptrdiff_t>(end), ' ') >= kMostNameWords)
        continue;
      const std::string words = object.substr(begin, end - begin), name = words.substr(0, words.find('#'));
      for (const std::string& known : vocabulary.suggestions(name, kReadings)) {
        if (has_small_word(name) && !has_small_word(known)) continue;  // "to me" is no "tome"
        const std::string text = object.substr(0, begin) + known + words.substr(name.size()) + object.substr(end);
        if (!is_understood(verb + " " + text, vocabulary)) continue;
        const size_t distance = edit_distance(name, known);
        readings.push_back({distance, text, is_far(name, distance)});
      }
    }
  }
  for (const size_t begin : begins) {
    const size_t end = std::min(object.find_first_of(" ,", begin), object.size());
    for (const std::string_view known : describing_words_near(object.substr(begin, end - begin))) {
      const std::string text = object.substr(0, begin) + std::string(known) + object.substr(end);
      if (is_understood(verb + " " + text, vocabulary)) readings.push_back({0, text});
    }
  }
  // A word that is no part of a name may be too much: "the red pillow" is a pillow.
  for (const size_t begin : begins) {
    for (const size_t end : ends) {
      const bool is_last = end == object.size();
      if (end <= begin || (is_last ? begin < 2 || object[begin - 2] == ',' : object[end] != ' ')) continue;
      const std::string text = is_last ? object.substr(0, begin - 1) : object.substr(0, begin) + object.substr(end + 1);
      const bool one_word = std::min(object.find(' ', begin), object.size()) == end;
      if (one_word && !is_small_word(object.substr(begin, end - begin)) &&
          is_understood(verb + " " + text, vocabulary) && !takes_all(verb + " " + text, vocabulary))
        readings.push_back({0, text});
    }
  }
  std::stable_sort(readings.begin(), readings.end(),
                   [](const Reading& a, const Reading& b) { return a.distance < b.distance; });
  std::vector<std::string> out;
  // Far names fill up what a near one begins. By themselves they mean something else.
  if (std::all_of(readings.begin(), readings.end(), [](const Reading& r) { return r.far; })) return out;
  for (const Reading& r : readings) {
    if (std::find(out.begin(), out.end(), r.text) == out.end()) out.push_back(r.text);
  }
  return out;
}

}  // namespace

std::vector<std::string> nearest_readings(std::string_view given, const Vocabulary& vocabulary) {
  if (given.size() > kLongestSentence) return {};
  const std::string whole_text = without_courtesy(lower_case(trimmed(given)));
  if (whole_text.empty() || is_unclear_undo(whole_text) || is_understood(whole_text, vocabulary)) return {};
  if (second_verb(whole_text)) return {};
  if (const std::vector<std::string> shade = shade_reading(whole_text, vocabulary); !shade.empty()) return shade;
  const bool is_negated = has_negation(whole_text);
  const std::string text = behind_negation(whole_text);
  const size_t blank = std::min(text.find(' '), text.size());
  const std::string first = text.substr(0, blank);
  constexpr std::string_view kUndo = "undo";
  if (first != kUndo && edit_distance(first, kUndo) <= kUndo.size() / 2 && !is_known_verb(first)) {
    const std::string whole = std::string(kUndo) + text.substr(blank);
    return {is_undo(whole) ? whole : std::string(kUndo)};
  }
  // A sentence without a verb that is a name asks for an edit of that thing.
  const bool only_object = !is_known_verb(first) && is_understood("delete " + text, vocabulary);
  const std::string object = only_object ? text : text.substr(std::min(blank + 1, text.size()));
  const std::vector<std::string> verbs = is_negated    ? std::vector<std::string>{"highlight"}
                                         : only_object ? answers_to("")
                                                       : verbs_near(first);
  std::vector<std::string> readings;
  for (const std::string& verb : verbs) {
    for (const std::string& near : objects_near(verb, object, vocabulary)) {
      if (readings.size() < kReadings) readings.push_back(verb + " " + near);
      if (verbs.size() > 1) break;  // the verb is what differs
    }
  }
  return readings;
}

Error with_readings(const Error& error, std::string_view text, const Vocabulary& vocabulary) {
  if (!is_about_a_word(error)) return error;
  std::string remedy;
  for (const std::string& reading : nearest_readings(text, vocabulary)) {
    remedy += (remedy.empty() ? "did you mean " : " or ") + ("\"" + reading + "\"");
  }
  if (remedy.empty()) return error;
  Error::Details details = error.details();
  details.remedy = remedy + "?";
  return Error(details);
}

EditRequest read_request(std::string_view text, const Vocabulary& vocabulary) {
  if (text.find(';') != std::string_view::npos)
    throw_usage("a sentence holds one edit, and \";\" begins another one", "make the edits one after the other");
  try {
    EditRequest request = parse_request(text);
    if (!request.undo) parse_selection(request.edit.select, vocabulary);
    return request;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kUsage) throw;
    if (const auto verb = second_verb(std::string(text.substr(0, kLongestSentence)))) {
      throw_usage("a sentence holds one edit, and \"" + *verb + "\" begins another one",
                  "make the edits one after the other");
    }
    throw with_readings(error, text, vocabulary);
  }
}

}  // namespace aligngs
