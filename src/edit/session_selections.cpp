// Selections by hand of an open run.
#include "edit/edit_session.h"
#include "edit/named_selection_log.h"

namespace aligngs {

void EditSession::follow_selections() {
  std::vector<NamedSelection> now = read_named_selections(named_selections_file(folder()));
  std::string listed = named_selections_text(now);
  if (original_.selections && listed == listed_selections_) return;
  original_.selections = std::make_shared<const RoomSelections>(
      room_selections(named_selections_file(folder()), std::move(now), original_));
  if (edited_) edited_->selections = original_.selections;
  listed_selections_ = std::move(listed);
}

const RoomSelections& EditSession::selections() {
  follow_selections();
  return *original_.selections;
}

void EditSession::save_selection(const std::string& name, const std::vector<uint8_t>& rows) {
  NamedSelection made;
  made.name = name;
  made.scene = gaussians_digest(original_.gaussians.model);
  made.set_rows(rows);
  add_selection(folder(), made, original_.labels, patience_);
  follow_selections();
}

void EditSession::rename_selection(const std::string& name, const std::string& to) {
  aligngs::rename_selection(folder(), name, to, original_.labels, patience_);
  follow_selections();
}

void EditSession::remove_selection(const std::string& name) {
  aligngs::remove_selection(folder(), name, original_.labels, patience_);
  follow_selections();
}

}  // namespace aligngs
