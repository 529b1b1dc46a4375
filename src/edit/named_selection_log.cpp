#include "edit/named_selection_log.h"

#include <algorithm>

#include "core/error.h"
#include "edit/edit_lock.h"
#include "edit/edit_operation.h"
#include "edit/edit_text.h"
#include "edit/selection_text.h"
#include "edit/vocabulary.h"
#include "io/atomic_file.h"
#include "train/opened_run.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

Vocabulary vocabulary_with(const LabelSet& labels, const std::vector<NamedSelection>& known) {
  Vocabulary vocabulary(labels);
  for (const NamedSelection& s : known) vocabulary.add_selection(s.name);
  return vocabulary;
}

/// Whether a text is that one selection and nothing else.
bool means_selection(const std::string& text, const std::string& name, const Vocabulary& vocabulary) {
  try {
    const SelectionQuery query = parse_selection(text, vocabulary);
    return !query.everything && query.exclude.empty() && query.include.size() == 1 &&
           query.include.front().named == name;
  } catch (const Error&) {
    return false;
  }
}

/// Whether edits read all of the name as what they select.
bool is_whole_in_edits(const std::string& name) {
  for (const std::string& edit : {"delete " + name, "duplicate " + name, "highlight " + name,
                                  "recolor " + name + " red", "move " + name + " by 1,0,0"}) {
    try {
      if (parse_edit(edit).select != name) return false;
    } catch (const Error&) {
      return false;
    }
  }
  return true;
}

std::vector<NamedSelection>::iterator selection_called(std::vector<NamedSelection>& list, const std::string& name) {
  const auto it = std::find_if(list.begin(), list.end(), [&](const NamedSelection& s) { return s.is_called(name); });
  if (it == list.end())
    throw_usage("there is no selection \"" + name.substr(0, 64) + "\"", "`aligngs edit RUN --list` shows them");
  return it;
}

bool speaks_of(const std::string& text, const std::string& name, const Vocabulary& vocabulary) {
  const auto named = [&](const SelectionTerm& term) { return term.named == name; };
  try {
    const SelectionQuery query = parse_selection(text, vocabulary);
    return std::any_of(query.include.begin(), query.include.end(), named) ||
           std::any_of(query.exclude.begin(), query.exclude.end(), named);
  } catch (const Error&) {
    return false;  // it speaks of another selection, which somebody took out of the file
  }
}

/// An edit may be carried out again by its words: the name must then mean what it meant.
void require_unused(const fs::path& run, const std::string& name, const LabelSet& labels,
                    const std::vector<NamedSelection>& known) {
  const Vocabulary vocabulary = vocabulary_with(labels, known);
  for (const EditOperation& edit : read_edits(run / "edits.json")) {
    if (!speaks_of(edit.select, name, vocabulary)) continue;
    throw_usage("the edit \"" + describe(edit) + "\" speaks of the selection \"" + name + "\"",
                "undo that edit first, or keep the selection");
  }
}

void write_selections(const fs::path& run, const std::vector<NamedSelection>& list) {
  write_file_atomically(named_selections_file(run), named_selections_text(list));
}

}  // namespace

void require_free_name(const std::string& name, const LabelSet& labels, const std::vector<NamedSelection>& known) {
  for (const NamedSelection& s : known) {
    if (s.is_called(name))
      throw_usage("there is a selection \"" + s.name + "\" already", "choose another name, or remove that one");
  }
  const Vocabulary classes(labels);
  bool is_known = true;
  try {
    parse_selection(name, classes);
  } catch (const Error&) {
    is_known = false;
  }
  if (is_known)
    throw_usage("\"" + name + "\" means objects of the room already", "choose a name that is no class or object");
  Vocabulary with_name(labels);
  with_name.add_selection(name);
  if (!means_selection(name, name, with_name) || !is_whole_in_edits(name)) {
    throw_usage("\"" + name + "\" has words that an edit reads as something else",
                "leave out colours, distances and words such as and, but, with, to, by");
  }
}

void add_selection(const fs::path& run, const NamedSelection& selection, const LabelSet& labels, double patience) {
  require_run_folder(run);
  NamedSelection made = selection;
  made.name = selection_name(selection.name);
  if (made.ranges.empty()) throw_usage("nothing is selected", "draw around something first");
  const EditLock lock(run, "save the selection " + made.name, patience);
  std::vector<NamedSelection> list = read_named_selections(named_selections_file(run));
  require_free_name(made.name, labels, list);
  if (list.size() >= kMostNamedSelections) throw_usage("the run has 256 selections already", "remove one first");
  list.push_back(std::move(made));
  write_selections(run, list);
}

void rename_selection(const fs::path& run, const std::string& name, const std::string& to, const LabelSet& labels,
                      double patience) {
  require_run_folder(run);
  const std::string wanted = selection_name(to);
  const EditLock lock(run, "rename the selection " + name, patience);
  std::vector<NamedSelection> list = read_named_selections(named_selections_file(run));
  const auto it = selection_called(list, name);
  require_unused(run, it->name, labels, list);
  std::vector<NamedSelection> others = list;
  others.erase(others.begin() + (it - list.begin()));
  require_free_name(wanted, labels, others);
  it->name = wanted;
  write_selections(run, list);
}

void remove_selection(const fs::path& run, const std::string& name, const LabelSet& labels, double patience) {
  require_run_folder(run);
  const EditLock lock(run, "remove the selection " + name, patience);
  std::vector<NamedSelection> list = read_named_selections(named_selections_file(run));
  const auto it = selection_called(list, name);
  require_unused(run, it->name, labels, list);
  list.erase(it);
  if (list.empty())
    fs::remove(named_selections_file(run));
  else
    write_selections(run, list);
}

}  // namespace aligngs
