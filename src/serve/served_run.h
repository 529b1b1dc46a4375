// What the page may see of a run: a description of it, its files, its photos and its events.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace aligngs {

/// A run folder, or a single PLY file. Read afresh at every request, so that a run in progress shows its progress.
class ServedRun {
 public:
  /// Error{kBadInput} when it is neither.
  explicit ServedRun(const std::filesystem::path& path);

  const std::filesystem::path& folder() const { return root_; }

  /// JSON: {"name", "status", "stage", "splats", "mesh", "version", "up", "units", "classes", "cameras", "views", "train",
  /// "report"}. "splats" and "mesh" are paths below /files/, null when absent; "version" changes with these files;
  /// "up" is the unit up vector or null; "views" tells per picture name which renders exist. What cannot be read (a
  /// file that is being replaced) is null.
  std::string state() const;

  /// A file of the run folder; of a single PLY only the file itself.
  std::optional<std::filesystem::path> file(std::string_view relative) const;
  /// The photo of a view, by its name, from the run's scene folder.
  std::optional<std::filesystem::path> photo(std::string_view view) const;

  /// Complete lines of events.ndjson from byte `offset` on, at most `limit` bytes but always at least one line, and
  /// moves `offset` behind them. An offset beyond the file's end (a run started anew) begins again at 0.
  std::string events(uint64_t& offset, size_t limit = size_t(1) << 18) const;

 private:
  std::filesystem::path scene_folder() const;

  std::filesystem::path root_;  ///< canonical
  std::string only_;            ///< name of the single file; empty for a run
};

}  // namespace aligngs
