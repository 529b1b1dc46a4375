// Selections that were drawn by hand and have a name: RUN/selections.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace aligngs {

/// Rows first, first + 1, ..., first + count - 1.
struct RowRange {
  uint32_t first = 0, count = 0;
};

inline constexpr size_t kMostNamedSelections = 256;  ///< of a run

struct NamedSelection {
  std::string name;              ///< as selection_name() gives it
  uint64_t scene = 0;            ///< digest of the trained Gaussians that the rows are of (gaussians_digest)
  uint32_t gaussians = 0;        ///< rows of that scene
  std::vector<RowRange> ranges;  ///< rows of RUN/scene.ply, ascending, with a gap between two

  size_t count() const;                        ///< selected rows
  std::vector<uint8_t> mask() const;           ///< one flag per row of the scene
  bool is_called(std::string_view) const;      ///< case, '-' and '_' do not matter (folded_name)
  void set_rows(const std::vector<uint8_t>&);  ///< from one flag per row
};

/// A name as people type it, with single blanks between words. A name has 1 to 64 bytes of UTF-8 and at least one
/// letter, of any language. Digits, blanks and - _ . ' are allowed, too. Error{kUsage} for other texts.
std::string selection_name(std::string_view given);

/// selections.json, in the order of the file. Error{kBadInput} naming entry and field. Rows are in the text
/// "12-41,57": ascending, from 0 on.
std::vector<NamedSelection> parse_named_selections(const std::string& json,
                                                   const std::filesystem::path& name_for_errors);
std::string named_selections_text(const std::vector<NamedSelection>& selections);
/// An absent file has no selections.
std::vector<NamedSelection> read_named_selections(const std::filesystem::path& path);

std::filesystem::path named_selections_file(const std::filesystem::path& run);  ///< RUN/selections.json

}  // namespace aligngs
