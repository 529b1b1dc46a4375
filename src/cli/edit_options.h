// The options of `aligngs edit`, and the edit that they say.
#pragma once

#include <CLI/App.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edit/edit_operation.h"
#include "edit/edit_session.h"
#include "edit/undo_words.h"

namespace aligngs {

struct EditOptions {
  std::string run, scene, say, select, threshold = "argmax", recolor, highlight, move, turn, output, picture, truth,
                                       replace, up = "z", objects = "stored";
  double wait = EditSessionOptions().patience;  ///< seconds
  bool remove = false, extract = false, fill = false, with_contents = false, duplicate = false, fit = false;
  bool undo = false, list = false, dry_run = false, measure = false;
  std::string remove_selection;
  std::vector<std::string> rename_selection;  ///< old name, new name

  bool changes_selection() const { return !rename_selection.empty() || !remove_selection.empty(); }
  /// The options say a whole edit, without a sentence.
  bool is_edit() const { return !undo && !list && say.empty() && !changes_selection() && !measure && truth.empty(); }
};

std::shared_ptr<EditOptions> add_edit_options(CLI::App& command);

/// Error{kUsage} for options that exclude each other, or that say nothing to do.
void require_consistent(const EditOptions& options);

/// The edit of --delete, --recolor, ... Error{kUsage} unless it is exactly one, and for values that cannot be read.
EditOperation operation_of(const EditOptions& options);

/// The edits that --say "undo ..." takes back, which needs no room; empty for other sentences.
std::optional<UndoRequest> undo_in_words(const EditOptions& options);

}  // namespace aligngs
