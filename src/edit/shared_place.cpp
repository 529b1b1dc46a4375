#include "edit/shared_place.h"

#include <algorithm>

#include "core/error.h"

namespace aligngs {
namespace {

template <class Fits>
bool any_anchor(const RelatedTo& place, const Fits& fits) {
  return std::any_of(place.anchors.begin(), place.anchors.end(),
                     [&](const SelectionTerm& anchor) { return anchor.label >= 0 && fits(anchor.label); });
}

/// A bed is on a floor or a rug, and on no table and no wall.
bool may_rest(int label, const RelatedTo& place, const LabelSet& labels) {
  if (place.also && !may_rest(label, *place.also, labels)) return false;
  const bool rests = place.relation == Relation::kOn || place.relation == Relation::kIn;
  return !rests || !is_heavy(labels, label) ||
         any_anchor(place, [&](int anchor) { return anchor == labels.find("floor") || anchor == labels.find("rug"); });
}

/// Whether a thing without a place may be in that of another one after "and". "The desk and the lamp on the desk" are
/// clear.
bool may_share_place(const SelectionTerm& bare, const SelectionTerm& placed, const LabelSet& labels) {
  if (bare.instance > 0 || !bare.named.empty() || placed.group == ClassGroup::kThings) return false;
  const RelatedTo& place = *placed.relation;
  if (place.relation == Relation::kBetween || place.relation == Relation::kHolding) return false;
  if (bare.label < 0) return true;
  if (!is_of_group(labels, bare.label, ClassGroup::kThings)) return false;
  return !any_anchor(place, [&](int anchor) { return anchor == bare.label; }) && may_rest(bare.label, place, labels);
}

}  // namespace

void require_own_place(const std::vector<BareName>& bare, const RelatedItem& after,
                       const std::vector<SelectionTerm>& terms, size_t placed, const LabelSet& labels) {
  if (placed >= terms.size() || !terms[placed].relation) return;
  if (std::none_of(bare.begin(), bare.end(),
                   [&](const BareName& b) { return may_share_place(terms[b.term], terms[placed], labels); }))
    return;
  const std::string where = (after.negated ? " not " : " ") + std::string(after.place);
  const std::string last = std::string(after.target) + where;
  std::string whole, apart, together;
  for (const BareName& b : bare) {
    whole += b.text + " and ";
    apart += b.text + ", ";
    together += b.text + where + ", ";
  }
  throw_usage("\"" + whole + last + "\" has two readings",
              "did you mean \"" + apart + last + "\" or \"" + together + last + "\"?");
}

}  // namespace aligngs
