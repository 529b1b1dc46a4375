#include "edit/relation/relation_words.h"

#include <utility>

#include "edit/selection_words.h"
#include "io/text_tokens.h"

namespace aligngs {
namespace {

/// The first word of a relation is the one that messages use.
constexpr std::pair<std::string_view, Relation> kRelationWords[] = {
    {"on", Relation::kOn},
    {"on top of", Relation::kOn},
    {"upon", Relation::kOn},
    {"onto", Relation::kOn},
    {"in", Relation::kIn},
    {"inside", Relation::kIn},
    {"inside of", Relation::kIn},
    {"within", Relation::kIn},
    {"belonging to", Relation::kOwned},
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
    {"alongside", Relation::kNextTo},
    {"adjacent to", Relation::kNextTo},
    {"near", Relation::kNear},
    {"near to", Relation::kNear},
    {"close to", Relation::kNear},
    {"close by", Relation::kNear},
    {"nearby", Relation::kNear},
    {"around", Relation::kNear},
    {"nearest", Relation::kNearest},
    {"nearest to", Relation::kNearest},
    {"closest to", Relation::kNearest},
    {"closest", Relation::kNearest},
    {"farthest from", Relation::kFarthest},
    {"farthest away from", Relation::kFarthest},
    {"furthest from", Relation::kFarthest},
    {"furthest away from", Relation::kFarthest},
    {"most distant from", Relation::kFarthest},
    {"left of", Relation::kLeftOf},
    {"to the left of", Relation::kLeftOf},
    {"on the left of", Relation::kLeftOf},
    {"right of", Relation::kRightOf},
    {"to the right of", Relation::kRightOf},
    {"on the right of", Relation::kRightOf},
    {"in front of", Relation::kInFrontOf},
    {"behind", Relation::kBehind},
    {"in back of", Relation::kBehind},
    {"between", Relation::kBetween},
    {"in between", Relation::kBetween},
    {"on the left side of", Relation::kLeftSide},
    {"on the left half of", Relation::kLeftSide},
    {"on the right side of", Relation::kRightSide},
    {"on the right half of", Relation::kRightSide},
    {"on either side of", Relation::kBothSides},
    {"on both sides of", Relation::kBothSides},
    {"on each side of", Relation::kBothSides},
    {"to either side of", Relation::kBothSides},
    {"holding", Relation::kHolding},
    {"carrying", Relation::kHolding},
    {"that holds", Relation::kHolding},
    {"that has", Relation::kHolding},
    {"that have", Relation::kHolding},
    {"which has", Relation::kHolding},
    {"in the corner", Relation::kInCorner},
    {"in a corner", Relation::kInCorner},
    {"in the corners", Relation::kInCorner},
    {"in corners", Relation::kInCorner},
    {"in the middle of the room", Relation::kRoomMiddle}};

}  // namespace

std::optional<FoundRelation> find_relation(std::string_view text, bool leading) {
  std::optional<FoundRelation> found;
  for (const auto& [word, relation] : kRelationWords) {
    const size_t at = find_word(text, word, leading ? 0 : 1);
    if (at == std::string_view::npos || (leading && at != 0)) continue;
    if (!is_of_room(relation) && trimmed(text.substr(at + word.size())).empty()) continue;
    if (!found || at < found->at || (at == found->at && word.size() > found->length))
      found = FoundRelation{relation, at, word.size()};
  }
  return found;
}

bool is_of_room(Relation relation) { return relation == Relation::kInCorner || relation == Relation::kRoomMiddle; }

bool is_distance(Relation relation) {
  return relation != Relation::kOn && relation != Relation::kIn && relation != Relation::kOwned &&
         relation != Relation::kUnder && relation != Relation::kAbove && relation != Relation::kBetween &&
         relation != Relation::kBothSides && relation != Relation::kHolding && relation != Relation::kInCorner;
}

bool is_in_order(Relation relation) {
  return relation == Relation::kNearest || relation == Relation::kFarthest || relation == Relation::kRoomMiddle;
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
