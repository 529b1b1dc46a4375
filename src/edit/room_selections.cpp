#include "edit/room_selections.h"

#include <algorithm>
#include <set>
#include <utility>

#include "core/error.h"
#include "edit/apply_edit.h"
#include "edit/edit_change.h"

namespace aligngs {
namespace {

std::vector<uint8_t> rows_in_room(const NamedSelection& selection, const EditableRoom& room) {
  const std::vector<uint8_t> trained = selection.mask();
  std::vector<uint8_t> stands(trained.size(), 0);  // trained Gaussians that no edit took or moved
  for (const GaussianOrigin& origin : room.origins) {
    if (!origin.filled) stands[origin.row] = 1;
  }
  std::vector<uint8_t> out(room.origins.size(), 0);
  for (size_t i = 0; i < out.size(); ++i) {
    const GaussianOrigin& origin = room.origins[i];
    out[i] = trained[origin.row] && (!origin.filled || !stands[origin.row]);
  }
  return out;
}

void set_rows(std::vector<SelectionTerm>& terms, const EditableRoom& room) {
  for (SelectionTerm& term : terms) {
    if (term.named.empty()) continue;
    term.rows = std::make_shared<const std::vector<uint8_t>>(rows_in_room(room.selections->usable(term.named), room));
  }
}

}  // namespace

const NamedSelection& RoomSelections::usable(const std::string& name) const {
  const auto it = std::find_if(list.begin(), list.end(), [&](const NamedSelection& s) { return s.is_called(name); });
  if (it == list.end()) throw_usage("there is no selection \"" + name + "\"", "`aligngs edit RUN --list` shows them");
  if (!is_usable(*it)) {
    throw_bad_input(file, it->name, "this selection is of another training: the room has other Gaussians now",
                    "select it again on the page under another name, or remove it: aligngs edit RUN "
                    "--remove-selection \"" +
                        it->name + "\"");
  }
  return *it;
}

RoomSelections room_selections(std::filesystem::path file, std::vector<NamedSelection> list,
                               const EditableRoom& trained) {
  RoomSelections out{std::move(file), gaussians_digest(trained.gaussians.model), std::move(list), {}};
  for (const NamedSelection& selection : out.list) {
    std::set<uint16_t> classes;
    for (const RowRange& range : out.is_usable(selection) ? selection.ranges : std::vector<RowRange>()) {
      for (uint32_t i = range.first; i < range.first + range.count; ++i)
        classes.insert(trained.gaussians.labels.label[i]);
    }
    out.classes.emplace_back(classes.begin(), classes.end());
  }
  return out;
}

SelectionQuery with_rows(SelectionQuery query, const EditableRoom& room) {
  set_rows(query.include, room);
  set_rows(query.exclude, room);
  return query;
}

std::vector<uint16_t> classes_named(const std::vector<SelectionTerm>& terms, const EditableRoom& room) {
  std::vector<uint16_t> out;
  for (const SelectionTerm& term : terms) {
    if (term.named.empty()) {
      out.push_back(static_cast<uint16_t>(term.label));
      continue;
    }
    for (size_t i = 0; i < room.selections->list.size(); ++i) {
      const std::vector<uint16_t>& classes = room.selections->classes[i];
      if (room.selections->list[i].is_called(term.named)) out.insert(out.end(), classes.begin(), classes.end());
    }
  }
  return out;
}

}  // namespace aligngs
