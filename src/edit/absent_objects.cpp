#include "edit/absent_objects.h"

#include <algorithm>
#include <map>

#include "edit/object_names.h"
#include "edit/relation/class_kin.h"

namespace aligngs {
namespace {

bool is_absent(const SelectionTerm& term, const std::vector<Instance>& objects) {
  return term.label >= 0 && std::none_of(objects.begin(), objects.end(), [&](const Instance& o) {
           return o.label == term.label && (term.instance == 0 || term.instance == o.number);
         });
}

}  // namespace

std::vector<std::string> absent_names(const std::vector<Instance>& objects, const SelectionQuery& query,
                                      const LabelSet& labels) {
  std::map<int, SelectionQuery> absent;  // by class: "bed#4-9" is one name
  for (const auto* terms : {&query.include, &query.exclude}) {
    for (const SelectionTerm& term : *terms) {
      if (!is_absent(term, objects)) continue;
      SelectionTerm name;
      name.label = term.label;
      name.instance = term.instance;
      absent[term.label].include.push_back(name);
    }
  }
  std::vector<std::string> names;
  for (auto& [label, terms] : absent) {
    sort_terms(terms.include);
    names.push_back(selection_text(terms, labels));
  }
  return names;
}

std::string held_instead(const std::vector<Instance>& objects, const std::vector<SelectionTerm>& wanted,
                         const LabelSet& labels) {
  if (objects.empty()) return "it holds nothing that has a name";
  const auto is_wanted = [&](const auto& fits) {
    std::vector<Instance> found;
    for (const Instance& o : objects) {
      if (std::any_of(wanted.begin(), wanted.end(), [&](const SelectionTerm& t) { return fits(t.label, o.label); }))
        found.push_back(o);
    }
    return found;
  };
  std::vector<Instance> shown = is_wanted([](int label, int held) { return label == held; });
  if (shown.empty()) shown = is_wanted([&](int label, int held) { return are_kin(labels, label, held); });
  if (shown.empty()) shown = objects;
  return "it holds " + first_objects_text(shown, labels) + "; `aligngs edit RUN --list` shows all objects";
}

}  // namespace aligngs
