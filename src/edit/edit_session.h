// Edits of a run: the stack in edits.json, what it makes of the room, and the files that show it. The command line and
// the page call the same functions.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "edit/apply_edit.h"
#include "edit/edit_text.h"
#include "engine/engine.h"
#include "train/checkpoint.h"
#include "train/config.h"
#include "train/run_record.h"

namespace aligngs {

struct EditSessionOptions {
  std::filesystem::path scene;  ///< where the scene went, when it is not where run.json says; may be empty
  int threads = 0;
  double patience = 60;  ///< seconds that a change waits for another one of the same run (edit_lock.h)
};

/// Before on the left, after on the right, of the view that shows the difference best.
struct BeforeAfter {
  std::string view;
  Image<uint8_t> picture;
};

class EditSession {
 public:
  /// Opens a run and applies its stack. Error{kBadInput} when the folder is no run, nothing has been trained, or edits.json is damaged.
  EditSession(const std::filesystem::path& run, const EditSessionOptions& options);

  const std::vector<EditOperation>& stack() const { return stack_; }
  const EditableRoom& original() const { return original_; }  ///< as trained
  const EditableRoom& room() const { return room_; }          ///< with the stack applied
  std::vector<Instance> objects() const;                      ///< of room()
  ThreadPool& pool() { return *pool_; }
  const Scene& scene() const { return scene_; }
  const std::filesystem::path& folder() const { return run_; }

  /// Preview of an edit in figures and as a picture; nothing is written.
  EditReport preview(const EditOperation& edit, BeforeAfter* picture = nullptr);
  /// Applies an edit and writes edits.json and edits/ (scene.ply, scene.labels.ply, classes.json, mesh.ply,
  /// before_after.png; for an extraction also object/). Nothing of the training is touched. Changes of one run happen
  /// one after the other (edit_lock.h), each on top of those that other processes made meanwhile.
  EditReport push(const EditOperation& edit);
  /// Takes an edit back and returns what it was: the latest one, or that of a number, where 1 is the oldest. The edits
  /// after it stay. Error{kUsage} when there is none, Error{kBadInput} when a later edit needs it; nothing changes then.
  EditOperation undo(size_t number = 0);
  /// Reads a sentence (edit_text.h). Error{kUsage} with the three nearest readings for what this room does not understand.
  EditRequest understand(std::string_view text) const;
  /// Writes the room with the stack and one more edit as a run of its own, and returns what the edit did. `out` must
  /// be absent or an empty folder (Error{kUsage}); it appears complete or not at all.
  EditReport write_run(const std::filesystem::path& out, const EditOperation& edit, const std::string& command_line);

 private:
  void replay();
  void follow_file();  ///< takes over edits that were made since the stack was read; under the lock
  void write_products(const BeforeAfter& picture, const EditOperation* last) const;
  BeforeAfter compare(const EditableRoom& before, const EditableRoom& after) const;
  TrainingState edited_state(const EditableRoom& room) const;

  std::filesystem::path run_;
  TrainConfig config_;
  RunRecord record_;
  Scene scene_;
  TrainingState state_;  ///< of the last checkpoint
  std::unique_ptr<ThreadPool> pool_;
  int threads_ = 0;
  double patience_ = 0;  ///< seconds
  EditableRoom original_, room_;
  std::vector<EditOperation> stack_;
};

/// Gaussians, labels and mesh of a room moved so that the middle of their box is the origin; for a single object.
EditableRoom centred(const EditableRoom& room);

}  // namespace aligngs
