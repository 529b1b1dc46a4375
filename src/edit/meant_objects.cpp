#include "edit/meant_objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/error.h"
#include "edit/absent_objects.h"
#include "edit/candidate_filter.h"
#include "edit/object_choice.h"
#include "edit/ordered_objects.h"
#include "edit/relation/room_places.h"

namespace aligngs {
namespace {

/// Objects that others are on, near or between.
struct Anchors {
  std::vector<size_t> objects;
  std::vector<size_t> other_side;  ///< of "between"
};

class MeantObjects {
 public:
  explicit MeantObjects(const RoomObjects& objects) : objects_(objects), relations_(objects), places_(objects) {}

  std::vector<SelectionTerm> terms_of(const SelectionTerm& term) const {
    std::vector<SelectionTerm> out;
    if (is_absent_name(term)) {  // of a list, the things that are there are edited
      out.emplace_back();
      out.back().label = term.label;
      return out;
    }
    for (const size_t i : objects_of(term)) {
      SelectionTerm found;
      found.label = objects_[i].label;
      found.instance = is_whole_group(term) ? 0 : objects_[i].number;
      out.push_back(found);
    }
    return out;
  }

 private:
  /// "All furniture" also takes what of its classes is no object.
  static bool is_whole_group(const SelectionTerm& term) {
    return !term.relation && term.count == 0 && term.choice == ObjectChoice::kNone && term.color.empty() &&
           term.narrow == NarrowPlace::kNone;
  }

  bool is_absent_name(const SelectionTerm& term) const {
    SelectionTerm name = term;
    name.narrow = NarrowPlace::kNone;
    if (term.narrow == NarrowPlace::kNone || name.asks_objects()) return false;
    for (size_t i = 0; i < objects_.size(); ++i) {
      if (objects_[i].label == term.label) return false;
    }
    return true;
  }

  std::string words(const SelectionTerm& term) const {
    SelectionQuery query;
    query.include = {term};
    return selection_text(query, objects_.labels());
  }

  const std::string& class_name(size_t i) const {
    return objects_.labels().classes.at(static_cast<size_t>(objects_[i].label)).name;
  }

  static SelectionTerm without_place(SelectionTerm term) {
    term.relation = nullptr;
    term.count = 0;
    return term;
  }

  std::vector<Instance> all_objects() const {
    std::vector<Instance> all;
    for (size_t i = 0; i < objects_.size(); ++i) all.push_back(objects_[i]);
    return all;
  }

  /// Objects of the class or group, anywhere.
  std::vector<size_t> candidates_of(const SelectionTerm& term) const {
    std::vector<size_t> found;
    for (size_t i = 0; i < objects_.size(); ++i) {
      const Instance& o = objects_[i];
      const bool fits =
          term.group != ClassGroup::kNone ? is_of_group(objects_.labels(), o.label, term.group) : o.label == term.label;
      if (term.group == ClassGroup::kThings && is_fixture(objects_.labels(), o.label)) continue;
      if (fits && (term.instance == 0 || term.instance == o.number)) found.push_back(i);
    }
    if (found.empty()) {
      SelectionTerm name = without_place(term);
      name.choice = ObjectChoice::kNone;
      throw_bad_input({}, "--select", "the room has no object that is \"" + words(name) + "\"",
                      held_instead(all_objects(), {term}, objects_.labels()));
    }
    return found;
  }

  std::vector<size_t> objects_of(const SelectionTerm& term) const {
    std::vector<size_t> found = candidates_of(term);
    if (term.narrow != NarrowPlace::kNone) found = of_narrow_name(objects_, relations_, found, term.narrow);
    std::vector<Related> related;
    if (term.relation && term.relation->also) found = in_first_place(term, found);
    if (term.relation) {
      const Anchors anchors = anchors_of(*term.relation);
      related = related_of(term, found, anchors);
      if (term.count != 1) require_one_anchor(term, related, anchors.objects);
      found.clear();
      for (const Related& r : related) found.push_back(r.object);
    }
    if (!term.color.empty()) {
      found = of_color(objects_, found, term, words(term));
      std::erase_if(related, [&](const Related& r) { return std::count(found.begin(), found.end(), r.object) == 0; });
    }
    if (term.among > 0 && found.size() != static_cast<size_t>(term.among)) refuse_count(term, found);
    if (term.relation && is_in_order(term.relation->relation) && !term.relation->negated)
      return in_order_of(term, std::move(related));
    if (term.choice != ObjectChoice::kNone) return chosen_of(term, found);
    if (term.count == 1 && term.relation && is_distance(term.relation->relation))
      return {clearly_nearest(objects_, std::move(related), words(term))};
    if (term.count > 0 && found.size() != static_cast<size_t>(term.count)) refuse_count(term, found);
    return found;
  }

