#include "edit/relation/relation_words.h"

#include <utility>

#include "edit/selection_words.h"

namespace aligngs {
namespace {

/// The first word of a relation is the one that messages use.
constexpr std::pair<std::string_view, Relation> kRelationWords[] = {{"on", Relation::kOn},
                                                                    {"on top of", Relation::kOn},
                                                                    {"upon", Relation::kOn},
                                                                    {"onto", Relation::kOn},
                                                                    {"in", Relation::kIn},
                                                                    {"inside", Relation::kIn},
                                                                    {"inside of", Relation::kIn},
                                                                    {"within", Relation::kIn},
                                                                    {"under", Relation::kUnder},
                                                                    {"underneath", Relation::kUnder},
                                                                    {"beneath", Relation::kUnder},
                                                                    {"below", Relation::kUnder},
                                                                    {"above", Relation::kAbove},
                                                                    {"over", Relation::kAbove},
                                                                    {"next to", Relation::kNextTo},
                                                                    {"beside", Relation::kNextTo},
                                                                    {"besides", Relation::kNextTo},
                                                                    {"by", Relation::kNextTo},
                                                                    {"at", Relation::kNextTo},
                                                                    {"against", Relation::kNextTo},
                                                                    {"adjacent to", Relation::kNextTo},
                                                                    {"near", Relation::kNear},
                                                                    {"near to", Relation::kNear},
                                                                    {"close to", Relation::kNear},
                                                                    {"around", Relation::kNear},
                                                                    {"nearest", Relation::kNearest},
                                                                    {"nearest to", Relation::kNearest},
                                                                    {"closest to", Relation::kNearest},
                                                                    {"left of", Relation::kLeftOf},
                                                                    {"to the left of", Relation::kLeftOf},
                                                                    {"on the left of", Relation::kLeftOf},
                                                                    {"on the left side of", Relation::kLeftOf},
                                                                    {"right of", Relation::kRightOf},
                                                                    {"to the right of", Relation::kRightOf},
                                                                    {"on the right of", Relation::kRightOf},
                                                                    {"on the right side of", Relation::kRightOf},
                                                                    {"in front of", Relation::kInFrontOf},
                                                                    {"behind", Relation::kBehind},
                                                                    {"in back of", Relation::kBehind},
                                                                    {"between", Relation::kBetween},
                                                                    {"in between", Relation::kBetween}};

}  // namespace

std::optional<FoundRelation> find_relation(std::string_view text, bool leading) {
  std::optional<FoundRelation> found;
  for (const auto& [word, relation] : kRelationWords) {
    const size_t at = find_word(text, word, leading ? 0 : 1);
    if (at == std::string_view::npos || (leading && at != 0) || trimmed(text.substr(at + word.size())).empty())
      continue;
    if (!found || at < found->at || (at == found->at && word.size() > found->length))
      found = FoundRelation{relation, at, word.size()};
  }
  return found;
}

bool wants_other_side(std::string_view text) {
  constexpr std::string_view kWord = "between";
  size_t last = std::string_view::npos;
  for (size_t at = find_word(text, kWord); at != std::string_view::npos; at = find_word(text, kWord, at + 1)) last = at;
  return last != std::string_view::npos && find_conjunction(text, last).first == std::string_view::npos;
}

std::string_view relation_word(Relation relation) {
  for (const auto& [word, known] : kRelationWords) {
    if (known == relation) return word == "nearest" ? "nearest to" : word;
  }
  return "";
}

}  // namespace aligngs
