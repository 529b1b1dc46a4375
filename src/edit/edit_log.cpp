#include "edit/edit_log.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "edit/edit_change_file.h"
#include "edit/edit_independence.h"
#include "edit/edit_lock.h"
#include "edit/undo_words.h"
#include "io/atomic_file.h"
#include "train/opened_run.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Files that a list does not name are of edits that were taken back, of a process that was killed, or of an earlier
/// program.
void remove_unnamed_files(const fs::path& folder, const std::vector<EditOperation>& edits) {
  std::error_code error;
  if (edits.empty()) {
    fs::remove_all(folder, error);
    return;
  }
  std::vector<fs::path> unnamed;
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
    const std::string name = i->path().filename().string();
    if (std::none_of(edits.begin(), edits.end(), [&](const EditOperation& e) { return e.change == name; }))
      unnamed.push_back(i->path());
  }
  for (const fs::path& path : unnamed) fs::remove_all(path, error);
}

/// Takes the files of edits that go off a full disk. Should the list still not be written, then these edits are carried
/// out again by their words. A replacement needs its file for that, and keeps it.
void make_room(const fs::path& run, std::vector<EditOperation> edits) {
  for (const EditOperation& edit : read_edits(run / "edits.json")) {
    if (edit.kind == EditKind::kReplace) edits.push_back(edit);
  }
  remove_unnamed_files(run / "edits", edits);
}

}  // namespace

void commit_edits(const fs::path& run, const std::vector<EditOperation>& edits) {
  const fs::path list = run / "edits.json";
  try {
    write_file_atomically(list, edits_text(edits));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kResources) throw;
    make_room(run, edits);
    write_file_atomically(list, edits_text(edits));
  }
  remove_unnamed_files(run / "edits", edits);
}

size_t index_of_edit(const std::vector<EditOperation>& edits, size_t number) {
  if (edits.empty()) throw_usage("there is no edit to undo", "`aligngs edit RUN --list` shows the edits of a run");
  if (number > edits.size()) {
    throw_usage(fmt::format("there is no edit {} to undo: the run has {}", number, edits.size()),
                "`aligngs edit RUN --list` shows the edits of a run, the first one first");
  }
  return (number == 0 ? edits.size() : number) - 1;
}

std::vector<EditOperation> take_latest(std::vector<EditOperation>& edits, size_t count) {
  if (edits.empty()) index_of_edit(edits, 0);  // throws
  if (count == UndoRequest::kAll) count = edits.size();
  if (count > edits.size()) {
    throw_usage(fmt::format("there are no {} edits to undo: the run has {}", count, edits.size()),
                "`aligngs edit RUN --list` shows them; \"undo everything\" takes all of them back");
  }
  std::vector<EditOperation> taken(edits.rbegin(), edits.rbegin() + static_cast<std::ptrdiff_t>(count));
  edits.resize(edits.size() - count);
  return taken;
}

std::vector<EditOperation> undo_latest_in_files(const fs::path& run, size_t count, double patience) {
  require_run_folder(run);
  const EditLock lock(run, "undo", patience);
  std::vector<EditOperation> edits = read_edits(run / "edits.json"), undone = take_latest(edits, count);
  commit_edits(run, edits);
  return undone;
}

std::optional<EditOperation> undo_in_files(const fs::path& run, size_t number, double patience) {
  require_run_folder(run);
  const EditLock lock(run, "undo", patience);
  std::vector<EditOperation> edits = read_edits(run / "edits.json");
  const size_t index = index_of_edit(edits, number);
  if (index + 1 < edits.size()) {
    const auto lacks_change = [](const EditOperation& e) { return e.change.empty(); };
    if (std::any_of(edits.begin() + static_cast<std::ptrdiff_t>(index), edits.end(), lacks_change)) return std::nullopt;
    try {
      const EditChange taken = read_change(run / "edits" / edits[index].change);
      for (size_t i = index + 1; i < edits.size(); ++i) {
        const EditChange later = read_change(run / "edits" / edits[i].change);
        if (later.base != taken.base || !is_independent(taken, later)) return std::nullopt;
      }
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kBadInput) throw;
      return std::nullopt;  // a damaged file: the session tells, and carries the edit out again
    }
  }
  const EditOperation undone = edits[index];
  edits.erase(edits.begin() + static_cast<std::ptrdiff_t>(index));
  commit_edits(run, edits);
  return undone;
}

}  // namespace aligngs