  /// "On the wall above the bed": those of the candidates that are on the wall.
  std::vector<size_t> in_first_place(const SelectionTerm& term, const std::vector<size_t>& candidates) const {
    SelectionTerm first = term;
    first.relation = term.relation->also;
    std::vector<size_t> found;
    for (const Related& r : related_of(first, candidates, anchors_of(*first.relation))) found.push_back(r.object);
    return found;
  }

  /// "The two lamps nearest to the bed", "the second chair farthest from the door".
  std::vector<size_t> in_order_of(const SelectionTerm& term, std::vector<Related> related) const {
    if (term.count == 0) {
      throw_bad_input({}, "--select", "\"" + words(term) + "\" does not tell how many are meant",
                      "say \"the two\" before it, or name one of them");
    }
    const auto count = static_cast<size_t>(term.count), rank = static_cast<size_t>(term.rank);
    if (std::max(count, rank) > related.size()) {
      std::vector<size_t> found;
      for (const Related& r : related) found.push_back(r.object);
      refuse_count(term, found);
    }
    return first_in_order(objects_, std::move(related), term.relation->relation, count, rank, words(term));
  }

  std::vector<size_t> chosen_of(const SelectionTerm& term, const std::vector<size_t>& found) const {
    const size_t count = static_cast<size_t>(term.count);
    if (count <= 1) return {chosen_object(objects_, found, term.choice, words(term), static_cast<size_t>(term.rank))};
    if (count > found.size()) refuse_count(term, found);
    return count == found.size() ? found : chosen_objects(objects_, found, term.choice, count, words(term));
  }

  std::vector<size_t> all_of(const std::vector<SelectionTerm>& terms) const {
    std::set<size_t> found;
    for (const SelectionTerm& term : terms) {
      const std::vector<size_t> some = objects_of(term);
      found.insert(some.begin(), some.end());
    }
    return {found.begin(), found.end()};
  }

  Anchors anchors_of(const RelatedTo& place) const {
    if (is_of_room(place.relation)) return {};
    Anchors anchors{all_of(place.anchors), {}};
    if (place.relation == Relation::kFarthest && !place.any_anchor && anchors.objects.size() > 1 &&
        !hang_together(objects_, {anchors.objects.begin(), anchors.objects.end()}, anchors.objects)) {
      throw_bad_input({}, "--select", "\"farthest from\" may mean any of these: " + objects_.names(anchors.objects),
                      did_you_mean(objects_, anchors.objects) + "Name one by its number");
    }
    if (place.relation != Relation::kBetween) return anchors;
    anchors.other_side = place.other_side.empty() ? anchors.objects : all_of(place.other_side);
    if (anchors.objects == anchors.other_side && anchors.objects.size() == 1)
      throw_bad_input({}, "--select", "nothing is between " + objects_.name(anchors.objects[0]) + " and itself",
                      "name two things");
    return anchors;
  }

  /// The gap where an object has the relation to an anchor.
  std::optional<double> gap_where(size_t object, Relation relation, size_t anchor, const Anchors& anchors) const {
    if (relation == Relation::kInCorner) return places_.gap_to_corner(object);
    if (relation == Relation::kRoomMiddle) return places_.gap_to_middle(object);
    if (relation != Relation::kBetween) return relations_.gap_where(object, relation, anchor);
    std::optional<double> least;
    for (const size_t other : anchors.other_side) {
      const std::optional<double> gap = relations_.gap_between(object, anchor, other);
      if (gap && (!least || *gap < *least)) least = gap;
    }
    return least;
  }

  /// The candidates that have the relation to any anchor, each with the nearest one.
  std::vector<Related> related_of(const SelectionTerm& term, const std::vector<size_t>& candidates,
                                  const Anchors& anchors) const {
    std::vector<Related> found;
    for (const size_t i : candidates) {
      std::vector<Related> fits;
      const bool of_room = is_of_room(term.relation->relation);
      for (const size_t anchor : of_room ? std::vector<size_t>{i} : anchors.objects) {
        if (const auto gap = gap_where(i, term.relation->relation, anchor, anchors)) fits.push_back({i, anchor, *gap});
      }
      const auto nearest =
          std::min_element(fits.begin(), fits.end(), [](const Related& a, const Related& b) { return a.gap < b.gap; });
      if (term.relation->negated) {
        if (nearest == fits.end()) found.push_back({i, i, 0});
      } else if (nearest != fits.end()) {
        found.push_back(*nearest);
      }
    }
    if (found.empty()) refuse_all(term, candidates, anchors);
    return found;
  }

