#include "edit/edit_independence.h"

#include <algorithm>

namespace aligngs {
namespace {

/// Both ascend.
template <class T>
bool share(const std::vector<T>& a, const std::vector<T>& b) {
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() && j != b.end()) {
    if (*i == *j) return true;
    *i < *j ? void(++i) : void(++j);
  }
  return false;
}

bool has_any(const std::vector<uint16_t>& labels, const std::vector<uint16_t>& classes) {
  return std::any_of(labels.begin(), labels.end(),
                     [&](uint16_t label) { return std::binary_search(classes.begin(), classes.end(), label); });
}

/// Rows that an edit made are consecutive in every ascending list.
bool names_row_of(const std::vector<RowId>& rows, uint32_t edit) {
  const auto it = std::lower_bound(rows.begin(), rows.end(), row_of_edit(edit, 0));
  return it != rows.end() && *it < row_of_edit(edit + 1, 0);
}

bool uses_rows_of(const EditChange& later, uint32_t edit) {
  return names_row_of(later.removed, edit) || (later.colors && names_row_of(later.colors->rows, edit)) ||
         names_row_of(later.relabelled, edit) || names_row_of(later.removed_triangles, edit) ||
         names_row_of(later.recolored_vertices, edit);
}

bool are_apart(const EditChange& a, const EditChange& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis]) return true;
  }
  return false;
}

}  // namespace

bool is_independent(const EditChange& taken, const EditChange& later) {
  if (has_any(later.added.label, taken.classes)) return false;
  if (taken.colors) {
    if (share(taken.recolored_vertices, later.recolored_vertices)) return false;
    return !later.colors || !share(taken.colors->rows, later.colors->rows);
  }
  return !uses_rows_of(later, taken.number) && !later.asked_everything && !has_any(later.asked, taken.classes) &&
         are_apart(taken, later);
}

}  // namespace aligngs
