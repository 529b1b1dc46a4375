#include "serve/edit_service.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "core/free_memory.h"
#include "edit/edit_text.h"
#include "edit/named_selection.h"
#include "edit/nearest_readings.h"
#include "edit/report_json.h"
#include "io/base64.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "scene/mesh_ply.h"
#include "serve/export_file.h"
#include "serve/file_version.h"
#include "serve/plain_run.h"
#include "serve/request_body.h"
#include "train/run_control.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Options of an export that leaves parts out, as "mesh,before".
RunExportOptions without(const std::string& parts) {
  RunExportOptions options;
  std::istringstream list(parts);
  for (std::string part; std::getline(list, part, ',');) {
    if (part == "mesh")
      options.parts = RoomParts::kSplats;
    else if (part == "before")
      options.before = false;
    else
      throw_usage("there is no part \"" + part.substr(0, 40) + "\" to leave out", "mesh, before");
  }
  return options;
}

/// Changes when a training went on, a mesh was made, or somebody else edited.
std::string files_of(const fs::path& run) {
  std::vector<std::string> parts = {file_version(run / "edits.json"), file_version(run / "mesh" / "mesh.ply")};
  std::error_code error;
  for (fs::directory_iterator i(run / "checkpoints", error), end; !error && i != end; i.increment(error)) {
    parts.push_back(i->path().filename().string() + file_version(i->path()));
  }
  std::sort(parts.begin() + 2, parts.end());
  std::string all;
  for (const std::string& part : parts) all += part + "\n";
  return all;
}

/// Also what the list of formats depends on.
std::string files_of_list(const fs::path& run) { return files_of(run) + file_version(run / "room.json"); }

/// A page names objects beside its run only: what it asks for never leads elsewhere in the file system.
EditOperation beside_run(EditOperation edit, const fs::path& run) {
  if (edit.kind != EditKind::kReplace) return edit;
  const fs::path source(edit.with);
  const bool leads_out = std::any_of(source.begin(), source.end(), [](const fs::path& part) { return part == ".."; });
  if (source.is_absolute() || leads_out)
    throw_usage("the page replaces objects by those of the folder that the run is in",
                "name a run or a .ply file there, or use aligngs edit RUN --replace");
  edit.with = ((fs::absolute(run) / "..").lexically_normal() / source).string();
  return edit;
}

}  // namespace

EditService::EditService(EditServiceOptions options) : options_(std::move(options)) {}
EditService::~EditService() = default;

void EditService::open_ahead() {
  ahead_ = std::jthread([this] {
    try {
      if (!read_edits(options_.run / "edits.json").empty()) opened();
    } catch (const std::exception&) {
      // The page asks for its edits and gets the reason.
    }
  });
}

EditSession& EditService::session() {
  if (ahead_.joinable()) ahead_.join();
  return opened();
}

EditSession& EditService::opened() {
  if (RunControl(options_.run).active()) {
    session_.reset();
    throw_usage("the run is still being made", "wait until it has ended, or stop it; then its objects can be edited");
  }
  const std::string files = files_of(options_.run);
  if (!session_ || files != opened_) {
    session_.reset();
    redo_.clear();
    require_plain_run(options_.run);
    session_ = std::make_unique<EditSession>(options_.run, EditSessionOptions{options_.scene, options_.threads});
    give_back_free_memory();
    opened_ = files;
    keep_snapshot({});
    tell_changed();
  }
  session_->selections();  // those that another process changed are known before a sentence is read
  return *session_;
}

Json EditService::stack() {
  const EditSession& s = session();
  Json edits = Json::array(), redo = Json::array(), objects = Json::array();
  for (const EditOperation& edit : s.stack()) edits.push_back(describe(edit));
  for (auto it = redo_.rbegin(); it != redo_.rend(); ++it) redo.push_back(describe(*it));
  for (const Instance& object : s.objects()) {
    objects.push_back({{"object", object_name({object.label, object.number, object.gaussians}, s.room().labels)},
                       {"class_id", object.label},
                       {"instance", object.number},
                       {"gaussians", object.gaussians},
                       {"centre", {object.centre.x, object.centre.y, object.centre.z}}});
  }
  const Json formats = formats_of_run(s.folder(), s.room().gaussians.has_labels());
  return {{"edits", edits}, {"redo", redo}, {"objects", objects}, {"formats", formats}};
}

