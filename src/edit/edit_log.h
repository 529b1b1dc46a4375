// The edits of a run as files: the list in RUN/edits.json, and what each did in RUN/edits/.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "edit/edit_change.h"
#include "edit/edit_operation.h"

namespace aligngs {

/// Writes the list, whose changes have been written before: from here on the run has these edits. Then removes the
/// files in RUN/edits/ that the list does not name, which also takes the copies of the room that earlier programs kept
/// there.
void commit_edits(const std::filesystem::path& run, const std::vector<EditOperation>& edits);

/// Index of the edit that `number` means: 1 is the oldest, 0 the latest. Error{kUsage} when there is none.
size_t index_of_edit(const std::vector<EditOperation>& edits, size_t number);

/// Takes the latest edits off a list, and returns them, the latest first; all of them for UndoRequest::kAll.
/// Error{kUsage} when there are fewer.
std::vector<EditOperation> take_latest(std::vector<EditOperation>& edits, size_t count);

/// Takes the latest edits back without opening the run. Waits as EditLock does. Errors as take_latest's, and those of
/// the files.
std::vector<EditOperation> undo_latest_in_files(const std::filesystem::path& run, size_t count, double patience);

/// Takes an edit back without opening the run: its entry and its file go. Possible when the edits after it stay what
/// they are (edit_independence.h). Returns what it was, or nothing when the run must be opened for it
/// (EditSession::undo); nothing has changed then. Waits as EditLock does. Errors as index_of_edit's, and those of the
/// files.
std::optional<EditOperation> undo_in_files(const std::filesystem::path& run, size_t number, double patience);

}  // namespace aligngs
