// Words that take edits back: "undo", "undo the second edit", "undo the last two edits", "undo everything".
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>

namespace aligngs {

struct UndoRequest {
  static constexpr size_t kAll = std::numeric_limits<size_t>::max();
  size_t number = 0;  ///< of one edit, where 1 is the oldest; 0: the latest ones
  size_t latest = 1;  ///< how many of these; kAll: every edit
  bool operator==(const UndoRequest&) const = default;
};

/// Nothing for a text that does not begin with "undo", "revert" or "take back". Error{kUsage} where it does, and does
/// not tell which edits.
std::optional<UndoRequest> parse_undo(std::string_view text);

}  // namespace aligngs
