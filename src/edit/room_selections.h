// The named selections of an opened room: which of its Gaussians each means.
#pragma once

#include <filesystem>
#include <vector>

#include "edit/named_selection.h"
#include "edit/selection_text.h"

namespace aligngs {

struct EditableRoom;

struct RoomSelections {
  std::filesystem::path file;  ///< for errors
  uint64_t scene = 0;          ///< digest of the trained Gaussians of the room (gaussians_digest)
  std::vector<NamedSelection> list;
  std::vector<std::vector<uint16_t>> classes;  ///< of the trained Gaussians of each; empty for another scene

  /// The selection of a name. Error{kBadInput} when its rows are of another scene.
  const NamedSelection& usable(const std::string& name) const;
  bool is_usable(const NamedSelection& selection) const { return selection.scene == scene; }
};

/// The selections of `list` for a room that was just read, before any edit.
RoomSelections room_selections(std::filesystem::path file, std::vector<NamedSelection> list,
                               const EditableRoom& trained);

/// Sets the rows of the terms that name a selection. A Gaussian that an edit moved is selected by what it was. Copies
/// and what fills a hole are not. Errors as RoomSelections::usable's.
SelectionQuery with_rows(SelectionQuery query, const EditableRoom& room);

/// Classes of what the terms name, as training left it; kNoLabel among them where something has none.
std::vector<uint16_t> classes_named(const std::vector<SelectionTerm>& terms, const EditableRoom& room);

}  // namespace aligngs
