// Edits of a run: the list in edits.json, what each did to the room, and how both change. The command line and the page
// call the same functions.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "edit/apply_edit.h"
#include "edit/edit_change.h"
#include "edit/edit_text.h"
#include "engine/engine.h"
#include "train/checkpoint.h"
#include "train/opened_run.h"

namespace aligngs {

struct EditSessionOptions {
  std::filesystem::path scene;  ///< where the scene went, when it is not where run.json says; may be empty
  int threads = 0;
  double patience = 60;   ///< seconds that a change waits for another one of the same run (edit_lock.h)
  bool one_edit = false;  ///< the session ends after one push(): room() is not made anew then
};

/// Before on the left, after on the right, of the view that shows the difference best.
struct BeforeAfter {
  std::string view;
  Image<uint8_t> picture;
};

class EditSession {
 public:
  /// Opens a run and applies what its edits did. An edit whose change is not there, or was made on another training of
  /// the run, is carried out again by its words. Error{kBadInput} when the folder is no run, nothing has been trained,
  /// or edits.json is damaged.
  EditSession(const std::filesystem::path& run, const EditSessionOptions& options);
  /// Edits of a run that is open, with its cameras placed. options.scene has no part in it.
  EditSession(SharedRun run, const EditSessionOptions& options);

  const std::vector<EditOperation>& stack() const { return stack_; }
  const EditableRoom& original() const { return original_; }  ///< as trained
  /// With the stack applied; original() itself where there are no edits.
  const EditableRoom& room() const { return edited_ ? *edited_ : original_; }
  std::vector<Instance> objects() const;  ///< of room()
  ThreadPool& pool() { return *pool_; }
  const Scene& scene() const { return run_->scene; }
  const std::filesystem::path& folder() const { return run_->folder; }

  /// Preview of an edit in figures and as a picture; nothing is written.
  EditReport preview(const EditOperation& edit, BeforeAfter* picture = nullptr);
  /// Applies an edit, writes what it did into edits/, and then its entry into edits.json. Nothing of the training is
  /// touched.
  /// Changes of one run happen one after the other (edit_lock.h), each on top of those that other processes made
  /// meanwhile.
  EditReport push(const EditOperation& edit, BeforeAfter* picture = nullptr);
  /// Takes an edit back and returns what it was: the latest one, or that of a number, where 1 is the oldest. The edits
  /// after it stay. Those that follow from it are carried out again (edit_independence.h). Error{kUsage} when there is
  /// none, Error{kBadInput} when a later edit needs it; nothing changes then.
  EditOperation undo(size_t number = 0);
  /// Takes the latest edits back, and returns what they were, the latest first. Errors as take_latest's
  /// (edit_log.h).
  std::vector<EditOperation> undo_latest(size_t count);
  /// Selections that were drawn by hand, as RUN/selections.json has them now.
  const RoomSelections& selections();
  /// Keeps a selection under a name; `rows` has one flag per Gaussian of original(). Errors as add_selection's
  /// (named_selection_log.h).
  void save_selection(const std::string& name, const std::vector<uint8_t>& rows);
  void rename_selection(const std::string& name, const std::string& to);
  void remove_selection(const std::string& name);
  /// Reads a sentence (edit_text.h). Error{kUsage} with the three nearest readings for what this room does not
  /// understand.
  EditRequest understand(std::string_view text) const;
  /// As room.json or the scene has it now (length_unit_of).
  LengthUnit length_unit() const { return length_unit_of(folder(), scene()); }
  /// Writes the room with the stack and one more edit as a run of its own, and returns what the edit did. `out` must
  /// be absent or an empty folder (Error{kUsage}); it appears complete or not at all. Error{kBadInput} for a run
  /// without checkpoints: the new run could not be rendered.
  EditReport write_run(const std::filesystem::path& out, const EditOperation& edit, const std::string& command_line);

 private:
  using Changes = std::vector<std::shared_ptr<const EditChange>>;  ///< of the edits of a stack
  /// Applies a stack to the trained room. `changes` are those of its first edits; the others are read, or found anew.
  /// Edits that are carried out again lose the name of their file. Nothing for an empty stack.
  std::optional<EditableRoom> rebuilt(std::vector<EditOperation>& stack, Changes& changes);
  /// From the file of an edit; null where there is none that was made on this room.
  std::shared_ptr<const EditChange> stored_change(const EditOperation& edit) const;
  /// The object in the file of a replacement, also of one that was made on another training; null for other edits.
  std::shared_ptr<const InsertedObject> stored_object(const EditOperation& edit) const;
  EditReport carry_out(EditableRoom& room, const EditOperation& edit);
  void follow_file();  ///< takes over edits that were made since the stack was read; under the lock
  void follow_selections();
  /// Writes changes that no file has, and the list.
  void commit(std::vector<EditOperation>& stack, const Changes& changes);
  /// Commits a shorter stack, with the room that it makes.
  void replace_stack(std::vector<EditOperation> stack, Changes changes);
  void replace_stack(std::vector<EditOperation> stack, Changes changes, std::optional<EditableRoom> edited);
  /// The last checkpoint. It is larger than the room and is not kept.
  TrainingState read_state() const;
  BeforeAfter compare(const EditableRoom& before, const EditableRoom& after) const;
  static TrainingState edited_state(TrainingState trained, const EditableRoom& room);

  SharedRun run_;
  int threads_ = 0;
  double patience_ = 0;  ///< seconds
  bool one_edit_ = false;
  std::unique_ptr<ThreadPool> pool_;
  EditableRoom original_;
  std::optional<EditableRoom> edited_;  ///< one room is held where there are no edits
  uint64_t base_ = 0;                   ///< digest of original_
  std::vector<EditOperation> stack_;
  std::string listed_;  ///< content of edits.json that stack_ was read from or written to
  Changes changes_;
  std::string listed_selections_;  ///< content of selections.json that was read
  SoftLabels soft_;                ///< of the rows of original_, when a threshold needed them
};

/// Gaussians, labels and mesh of a room moved so that the middle of their box is the origin; for a single object.
EditableRoom centred(const EditableRoom& room);

}  // namespace aligngs
