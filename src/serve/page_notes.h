// Saved views and measurements of a run's page, in RUN/page.json.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "serve/view_server.h"

namespace aligngs {

/// A view of the camera. Places are in the scene's own axes and units.
struct SavedView {
  std::string name;  ///< 1 to 200 bytes
  std::array<double, 3> eye{}, target{};
  /// shares of the room's sides that the view shows: from and to across, up and along, 0 to 1
  std::optional<std::array<double, 6>> cut;
};

/// A distance between two places of the scene.
struct SavedMeasurement {
  std::array<double, 3> from{}, to{};
};

struct PageNotes {
  std::vector<SavedView> views;                ///< at most 200
  std::vector<SavedMeasurement> measurements;  ///< at most 200
};

/// {"format": "aligngs page", "version": 1, "views": [{"name", "eye", "target", "cut"}], "measurements": [{"from", "to"}]}.
/// "cut" may be absent. Error{kBadInput} that names the field: another format, or names without text. It is also
/// thrown for places that are no three finite numbers up to a million, and for cuts that are no six shares.
PageNotes read_page_notes(const std::string& text, const std::filesystem::path& name_for_errors);
nlohmann::json page_notes_json(const PageNotes& notes);

/// The notes of a run; none where there is no page.json. Errors as read_page_notes'.
PageNotes page_notes_of_run(const std::filesystem::path& run);

/// Adds POST /api/notes: the whole content of page.json, which replaces the old one. The answer is {}.
void serve_notes(const std::filesystem::path& run, ViewServerOptions& options);

}  // namespace aligngs
