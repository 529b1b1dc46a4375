#include "edit/edit_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/log.h"
#include "edit/edit_change_file.h"
#include "edit/edit_independence.h"
#include "edit/edit_lock.h"
#include "edit/edit_log.h"
#include "edit/edit_products.h"
#include "edit/inserted_object.h"
#include "edit/nearest_readings.h"
#include "edit/settled_motion.h"
#include "edit/trained_room.h"
#include "gaussians/object_labels.h"
#include "gaussians/restructure.h"
#include "io/atomic_file.h"
#include "io/folder_replacement.h"
#include "train/camera_outputs.h"
#include "train/run_folder.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// A later edit speaks of what the undone one made.
[[noreturn]] void refuse_undo(size_t number, size_t later, const EditOperation& needs_it) {
  throw_bad_input({}, "", fmt::format("edit {} (\"{}\") needs edit {}", later, describe(needs_it), number),
                  fmt::format("undo edit {} first: \"undo #{}\"", later, later));
}

}  // namespace

EditSession::EditSession(const fs::path& run, const EditSessionOptions& options)
    : EditSession(open_run_as_trained(run, options.scene), options) {}

EditSession::EditSession(SharedRun run, const EditSessionOptions& options)
    : run_(std::move(run)),
      threads_(options.threads),
      patience_(options.patience),
      one_edit_(options.one_edit),
      pool_(std::make_unique<ThreadPool>(options.threads)),
      original_(read_trained_room(*run_, *pool_)) {
  base_ = room_digest(original_);
  follow_selections();
  stack_ = read_edits(folder() / "edits.json");
  listed_ = edits_text(stack_);
  edited_ = rebuilt(stack_, changes_);
}

std::vector<Instance> EditSession::objects() const {
  return list_instances(room().gaussians.model, room().gaussians.labels);
}

TrainingState EditSession::read_state() const {
  std::optional<TrainingState> state =
      read_latest_checkpoint(RunFolder(folder()).checkpoints(), run_->record.fingerprint, CheckpointParts::kAll);
  if (!state) {
    throw_bad_input(RunFolder(folder()).checkpoints(), "",
                    "this run has no checkpoints: a probability as --threshold and a run of its own (-o) need one",
                    "leave out --threshold and -o, or put the checkpoints back");
  }
  if (state->engine.model.size() != original_.gaussians.model.size()) {
    throw_bad_input(RunFolder(folder()).checkpoints(), "", "the checkpoint is of another training than scene.ply",
                    "finish the training: aligngs train ... --resume");
  }
  return std::move(*state);
}

EditReport EditSession::carry_out(EditableRoom& room, const EditOperation& edit) {
  const bool places =
      edit.kind == EditKind::kMove || edit.kind == EditKind::kDuplicate || edit.kind == EditKind::kReplace;
  if (places) room.length_unit = length_unit();  // of their warnings
  const bool asks_probabilities = edit.threshold.kind != ThresholdRule::Kind::kArgmax && room.gaussians.has_labels();
  if (asks_probabilities && room.gaussians.soft.label.empty()) {
    if (soft_.label.empty()) soft_ = smoothed_labels(read_state().engine.model, original_.gaussians.extent, *pool_);
    SoftLabels& soft = room.gaussians.soft;
    for (const GaussianOrigin& origin : room.origins) {
      const auto row = static_cast<std::ptrdiff_t>(SoftLabels::kTop * origin.row),
                 width = static_cast<std::ptrdiff_t>(SoftLabels::kTop);
      soft.label.insert(soft.label.end(), soft_.label.begin() + row, soft_.label.begin() + row + width);
      soft.probability.insert(soft.probability.end(), soft_.probability.begin() + row,
                              soft_.probability.begin() + row + width);
    }
  }
  if (edit.kind != EditKind::kReplace || edit.object) return apply_edit(room, edit, *pool_);
  EditOperation whole = edit;
  whole.object = std::make_shared<const InsertedObject>(read_inserted_object(edit.with, edit.up_axis, *pool_));
  if (!edit.fit && whole.object->metric && *whole.object->metric != scene().metric) {
    throw_usage(scene().metric ? "this room is in metres, and the unit of the other run is not known"
                               : "the other run is in metres, and the unit of this room is not known",
                "scale the object to the place of the old one with --fit");
  }
  return apply_edit(room, whole, *pool_);
}

std::shared_ptr<const InsertedObject> EditSession::stored_object(const EditOperation& edit) const {
  const fs::path file = folder() / "edits" / edit.change;
  if (edit.kind != EditKind::kReplace || edit.change.empty() || !fs::exists(file)) return nullptr;
  try {
    return inserted_by(read_change(file), original_);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    return nullptr;  // said already: its source is read again
  }
}

