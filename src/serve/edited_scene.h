// A scene that the page has already, and its edits: the difference alone instead of the whole scene again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edit/apply_edit.h"

namespace aligngs {

/// The splats of a file as the page has them (compact_scene.h).
struct ShownSplats {
  std::vector<uint32_t> order;  ///< row of the file of each
  size_t harmonics = 0;         ///< columns f_rest_0.. that the page has
};

/// A gzip stream. A line of JSON is first, {"total", "changed", "added", "changed_columns", "added_columns"}. A bit
/// follows for each of the page's `total` splats, lowest first, which tells whether it stays. The places (u32) of the
/// `changed` ones are next, then the columns. They are described as in compact_scene.h. The last `added` numbers (u32)
/// are the places that the new splats were moved from, or 0xffffffff for copies and for what fills a hole. `trained`
/// and `room` are the same room before and after its edits.
std::string edited_scene(const EditableRoom& trained, const EditableRoom& room, const ShownSplats& shown);

}  // namespace aligngs