std::string EditService::list() {
  std::string text = json_line(stack());
  keep_snapshot(text);
  return text;
}

void EditService::keep_snapshot(std::string list) {
  auto kept = std::make_shared<const Snapshot>(
      Snapshot{opened_ + file_version(options_.run / "room.json"), vocabulary_of(session_->room()), std::move(list)});
  const std::lock_guard guard(snapshot_guard_);
  snapshot_ = std::move(kept);
}

std::shared_ptr<const EditService::Snapshot> EditService::snapshot() const {
  std::shared_ptr<const Snapshot> kept;
  {
    const std::lock_guard guard(snapshot_guard_);
    kept = snapshot_;
  }
  const bool valid = kept && !RunControl(options_.run).active() && files_of_list(options_.run) == kept->files;
  return valid ? kept : nullptr;
}

std::optional<GetAnswer> EditService::listed_before() const {
  const auto kept = snapshot();
  if (!kept || kept->list.empty()) return {};
  return GetAnswer{"application/json", kept->list, {}, {}};
}

void EditService::require_readable(const std::string& request) const {
  const std::string text = text_fields(request, {"edit"})["edit"].get<std::string>();
  const auto kept = snapshot();
  if (!kept) return;
  Vocabulary vocabulary = kept->vocabulary;
  try {
    for (const NamedSelection& s : read_named_selections(named_selections_file(options_.run)))
      vocabulary.add_selection(s.name);
  } catch (const Error&) {
    return;  // the edit itself tells what is wrong with the file
  }
  read_request(text, vocabulary);
}

std::string EditService::preview(const std::string& request) {
  const std::string text = text_fields(request, {"edit"})["edit"].get<std::string>();
  EditSession& s = session();
  const EditRequest asked = s.understand(text);
  if (asked.undo) throw_usage("there is no preview of an undo", "apply it; \"again\" brings the edit back");
  BeforeAfter picture;
  Json answer = report_json(s.preview(beside_run(asked.edit, options_.run), &picture), s.room().labels);
  answer["view"] = picture.view;
  answer["picture"] = nullptr;
  if (!picture.picture.empty()) {
    const std::vector<uint8_t> png = encode_png(picture.picture);
    answer["picture"] = "data:image/png;base64," + base64_text({reinterpret_cast<const char*>(png.data()), png.size()});
  }
  return json_line(answer);
}

void EditService::tell_changed() {
  if (options_.changed && !session_->stack().empty()) options_.changed(session_->room());
}

std::string EditService::listed(const char* what, const Json& value) {
  opened_ = files_of(options_.run);
  tell_changed();
  Json answer = stack();
  keep_snapshot(json_line(answer));
  answer[what] = value;
  return json_line(answer);
}

std::string EditService::push(const std::string& request) {
  const std::string text = text_fields(request, {"edit"})["edit"].get<std::string>();
  EditSession& s = session();
  const EditRequest asked = s.understand(text);
  if (asked.undo) return undone(*asked.undo);
  const Json report = report_json(s.push(beside_run(asked.edit, options_.run)), s.room().labels);
  redo_.clear();
  return listed("report", report);
}

std::string EditService::undone(const UndoRequest& request) {
  std::vector<EditOperation> taken;
  if (request.number > 0) {
    taken.push_back(session().undo(request.number));
  } else {
    taken = session().undo_latest(request.latest);
  }
  redo_.insert(redo_.end(), taken.begin(), taken.end());
  return listed("undone", describe(taken));
}

std::string EditService::undo(const std::string& request) {
  text_fields(request, {});
  return undone(UndoRequest{});
}

std::string EditService::redo(const std::string& request) {
  text_fields(request, {});
  EditSession& s = session();  // forgets what was undone when somebody else edited since
  if (redo_.empty())
    throw_usage("there is no edit to do again", "only what undo has just taken back can be done again");
  const Json report = report_json(s.push(redo_.back()), s.room().labels);
  redo_.pop_back();
  return listed("report", report);
}

std::string EditService::export_file(const std::string& request) {
  const bool chosen = parse_json(request).contains("without");
  const Json asked = chosen ? text_fields(request, {"format", "without"}) : text_fields(request, {"format"});
  const std::string format = asked["format"].get<std::string>();
  run_export_row(format);  // before the run is opened
  EditSession& open = session();
  std::unique_lock<std::mutex> turn;
  if (options_.drawing != nullptr) turn = std::unique_lock(*options_.drawing);
  const RunExport made =
      export_run(open, format, chosen ? without(asked["without"].get<std::string>()) : RunExportOptions());
  return json_line(Json{{"file", made.file.filename().string()}, {"bytes", fs::file_size(made.file)}});
}