std::shared_ptr<const EditChange> EditSession::stored_change(const EditOperation& edit) const {
  const fs::path file = folder() / "edits" / edit.change;
  if (edit.change.empty() || !fs::exists(file)) return nullptr;
  try {
    auto change = std::make_shared<const EditChange>(read_change(file));
    if (change->base == base_ && change->number == edit.number) return change;
    log_info("the room was trained again, or its mesh made again: \"{}\" is carried out again", describe(edit));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    log_warning("{}; \"{}\" is carried out again", error.what(), describe(edit));
  }
  return nullptr;
}

std::optional<EditableRoom> EditSession::rebuilt(std::vector<EditOperation>& stack, Changes& changes) {
  if (stack.empty()) return {};
  EditableRoom room = original_;
  bool anew = false;  // rows of later changes may be others from here on
  for (size_t i = 0; i < stack.size(); ++i) {
    if (i < changes.size()) {
      if (!apply_change(room, *changes[i]))
        throw_bad_input(folder() / "edits.json", "edits[" + std::to_string(i) + "]", "rows of this edit are gone",
                        "undo it");
      continue;
    }
    if (auto change = anew ? nullptr : stored_change(stack[i]); change && apply_change(room, *change)) {
      changes.push_back(std::move(change));
      continue;
    }
    anew = true;
    if (!stack[i].object) stack[i].object = stored_object(stack[i]);
    stack[i].change.clear();
    try {
      EditableRoom after = room;
      const EditReport report = carry_out(after, stack[i]);
      const uint32_t number = stack[i].number != 0 ? stack[i].number : changes.empty() ? 1 : changes.back()->number + 1;
      auto change = std::make_shared<const EditChange>(difference(room, after, stack[i], report, number, base_));
      apply_change(room, *change);
      changes.push_back(std::move(change));
    } catch (const Error& error) {
      throw_bad_input(folder() / "edits.json", "edits[" + std::to_string(i) + "]", error.details().message,
                      "remove this entry, or edits.json to forget all edits");
    }
  }
  return room;
}

void EditSession::follow_file() {
  follow_selections();
  std::vector<EditOperation> now = read_edits(folder() / "edits.json");
  std::string listed = edits_text(now);
  if (listed == listed_) return;
  Changes changes;
  edited_ = rebuilt(now, changes);
  stack_ = std::move(now);
  changes_ = std::move(changes);
  listed_ = std::move(listed);
}

void EditSession::commit(std::vector<EditOperation>& stack, const Changes& changes) {
  for (size_t i = 0; i < stack.size(); ++i) {
    if (!stack[i].change.empty() && fs::exists(folder() / "edits" / stack[i].change)) continue;
    stack[i].number = changes[i]->number;
    stack[i].change = write_change(folder() / "edits", *changes[i]);
  }
  commit_edits(folder(), stack);
  listed_ = edits_text(stack);
}

void EditSession::replace_stack(std::vector<EditOperation> stack, Changes changes) {
  std::optional<EditableRoom> edited = rebuilt(stack, changes);
  replace_stack(std::move(stack), std::move(changes), std::move(edited));
}

void EditSession::replace_stack(std::vector<EditOperation> stack, Changes changes, std::optional<EditableRoom> edited) {
  commit(stack, changes);
  edited_ = std::move(edited);
  stack_ = std::move(stack);
  changes_ = std::move(changes);
}

EditReport EditSession::preview(const EditOperation& edit, BeforeAfter* picture) {
  EditableRoom after = room();
  const EditReport report = carry_out(after, edit);
  if (picture) *picture = compare(room(), after);
  return report;
}

EditReport EditSession::push(const EditOperation& edit, BeforeAfter* picture) {
  const EditLock lock(folder(), describe(edit), patience_);
  follow_file();
  EditOperation canonical = edit;
  canonical.select = selection_text(read_selection(room(), edit.select), room().labels);
  canonical.number = changes_.empty() ? 1 : changes_.back()->number + 1;
  canonical.change.clear();
  EditableRoom after = room();
  const EditReport report = carry_out(after, canonical);
  if (picture) *picture = compare(room(), after);
  std::vector<EditOperation> stack = stack_;
  Changes changes = changes_;
  stack.push_back(canonical);
  changes.push_back(
      std::make_shared<const EditChange>(difference(room(), after, canonical, report, canonical.number, base_)));
  after = EditableRoom();
  commit(stack, changes);
  if (one_edit_) return report;
  if (!edited_) edited_ = original_;
  apply_change(*edited_, *changes.back());
  stack_ = std::move(stack);
  changes_ = std::move(changes);
  return report;
}

