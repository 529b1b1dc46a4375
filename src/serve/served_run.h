// Visible parts of a run for the page: a description of it, its files, its photos and its events.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "serve/served_file.h"

namespace aligngs {

/// A run folder, or a single PLY file. Read afresh at every request, so that a run in progress shows its progress.
class ServedRun {
 public:
  /// Error{kBadInput} when it is neither. With `expect_run` any folder will do: a run is about to begin in it. `scene`
  /// is the new place of a scene that was moved; empty: as run.json says.
  explicit ServedRun(const std::filesystem::path& path, bool expect_run = false, std::filesystem::path scene = {});

  const std::filesystem::path& folder() const { return root_; }

  /// JSON: {"name", "status", "stage", "stages", "active", "editable", "edited", "edits", "drawable", "splats", "mesh",
  /// "version", "up", "units", "classes", "cameras", "views", "train", "report", "room", "notes", "start",
  /// "not_editable", "problems"}. "splats" and "mesh" are paths below /files/, null when absent. They are the live
  /// snapshot of a training, else the trained room. "version" changes with these files. "edited" tells whether the run
  /// has edits; /api/edits/scene/ has what they did. "edits" changes with them, and is null without. "active" tells
  /// whether a process works on the run, "editable" whether edits can be made, "drawable" whether the server draws
  /// pictures. "stages" lists {"name", "state": "done" | "now"
  /// | "waiting"}. "up" is the unit up vector or null. "views" tells per picture name which renders exist. "room" is
  /// the path
  /// of room.json or null. "notes" are the views and measurements of page.json (page_notes.h) or null. "start" is where the page begins (start_pose.h) or null. "not_editable" says why edits, pictures and exports are not there. "problems" lists files
  /// that are too large, nested too deeply or no JSON object; their parts are null. "status" is the one of run.json,
  /// "starting" before there is one, and "unknown" for splats without a record of their run.
  nlohmann::json description() const;
  std::string state() const;  ///< description() as text

  /// Addresses that a page asks for first, so that a browser may fetch them while it reads the page. They are the state
  /// and the splats of the first picture. Splats of a file whose name has other than plain letters are left out.
  std::vector<std::string> first_requests() const;

  /// A file of the run folder; of a single PLY only the file itself.
  std::optional<ServedFile> file(std::string_view relative) const;
  /// The photo of a view, by its name, from the run's scene folder. run.json is read again only when it has changed.
  std::optional<ServedFile> photo(std::string_view view);

  /// Changes whenever state() may have changed; cheap.
  std::string signature() const;

  /// Asks the training of an active run for a live snapshot; does nothing otherwise.
  void ask_for_snapshot() const;

  /// Complete lines of events.ndjson from byte `offset` on, at most `limit` bytes but always at least one line, and
  /// moves `offset` behind them. An offset beyond the file's end (a run started anew) begins again at 0.
  std::string events(uint64_t& offset, size_t limit = size_t(1) << 18) const;

 private:
  /// The place of the scene in run.json; `version`: of run.json then.
  struct PhotoRecord {
    std::string version;
    std::optional<std::string> scene;
  };

  /// The folder of the scene that a record names; empty where it is not there.
  std::filesystem::path scene_folder(const std::optional<std::string>& scene) const;

  std::filesystem::path root_;  ///< canonical
  std::string only_;            ///< name of the single file; empty for a run
  std::filesystem::path moved_scene_;
  std::optional<PhotoRecord> photo_record_;  ///< nothing: no photo was asked for yet
};

}  // namespace aligngs
