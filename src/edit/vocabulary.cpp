#include "edit/vocabulary.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <tuple>

#include "core/edit_distance.h"
#include "core/error.h"
#include "edit/class_synonyms.h"
#include "edit/selection_words.h"

namespace aligngs {
namespace {

bool ends_with(const std::string& word, const char* tail) {
  const std::string_view t(tail);
  return word.size() > t.size() && word.compare(word.size() - t.size(), t.size(), t) == 0;
}

/// Forms that may be the singular of a plural, the most regular one first; the word itself last.
std::vector<std::string> singular_forms(const std::string& phrase) {
  // "chests of drawers": the noun that takes the plural precedes " of ".
  const size_t of = phrase.find(" of ");
  const std::string head = phrase.substr(0, of), tail = of == std::string::npos ? "" : phrase.substr(of);
  std::vector<std::string> forms;
  const auto cut = [&](size_t letters, const char* end) {
    forms.push_back(head.substr(0, head.size() - letters) + end + tail);
  };
  if (ends_with(head, "ss")) {
    forms.push_back(phrase);
    return forms;  // "glass" is no plural
  }
  constexpr const char* kIrregular[][2] = {
      {"men", "man"}, {"children", "child"}, {"people", "person"}, {"feet", "foot"}, {"mice", "mouse"}};
  for (const auto& [many, one] : kIrregular) {
    const size_t letters = std::string_view(many).size();
    if (head == many || ends_with(head, many)) cut(letters, one);
  }
  if (ends_with(head, "ies")) cut(3, "y");
  if (ends_with(head, "ves")) {
    cut(3, "f");
    cut(3, "fe");
  }
  if (ends_with(head, "s")) cut(1, "");
  if (ends_with(head, "ses") || ends_with(head, "xes") || ends_with(head, "hes") || ends_with(head, "oes")) cut(2, "");
  forms.push_back(phrase);
  return forms;
}

/// "barstool" for "bar stool".
std::string without_blanks(std::string name) {
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
}

}  // namespace

std::string folded_name(std::string_view text) {
  std::string out;
  for (const char raw : text) {
    const unsigned char c = static_cast<unsigned char>(raw);
    if (std::isspace(c) || raw == '-' || raw == '_') {
      if (!out.empty() && out.back() != ' ') out += ' ';
    } else {
      out += static_cast<char>(std::tolower(c));
    }
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

std::string without_article(std::string folded) {
  for (const std::string_view article : {"the ", "a ", "an "}) {
    if (folded.compare(0, article.size(), article) == 0) folded.erase(0, article.size());
  }
  return folded;
}

void Vocabulary::add(const std::string& word, int label) {
  const std::string folded = folded_name(word);
  if (folded.empty()) return;
  exact_.emplace(folded, label);
  joined_.emplace(without_blanks(folded), label);
  for (const std::string& form : singular_forms(folded)) singular_.emplace(form, label);
}

Vocabulary::Vocabulary(const LabelSet& labels) : labels_(labels) {
  for (int i = 0; i < labels_.size(); ++i) add(labels_.classes[i].name, i);
  for (int i = 0; i < labels_.size(); ++i) {
    for (const std::string& synonym : labels_.classes[i].synonyms) add(synonym, i);
  }
  for (const ClassSynonyms& entry : everyday_synonyms()) {
    const auto it = exact_.find(std::string(entry.name));
    if (it == exact_.end()) continue;
    const int label = it->second;
    for (size_t begin = 0; begin < entry.words.size();) {
      const size_t end = std::min(entry.words.find(';', begin), entry.words.size());
      add(std::string(entry.words.substr(begin, end - begin)), label);
      begin = end + 1;
    }
  }
}

bool Vocabulary::is_plural(std::string_view word) const {
  const std::string folded = without_article(folded_name(word));
  if (exact_.count(folded)) return false;
  const std::vector<std::string> forms = singular_forms(folded);
  return std::any_of(forms.begin(), forms.end(), [&](const std::string& form) {
    return form != folded && (exact_.count(form) > 0 || joined_.count(without_blanks(form)) > 0);
  });
}

std::optional<int> Vocabulary::find(std::string_view word) const {
  std::string folded = folded_name(word);
  if (const auto it = exact_.find(folded); it != exact_.end()) return it->second;
  folded = without_article(std::move(folded));
  for (const std::string& form : singular_forms(folded)) {
    if (const auto it = exact_.find(form); it != exact_.end()) return it->second;
  }
  for (const std::string& form : singular_forms(folded)) {  // "chest of drawer" for "chest of drawers"
    if (const auto it = singular_.find(form); it != singular_.end()) return it->second;
  }
  for (const std::string& form : singular_forms(folded)) {
    if (const auto it = joined_.find(without_blanks(form)); it != joined_.end()) return it->second;
  }
  return std::nullopt;
}

void Vocabulary::prefer(const std::vector<int>& labels) { preferred_ = {labels.begin(), labels.end()}; }

std::vector<std::string> Vocabulary::suggestions(std::string_view word, size_t most) const {
  const std::string folded = without_article(folded_name(word));
  constexpr size_t kLongestWord = 64;  // bytes; nothing longer is a mistyped name, and the distance is quadratic
  if (folded.empty() || folded.size() > kLongestWord) return {};
  struct Near {
    size_t distance;
    bool absent;  ///< from the room
    int label;
    std::string word;
  };
  std::vector<Near> near;
  const size_t limit = std::max<size_t>(1, folded.size() / 3);
  for (const auto& [known, label] : exact_) {
    size_t distance = edit_distance(folded, known);
    for (const std::string& form : singular_forms(folded)) distance = std::min(distance, edit_distance(form, known));
    const bool preferred = preferred_.count(label) != 0;
    // Farther words only where the room holds the thing: they are the nearest of what can be meant.
    if (distance <= limit || preferred) near.push_back({distance, !preferred, label, known});
  }
  int number = -1;
  for (const auto& [folded_selection, name] : selections_) {
    const size_t distance = edit_distance(folded, folded_selection);
    if (distance <= limit) near.push_back({distance, false, number, name});
    --number;
  }
  std::stable_sort(near.begin(), near.end(), [&](const Near& a, const Near& b) {
    const bool a_far = a.distance > limit, b_far = b.distance > limit;
    return std::tie(a_far, a.distance, a.absent) < std::tie(b_far, b.distance, b.absent);
  });
  std::vector<std::string> out;
  std::set<int> said;  // one word for each class
  for (size_t i = 0; i < near.size() && out.size() < most; ++i) {
    if (said.insert(near[i].label).second) out.push_back(near[i].word);
  }
  return out;
}

void Vocabulary::add_selection(const std::string& name) { selections_.emplace(folded_name(name), name); }

std::optional<std::string> Vocabulary::find_selection(std::string_view words) const {
  const std::string_view bare = without_quantifier(words);
  for (const std::string& folded : {folded_name(words), folded_name(bare)}) {
    for (const std::string_view article : {"", "the ", "a ", "an "}) {
      if (folded.compare(0, article.size(), article) != 0) continue;
      if (const auto it = selections_.find(folded.substr(article.size())); it != selections_.end()) return it->second;
    }
  }
  return std::nullopt;
}

int Vocabulary::resolve(std::string_view word) const {
  if (const auto label = find(word)) return *label;
  constexpr size_t kShown = 60;  // bytes of the user's word in the message
  const std::string shown(word.substr(0, kShown));
  std::string remedy;
  for (const std::string& s : suggestions(word))
    remedy += (remedy.empty() ? "did you mean " : " or ") + ("\"" + s + "\"");
  if (!remedy.empty()) remedy += "? ";
  throw_usage("there is no class called \"" + shown + "\" in the label set " + labels_.name,
              remedy + "`aligngs edit RUN --list` shows what the room holds");
}

}  // namespace aligngs