std::string EditService::estimate(const std::string& request) {
  if (run_export_row(text_fields(request, {"format"})["format"].get<std::string>()).kind != ExportKind::kPage)
    throw_usage("only html tells its size before it is written");
  const HtmlSize size = estimate_html_export(session());
  return json_line(Json{{"page", size.page},
                        {"splats", size.splats},
                        {"mesh", size.mesh},
                        {"before", size.before},
                        {"before_mesh", size.before_mesh}});
}

std::optional<GetAnswer> EditService::scene(const std::string& path) {
  const auto shown = options_.shown ? options_.shown(path) : nullptr;
  if (!shown) return {};
  const EditSession& s = session();
  const size_t rows = s.original().origins.size();
  if (std::any_of(shown->order.begin(), shown->order.end(), [&](uint32_t row) { return row >= rows; })) return {};
  auto bytes = std::make_shared<const std::string>(edited_scene(s.original(), s.room(), *shown));
  return GetAnswer{"application/octet-stream", {}, std::move(bytes), {}};
}

std::optional<GetAnswer> EditService::mesh() {
  const TriangleMesh& mesh = session().room().mesh;
  if (mesh.vertices.empty()) return {};
  return GetAnswer{"application/octet-stream", {}, std::make_shared<const std::string>(mesh_ply(mesh)), {}};
}

std::optional<GetAnswer> EditService::room() {
  EditSession& s = session();
  const std::string files = files_of_list(options_.run);
  if (room_.empty() || files != room_files_) {
    const std::optional<std::string> text = room_with_edits(s);
    if (!text) return {};
    room_ = *text;
    room_files_ = files;
  }
  return GetAnswer{"application/json", room_, {}, {}};
}

std::string EditService::lean(std::string (EditService::*call)(const std::string&), const std::string& request) {
  struct GiveBack {
    ~GiveBack() { give_back_free_memory(); }
  } at_the_end;
  return (this->*call)(request);
}

void EditService::serve(ViewServerOptions& options) {
  options.get["/api/edits"] = [this](const std::string&) -> std::optional<GetAnswer> {
    return GetAnswer{"application/json", list(), {}, {}};
  };
  options.snapshots["/api/edits"] = [this](const std::string&) { return listed_before(); };
  for (const char* words : {"/api/edits/preview", "/api/edits/push"})
    options.checks[words] = [this](const std::string& body) { require_readable(body); };
  options.get["/api/edits/scene/"] = [this](const std::string& path) { return scene(path); };
  options.get["/api/edits/mesh.ply"] = [this](const std::string&) { return mesh(); };
  options.get["/api/edits/room.json"] = [this](const std::string&) { return room(); };
  const auto post = [&](const char* path, std::string (EditService::*call)(const std::string&)) {
    options.post[path] = [this, call](const std::string& body) { return lean(call, body); };
  };
  post("/api/edits/preview", &EditService::preview);
  post("/api/edits/push", &EditService::push);
  post("/api/edits/undo", &EditService::undo);
  post("/api/edits/redo", &EditService::redo);
  post("/api/export/size", &EditService::estimate);
  post("/api/export", &EditService::export_file);
}

void serve_control(const fs::path& run, ViewServerOptions& options, std::function<void()> stop_asked) {
  options.prompt.insert("/api/control");  // it speaks to a training by files, and to the program by an atomic flag
  options.post["/api/control"] = [run, stop_asked](const std::string& body) -> std::string {
    using Flag = RunControl::Flag;
    const std::string action = text_fields(body, {"action"})["action"].get<std::string>();
    require_plain_run(run);
    const RunControl control(run);
    if (!control.active()) throw_usage("nothing is being made here", "start it again: aligngs run ... --resume");
    if (action == "pause")
      control.ask(Flag::kPause);
    else if (action == "resume")
      control.withdraw(Flag::kPause);
    else if (action == "checkpoint")
      control.ask(Flag::kCheckpoint);
    else if (action == "stop")
      control.ask(Flag::kStop), stop_asked();
    else
      throw_usage("there is no action \"" + action.substr(0, 40) + "\"", "pause, resume, checkpoint or stop");
    return "{}";
  };
}

}  // namespace aligngs