EditRequest EditSession::understand(std::string_view text) const {
  const Vocabulary vocabulary = vocabulary_of(room());
  EditRequest request = read_request(text, vocabulary);
  if (request.undo) return request;
  try {
    const bool in_metres = request.edit.motion.in_metres;
    settle_motion(room(), in_metres ? length_unit().metres : std::nullopt, request.edit);
    return request;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kUsage) throw;
    throw with_readings(error, text, vocabulary);
  }
}

EditOperation EditSession::undo(size_t number) {
  const EditLock lock(folder(), "undo", patience_);
  follow_file();
  const size_t index = index_of_edit(stack_, number);
  const EditOperation undone = stack_[index];
  bool stay = true;  // the edits after it
  for (size_t i = index + 1; i < changes_.size(); ++i) stay = stay && is_independent(*changes_[index], *changes_[i]);
  std::vector<EditOperation> stack = stack_;
  stack.erase(stack.begin() + static_cast<std::ptrdiff_t>(index));
  Changes changes(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(index));
  if (stay) changes.insert(changes.end(), changes_.begin() + static_cast<std::ptrdiff_t>(index) + 1, changes_.end());
  if (!stay) {
    for (size_t i = index; i < stack.size(); ++i) {
      if (stack[i].kind == EditKind::kReplace) stack[i].object = inserted_by(*changes_[i + 1], original_);
      stack[i].change.clear();
    }
  }
  std::optional<EditableRoom> edited;
  try {
    edited = rebuilt(stack, changes);
  } catch (const Error& error) {
    if (stay || error.kind() != ErrorKind::kBadInput || changes.size() >= stack.size()) throw;
    refuse_undo(index + 1, changes.size() + 2, stack[changes.size()]);  // the edit that is gone was counted, too
  }
  replace_stack(std::move(stack), std::move(changes), std::move(edited));
  return undone;
}

std::vector<EditOperation> EditSession::undo_latest(size_t count) {
  const EditLock lock(folder(), "undo", patience_);
  follow_file();
  std::vector<EditOperation> stack = stack_, undone = take_latest(stack, count);
  Changes changes(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(stack.size()));
  replace_stack(std::move(stack), std::move(changes));
  return undone;
}

TrainingState EditSession::edited_state(TrainingState out, const EditableRoom& room) {
  const GaussianModel trained = std::move(out.engine.model);
  const size_t rows = trained.size(), channels = static_cast<size_t>(trained.semantic_channels);
  RestructurePlan plan;
  std::vector<float> semantics;
  semantics.reserve(channels * room.origins.size());
  for (const GaussianOrigin& origin : room.origins) {
    RowOrigin row;
    row.source = origin.row;
    row.kind = origin.filled ? RowOrigin::Kind::kClone : RowOrigin::Kind::kKeep;
    plan.rows.push_back(row);
    const auto first = trained.semantics.begin() + static_cast<std::ptrdiff_t>(channels * origin.row);
    semantics.insert(semantics.end(), first, first + static_cast<std::ptrdiff_t>(channels));
  }
  for (auto& [name, values] : out.engine.arrays) {
    if (rows > 0 && !values.empty() && values.size() % rows == 0) restructure_rows(plan, values.size() / rows, values);
  }
  out.engine.model = room.gaussians.model;
  out.engine.model.semantic_channels = trained.semantic_channels;
  out.engine.model.semantics = std::move(semantics);
  return out;
}

EditReport EditSession::write_run(const fs::path& out, const EditOperation& edit, const std::string& command_line) {
  require_new_folder(out, {folder(), scene().folder});
  TrainingState trained = read_state();  // before the work: a run without checkpoints has none
  EditableRoom after = room();
  const EditReport report = carry_out(after, edit);
  std::vector<EditOperation> done = stack_;
  done.push_back(edit);

  FolderReplacement replacement(out);
  const RunFolder paths(replacement.path());
  write_file_atomically(paths.config(), read_file(RunFolder(folder()).config()));
  const TrainingState state = edited_state(std::move(trained), after);
  write_room(replacement.path(), after);  // first: the checkpoint of a finished run refers to its scene.ply
  write_checkpoint(paths.checkpoints(), state, run_->record.fingerprint, 1);
  write_camera_outputs(paths, scene(), run_->config);
  write_before_after(replacement.path() / "before_after.png", compare(room(), after));
  if (edit.kind == EditKind::kExtract) write_object(replacement.path() / "object", centred(after), *pool_);
  write_edited_record(paths.record(), run_->record, command_line, relative_scene_path(out, scene().folder), folder(),
                      done, after.gaussians.model.size());
  replacement.commit();
  return report;
}

}  // namespace aligngs
