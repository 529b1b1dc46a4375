// Changes of RUN/selections.json: one process at a time, as with edits.
#pragma once

#include <filesystem>
#include <string>

#include "edit/named_selection.h"
#include "scene/label_set.h"

namespace aligngs {

/// Error{kUsage} unless an edit can speak of `name`. It is then no class, no object, no other word of an edit, and no
/// selection of `known`.
void require_free_name(const std::string& name, const LabelSet& labels, const std::vector<NamedSelection>& known);

/// Each waits up to `patience` seconds for another edit of the run (edit_lock.h), reads the file, and writes it in one
/// step. Error{kUsage} for names that are taken or unknown, for an empty selection, and where an edit of the stack
/// speaks of the name. Errors of the files as parse_named_selections' and read_edits'.
void add_selection(const std::filesystem::path& run, const NamedSelection& selection, const LabelSet& labels,
                   double patience);
void rename_selection(const std::filesystem::path& run, const std::string& name, const std::string& to,
                      const LabelSet& labels, double patience);
void remove_selection(const std::filesystem::path& run, const std::string& name, const LabelSet& labels,
                      double patience);

}  // namespace aligngs
