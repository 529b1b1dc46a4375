// Edits, undo, redo and exports for the page: requests and answers as JSON over an EditSession.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <thread>
#include <vector>

#include "edit/edit_session.h"
#include "edit/vocabulary.h"
#include "serve/edited_scene.h"
#include "serve/view_server.h"

namespace aligngs {

struct EditServiceOptions {
  std::filesystem::path run;
  std::filesystem::path scene;  ///< where the scene went; may be empty
  int threads = 0;
  /// Tells the splats of a .ply file that the page has (SceneService::shown).
  std::function<std::shared_ptr<const ShownSplats>(const std::string& path)> shown;
  /// Held during an export: what a picture takes and what an export takes are not needed at once. May be null.
  std::mutex* drawing = nullptr;
  /// Gets the room whenever it has other edits than before. May be called on a thread of the service.
  std::function<void(const EditableRoom& room)> changed;
};

/// One call at a time, but for the two that say otherwise. The run is opened at the first call, and again when another process changed its files (a resumed
/// training, `aligngs edit` on the command line). Errors: kUsage while a process works on the run and for requests that
/// make no sense, otherwise those of EditSession.
class EditService {
 public:
  explicit EditService(EditServiceOptions options);
  ~EditService();
  /// Begins to open the run on a thread of its own, where it has edits: the page needs them for its first picture. To be
  /// called before anything else.
  void open_ahead();

  /// {"edits": ["delete pillow", ...], "redo": [...], "objects": [{"object", "class_id", "instance", "gaussians",
  /// "centre"}], "formats": [...]}; "redo" holds what undo took back, the next one first.
  std::string list();
  /// list() as it was after the last change, where nothing has changed since. It waits for no other call, and may be
  /// called beside them.
  std::optional<GetAnswer> listed_before() const;
  /// Error{kUsage} for {"edit": TEXT} whose words cannot be read. It waits for no other call, and may be called beside
  /// them. Words pass while the room is not known.
  void require_readable(const std::string& request) const;
  /// {"edit": TEXT (edit_text.h)} -> the report (report_json.h) with "view" and "picture", a PNG as data URL, before on
  /// the left. Nothing is written.
  std::string preview(const std::string& request);
  /// {"edit": TEXT} -> list() with "report"; for a text as "undo the second edit" with "undone".
  std::string push(const std::string& request);
  std::string undo(const std::string& request);  ///< {} -> list() with "undone"
  std::string redo(const std::string& request);  ///< {} -> list() with "report"
  /// {"format": NAME} -> {"file": path below the run folder, "bytes"}. {"format": "html", "without": PARTS} leaves out
  /// parts, a list of "mesh" and "before" with commas.
  std::string export_file(const std::string& request);
  /// {"format": "html"} -> {"page", "splats", "mesh", "before", "before_mesh"}: bytes that the file would have
  /// (HtmlSize).
  std::string estimate(const std::string& request);

  /// The difference that the edits make to the splats of a file of the run, for a page that has them (edited_scene.h).
  /// Nothing for other names and other rooms than the one that is edited.
  std::optional<GetAnswer> scene(const std::string& path);
  /// The edited mesh as PLY; nothing when the run has none.
  std::optional<GetAnswer> mesh();
  /// room.json with the edits; nothing when the run has none.
  std::optional<GetAnswer> room();

  /// The open run, as its files are now.
  EditSession& session();

  /// Adds GET /api/edits, also as a snapshot, /api/edits/scene/, /api/edits/mesh.ply and /api/edits/room.json. Adds POST
  /// /api/edits/{preview,push,undo,redo}, /api/export and /api/export/size, and checks of words. The service must outlive
  /// the server.
  void serve(ViewServerOptions& options);

 private:
  EditSession& opened();  ///< session(), without waiting for open_ahead()
  void tell_changed();
  /// Runs one request. Memory that it freed goes back to the system, as the session stays for hours.
  std::string lean(std::string (EditService::*call)(const std::string&), const std::string& request);
  std::string undone(const UndoRequest& request);
  nlohmann::json stack();  ///< what list() writes
  /// list() after a change of the stack, with one more field.
  std::string listed(const char* what, const nlohmann::json& value);

  /// The room as the last call left it.
  struct Snapshot {
    std::string files;      ///< versions of what it depends on
    Vocabulary vocabulary;  ///< without selections that came later
    std::string list;       ///< of list(); empty: nobody has asked yet
  };
  std::shared_ptr<const Snapshot> snapshot() const;  ///< null where files have changed since
  void keep_snapshot(std::string list);

  EditServiceOptions options_;
  std::unique_ptr<EditSession> session_;
  std::string opened_;               ///< versions of the files that the session read
  std::vector<EditOperation> redo_;  ///< taken back, the latest last
  std::string room_, room_files_;    ///< what room() last gave, and the versions of what it depends on
  mutable std::mutex snapshot_guard_;
  std::shared_ptr<const Snapshot> snapshot_;  ///< under snapshot_guard_
  std::jthread ahead_;                        // last: ends before what it uses
};

/// POST /api/control {"action": "pause" | "resume" | "checkpoint" | "stop"}: speaks to the training of an active run
/// (run_control.h); Error{kUsage} when there is none. `stop_asked` is called at each "stop".
void serve_control(const std::filesystem::path& run, ViewServerOptions& options, std::function<void()> stop_asked);

}  // namespace aligngs
