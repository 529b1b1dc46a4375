#include "edit/edit_session.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "edit/edit_lock.h"
#include "edit/edit_products.h"
#include "edit/nearest_readings.h"
#include "edit/room_up.h"
#include "gaussians/restructure.h"
#include "io/atomic_file.h"
#include "io/folder_replacement.h"
#include "scene/mesh_ply.h"
#include "train/camera_outputs.h"
#include "train/run_folder.h"
#include "train/trained_run.h"
#include "train/training_set.h"

namespace aligngs {

namespace fs = std::filesystem;

EditSession::EditSession(const fs::path& run, const EditSessionOptions& options)
    : run_(run), threads_(options.threads), patience_(options.patience) {
  TrainedRun trained = read_trained_run(run, options.scene, CheckpointParts::kAll);
  record_ = std::move(trained.record);
  config_ = std::move(trained.config);
  scene_ = std::move(trained.scene);
  state_ = std::move(trained.state);
  stack_ = read_edits(run / "edits.json");
  pool_ = std::make_unique<ThreadPool>(options.threads);

  original_.labels = scene_.labels;
  original_.gaussians = label_objects(state_.engine.model, scene_.labels, robust_extent(scene_), *pool_);
  original_.up = up_of_room(scene_, original_.gaussians);
  for (const int view : scene_.train) original_.cameras.push_back(working_camera(scene_, config_, view));
  for (uint32_t i = 0; i < original_.gaussians.model.size(); ++i) original_.origins.push_back({i, false});
  if (fs::exists(run / "mesh" / "mesh.ply")) original_.mesh = read_mesh_ply(run / "mesh" / "mesh.ply");
  replay();
}

std::vector<Instance> EditSession::objects() const {
  return list_instances(room_.gaussians.model, room_.gaussians.labels);
}

void EditSession::replay() {
  room_ = original_;
  for (size_t i = 0; i < stack_.size(); ++i) {
    try {
      apply_edit(room_, stack_[i], *pool_);
    } catch (const Error& error) {
      throw_bad_input(run_ / "edits.json", "edits[" + std::to_string(i) + "]", error.details().message,
                      "remove this entry, or edits.json to forget all edits");
    }
  }
}

void EditSession::follow_file() {
  std::vector<EditOperation> now = read_edits(run_ / "edits.json");
  if (edits_text(now) == edits_text(stack_)) return;
  stack_ = std::move(now);
  replay();
}

EditReport EditSession::preview(const EditOperation& edit, BeforeAfter* picture) {
  EditableRoom after = room_;
  const EditReport report = apply_edit(after, edit, *pool_);
  if (picture) *picture = compare(room_, after);
  return report;
}

EditReport EditSession::push(const EditOperation& edit) {
  const EditLock lock(run_, describe(edit), patience_);
  follow_file();
  EditOperation canonical = edit;
  canonical.select = selection_text(read_selection(room_, edit.select), room_.labels);
  EditableRoom before = room_;
  const EditReport report = apply_edit(room_, canonical, *pool_);
  stack_.push_back(canonical);
  try {
    write_products(compare(before, room_), &canonical);
  } catch (...) {
    stack_.pop_back();
    room_ = std::move(before);
    throw;
  }
  return report;
}

EditRequest EditSession::understand(std::string_view text) const {
  try {
    const EditRequest request = parse_request(text);
    if (!request.undo) parse_selection(request.edit.select, vocabulary_of(room_));
    return request;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kUsage) throw;
    throw with_readings(error, text, vocabulary_of(room_));
  }
}

EditOperation EditSession::undo(size_t number) {
  const EditLock lock(run_, "undo", patience_);
  follow_file();
  if (stack_.empty()) throw_usage("there is no edit to undo", "`aligngs edit RUN --list` shows the edits of a run");
  if (number > stack_.size()) {
    throw_usage(fmt::format("there is no edit {} to undo: the run has {}", number, stack_.size()),
                "`aligngs edit RUN --list` shows the edits of a run, the first one first");
  }
  const std::vector<EditOperation> stack = stack_;
  const size_t index = (number == 0 ? stack_.size() : number) - 1;
  const EditOperation undone = stack_[index];
  EditableRoom before = std::move(room_);
  try {
    stack_.erase(stack_.begin() + static_cast<std::ptrdiff_t>(index));
    replay();
    // Without edits there is no folder for a picture, whose views take seconds to draw.
    write_products(stack_.empty() ? BeforeAfter() : compare(before, room_), stack_.empty() ? nullptr : &stack_.back());
  } catch (...) {
    stack_ = stack;
    room_ = std::move(before);
    throw;
  }
  return undone;
}

void EditSession::write_products(const BeforeAfter& picture, const EditOperation* last) const {
  const std::string list = edits_text(stack_);
  const fs::path folder = run_ / "edits";
  if (stack_.empty()) {
    write_file_atomically(run_ / "edits.json", list);
    std::error_code error;
    fs::remove_all(folder, error);
    return;
  }
  FolderReplacement replacement(folder);
  write_room(replacement.path(), room_);
  if (!picture.picture.empty()) write_before_after(replacement.path() / "before_after.png", picture);
  if (last && last->kind == EditKind::kExtract) write_object(replacement.path() / "object", centred(room_), *pool_);
  write_file_atomically(replacement.path() / "edits.json", list);  // says to which stack these files belong
  replacement.commit();
  write_file_atomically(run_ / "edits.json", list);
}

TrainingState EditSession::edited_state(const EditableRoom& room) const {
  TrainingState state = state_;
  const size_t rows = state_.engine.model.size();
  RestructurePlan plan;
  for (const GaussianOrigin& origin : room.origins) {
    RowOrigin row;
    row.source = origin.row;
    row.kind = origin.filled ? RowOrigin::Kind::kClone : RowOrigin::Kind::kKeep;
    plan.rows.push_back(row);
  }
  for (auto& [name, values] : state.engine.arrays) {
    if (rows > 0 && !values.empty() && values.size() % rows == 0) restructure_rows(plan, values.size() / rows, values);
  }
  state.engine.model = room.gaussians.model;
  return state;
}

EditReport EditSession::write_run(const fs::path& out, const EditOperation& edit, const std::string& command_line) {
  require_new_folder(out, {run_, scene_.folder});
  EditableRoom after = room_;
  const EditReport report = apply_edit(after, edit, *pool_);
  std::vector<EditOperation> done = stack_;
  done.push_back(edit);

  FolderReplacement replacement(out);
  const RunFolder paths(replacement.path());
  write_file_atomically(paths.config(), read_file(RunFolder(run_).config()));
  const TrainingState state = edited_state(after);
  write_checkpoint(paths.checkpoints(), state, record_.fingerprint, 1);
  write_room(replacement.path(), after);
  write_camera_outputs(paths, scene_, config_);
  write_before_after(replacement.path() / "before_after.png", compare(room_, after));
  if (edit.kind == EditKind::kExtract) write_object(replacement.path() / "object", centred(after), *pool_);
  write_edited_record(paths.record(), record_, command_line, relative_scene_path(out, scene_.folder), run_, done,
                      after.gaussians.model.size());
  replacement.commit();
  return report;
}

}  // namespace aligngs