  /// Nothing fits: says where the candidates are, and which other things are there.
  [[noreturn]] void refuse_all(const SelectionTerm& term, const std::vector<size_t>& candidates,
                               const Anchors& anchors) const {
    std::vector<size_t> others;
    for (size_t i = 0; i < objects_.size(); ++i) {
      const bool is_thing = is_of_group(objects_.labels(), objects_[i].label, ClassGroup::kThings);
      const auto fits = [&](size_t anchor) {
        return gap_where(i, term.relation->relation, anchor, anchors).has_value();
      };
      if (is_thing && !term.relation->negated && !is_in_order(term.relation->relation) &&
          std::any_of(anchors.objects.begin(), anchors.objects.end(), fits))
        others.push_back(i);
    }
    constexpr size_t kShownPlaces = 4;
    std::string remedy;
    if (!others.empty()) remedy = "it fits: " + objects_.names(others) + ". ";
    for (size_t k = 0; k < candidates.size() && k < kShownPlaces; ++k) {
      const Related near = nearest_anchor(candidates[k], anchors.objects);
      remedy += (k ? ", " : "The room has ") + objects_.name(candidates[k]);
      if (near.object != near.anchor)
        remedy += fmt::format(" ({:.1f} m from {})", near.gap, objects_.name(near.anchor));
    }
    throw_bad_input({}, "--select", "no object is \"" + words(term) + "\"", remedy);
  }

  Related nearest_anchor(size_t object, const std::vector<size_t>& anchors) const {
    Related nearest{object, object, 1e30};
    for (const size_t anchor : anchors) {
      if (anchor == object) continue;
      const double gap = objects_.gap(object, anchor);
      if (gap < nearest.gap) nearest = {object, anchor, gap};
    }
    return nearest;
  }

  /// "The pillows on the bed" are on one bed, which may be in pieces.
  void require_one_anchor(const SelectionTerm& term, const std::vector<Related>& related,
                          const std::vector<size_t>& anchors) const {
    std::set<size_t> used;
    for (const Related& r : related) used.insert(r.anchor);
    const bool is_shell = !is_of_group(objects_.labels(), objects_[*used.begin()].label, ClassGroup::kThings);
    const bool any = term.relation->any_anchor || term.relation->negated || is_of_room(term.relation->relation) ||
                     is_in_order(term.relation->relation);
    if (used.size() == 1 || any || is_shell || hang_together(objects_, used, anchors)) return;
    std::string where;
    for (const Related& r : related)
      where += (where.empty() ? "" : ", ") + objects_.name(r.object) + " by " + objects_.name(r.anchor);
    const std::string relation(relation_word(term.relation->relation)), &anchor = class_name(*used.begin());
    throw_bad_input(
        {}, "--select", "\"" + words(term) + "\" does not tell which of these is meant: " + where,
        "say \"" + relation + " " + objects_.name(*used.begin()) + "\", or \"" + relation + " any " + anchor + "\"");
  }

  [[noreturn]] void refuse_count(const SelectionTerm& term, const std::vector<size_t>& found) const {
    throw_bad_input({}, "--select",
                    fmt::format("\"{}\" means {} of them, and {} fit{}: {}", words(term),
                                term.count == 1 ? "one" : std::to_string(term.count), found.size(),
                                found.size() == 1 ? "s" : "", objects_.names(found)),
                    did_you_mean(objects_, found) + "Name them by their numbers, or say \"all\" before it");
  }

  const RoomObjects& objects_;
  ObjectRelations relations_;
  RoomPlaces places_;
};

void find_meant(std::vector<SelectionTerm>& terms, const MeantObjects& meant) {
  std::vector<SelectionTerm> out;
  for (const SelectionTerm& term : terms) {
    const std::vector<SelectionTerm> some =
        term.asks_objects() ? meant.terms_of(term) : std::vector<SelectionTerm>{term};
    out.insert(out.end(), some.begin(), some.end());
  }
  sort_terms(out);
  terms = std::move(out);
}

}  // namespace

bool asks_objects(const SelectionQuery& query) {
  const auto asks = [](const SelectionTerm& term) { return term.asks_objects(); };
  return std::any_of(query.include.begin(), query.include.end(), asks) ||
         std::any_of(query.exclude.begin(), query.exclude.end(), asks);
}

SelectionQuery with_numbers(SelectionQuery query, const RoomObjects& objects) {
  const MeantObjects meant(objects);
  find_meant(query.include, meant);
  find_meant(query.exclude, meant);
  return query;
}

}  // namespace aligngs
