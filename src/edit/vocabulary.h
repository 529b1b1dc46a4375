// Names that people give to things, and the class of a label set that they mean.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "scene/label_set.h"

namespace aligngs {

/// Lower case, words parted by single blanks; '-' and '_' count as blanks.
std::string folded_name(std::string_view text);
/// A folded name without "the", "a" or "an" before it.
std::string without_article(std::string folded);

/// Names, synonyms and everyday words of one label set. Case, plural, blanks, '-' and '_' do not matter. A typing error is
/// answered with suggestions, never guessed. An edit of the wrong object is worse than a second try.
class Vocabulary {
 public:
  explicit Vocabulary(const LabelSet& labels);

  /// Class number, or nothing when the word is unknown. A name goes before a synonym, a synonym before a plural.
  std::optional<int> find(std::string_view word) const;
  /// Whether the word is a plural of a known word, and none itself: "beds", but not "stairs".
  bool is_plural(std::string_view word) const;
  /// Class number; Error{kUsage} with suggestions when the word is unknown.
  int resolve(std::string_view word) const;
  /// Classes that the room holds: they come first among the suggestions.
  void prefer(const std::vector<int>& labels);
  /// Known words, nearest first, one for each class. They differ from `word` in at most a third of its letters; after
  /// those come the nearest ones of the preferred classes.
  std::vector<std::string> suggestions(std::string_view word, size_t most = 3) const;
  const LabelSet& labels() const { return labels_; }

  /// A selection that was drawn by hand (named_selection.h) has this name. Names go before classes.
  void add_selection(const std::string& name);
  /// Its name as it was added, or nothing. Quantifiers and articles before it do not matter.
  std::optional<std::string> find_selection(std::string_view words) const;

 private:
  void add(const std::string& word, int label);

  LabelSet labels_;
  std::map<std::string, int> exact_;               ///< folded names and synonyms
  std::map<std::string, int> singular_;            ///< their singular forms
  std::map<std::string, int> joined_;              ///< folded names and synonyms without their blanks
  std::set<int> preferred_;                        ///< classes
  std::map<std::string, std::string> selections_;  ///< names by their folded form
};

}  // namespace aligngs
