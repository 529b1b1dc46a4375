#include "serve/served_run.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/json_text.h"
#include "serve/file_version.h"
#include "serve/run_descriptions.h"
#include "serve/run_products.h"
#include "serve/start_pose.h"
#include "train/run_control.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr size_t kMaxLine = size_t(1) << 20;  // bytes of one event

/// The place of a run's scene, as its record has it.
std::optional<std::string> scene_of(const Json& record) {
  const Json scene = json_field(record, "scene");
  return scene.is_string() ? std::optional(scene.get<std::string>()) : std::nullopt;
}

/// Why edits, pictures and exports are not there for a run; null when they are. `scene` is its folder, empty where there
/// is none.
Json why_not_editable(const fs::path& root, RunDescriptions& descriptions, const fs::path& scene, bool active) {
  if (active) return "the run is still being made";
  if (!has_file(root, "scene.ply") && !has_file(root, "scene.labels.ply")) {
    return has_folder(root, "checkpoints")
               ? "the training has stopped before its end: `aligngs train -o RUN --resume` goes on from its checkpoint"
               : "nothing has been trained yet";
  }
  const Json& record = descriptions.object(root, "run.json");
  if (!record.is_object()) return "run.json, the record of the run, is missing or damaged";
  if (json_field(record, "scene").is_string() && scene.empty())
    return "the scene of this run is not where run.json says: `aligngs view RUN --scene DIR` names its new place";
  for (const char* name : {"edits.json", "selections.json"}) {
    if (const Json& fault = descriptions.fault(root, name); !fault.is_null()) return fault;
  }
  return nullptr;
}

}  // namespace

ServedRun::ServedRun(const fs::path& path, bool expect_run, fs::path scene) : moved_scene_(std::move(scene)) {
  std::error_code error;
  const fs::path found = fs::canonical(path, error);
  const auto refuse = [&](const char* what) {
    throw_bad_input(path, {}, what, "give a run folder (it holds run.json or scene.ply) or a .ply file");
  };
  if (error) refuse("there is no such run or file");
  if (fs::is_directory(found)) {
    if (!expect_run && !fs::exists(found / "run.json") && !fs::exists(found / "scene.ply"))
      refuse("the folder is not a run");
    root_ = found;
  } else {
    if (found.extension() != ".ply") refuse("the file is not a .ply file");
    root_ = found.parent_path();
    only_ = found.filename().string();
  }
}

fs::path ServedRun::scene_folder(const std::optional<std::string>& scene) const {
  if (moved_scene_.empty() && !scene) return {};
  std::error_code error;
  const fs::path found = fs::canonical(moved_scene_.empty() ? root_ / *scene : moved_scene_, error);
  return error ? fs::path() : found;
}

std::string ServedRun::state() const { return json_line(description()); }

Json ServedRun::description() const {
  Json state = {
      {"splats", nullptr},         {"mesh", nullptr},         {"up", nullptr},           {"units", nullptr},
      {"classes", nullptr},        {"cameras", nullptr},      {"views", Json::object()}, {"train", nullptr},
      {"report", false},           {"status", "file"},        {"stage", nullptr},        {"stages", Json::array()},
      {"active", false},           {"editable", false},       {"edited", false},         {"edits", nullptr},
      {"drawable", false},         {"not_editable", nullptr}, {"room", nullptr},         {"room_version", nullptr},
      {"problems", Json::array()}, {"notes", nullptr},        {"selections", nullptr},   {"start", nullptr},
      {"units_estimated", false}};
  if (!only_.empty()) {
    state["name"] = only_;
    state["splats"] = only_;
    state["version"] = file_version(root_ / only_);
    return state;
  }
  state["name"] = root_.filename().string();
  RunDescriptions descriptions;
  const Json run = descriptions.object(root_, "run.json");
  for (const char* name : {"status", "stage", "train"}) state[name] = json_field(run, name);
  const bool active = RunControl(root_).active();
  state["active"] = active;
  state["stages"] = run_stages(root_, run, active);
  std::string trained;
  for (const char* name : {"scene.labels.ply", "scene.ply"}) {
    if (trained.empty() && has_file(root_, name)) trained = name;
  }
  if (run.is_null()) state["status"] = trained.empty() || active ? "starting" : "unknown";
  const bool live = active && has_file(root_, "live/scene.ply");
  if (live) {
    state["splats"] = "live/scene.ply";
  } else if (!trained.empty()) {
    state["splats"] = trained;
  }
  if (has_file(root_, "mesh/mesh.ply")) state["mesh"] = "mesh/mesh.ply";
  const fs::path scene = scene_folder(scene_of(run));
  state["not_editable"] = why_not_editable(root_, descriptions, scene, active);
  state["editable"] = state["not_editable"].is_null();
  state["drawable"] = state["editable"].get<bool>() && has_folder(root_, "checkpoints");
  const Json edits = json_field(descriptions.object(root_, "edits.json"), "edits");
  if (!live && state["editable"].get<bool>() && edits.is_array() && !edits.empty()) {
    state["edited"] = true;
    state["edits"] = file_version(root_ / "edits.json");
  }
  state["selections"] = has_file(root_, "selections.json") ? Json(file_version(root_ / "selections.json")) : Json();
  state["version"] =
      file_version(root_ / (live ? "live/scene.ply" : "scene.ply")) + file_version(root_ / "mesh" / "mesh.ply");
  state["classes"] = json_field(descriptions.object(root_, "classes.json"), "classes");
  if (state["classes"].is_null() && !scene.empty()) state["classes"] = scene_classes(scene);
  state["cameras"] = descriptions.read(root_, "cameras.json");
  state["views"] = rendered_views(root_);
  state["report"] = has_file(root_, "report.html");
  if (!descriptions.object(root_, "room.json").is_null()) {
    state["room"] = "room.json";
    state["room_version"] = file_version(root_ / "room.json");
  }
  for (const char* name : {"metrics.json", "selections.json"}) descriptions.object(root_, name);
  state["notes"] = descriptions.notes(root_);
  if (!scene.empty()) {
    const Json description = descriptions.object(scene, "scene.json");
    state["up"] = json_field(description, "up");
    state["units"] = json_field(description, "units");
    state["units_estimated"] = !json_field(description, "units_estimate").is_null();
  }
  state["start"] = start_pose_json(start_pose(state["cameras"], state["up"]));
  state["problems"] = descriptions.problems();
  return state;
}

std::vector<std::string> ServedRun::first_requests() const {
  std::vector<std::string> requests = {"/api/state"};
  const Json now = description();
  const auto is_plain = [](const std::string& path) {
    return path.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-/") == path.npos;
  };
  if (now["splats"].is_string() && is_plain(now["splats"].get<std::string>())) {
    requests.push_back("/api/scene/coarse/" + now["splats"].get<std::string>() +
                       "?v=" + now["version"].get<std::string>());
  }
  return requests;
}

std::string ServedRun::signature() const {
  if (!only_.empty()) return file_version(root_ / only_);
  std::string text = RunControl(root_).active() ? "active" : "";
  for (const char* name :
       {"run.json", "live/scene.ply", "scene.ply", "scene.labels.ply", "cameras.json", "edits.json", "selections.json",
        "mesh/mesh.ply", "metrics.json", "report.html", "page.json", "room.json"}) {
    text += "/" + file_version(root_ / name);
  }
  return text;
}

void ServedRun::ask_for_snapshot() const {
  if (!only_.empty() || !has_folder(root_, "control")) return;
  const RunControl control(root_);
  if (!control.active()) return;
  try {
    control.ask(RunControl::Flag::kSnapshot);
  } catch (const Error&) {
    // The folder may only be read: the page shows what is there.
  }
}

std::optional<ServedFile> ServedRun::file(std::string_view relative) const {
  if (!only_.empty() && relative != only_) return {};
  return ServedFile::open(root_, relative);
}

std::optional<ServedFile> ServedRun::photo(std::string_view view) {
  if (!only_.empty() || view.find('/') != std::string_view::npos) return {};
  const std::string version = file_version(root_ / "run.json");
  if (!photo_record_ || photo_record_->version != version) {
    photo_record_ = {version, scene_of(RunDescriptions().object(root_, "run.json"))};
  }
  const fs::path scene = scene_folder(photo_record_->scene);
  if (scene.empty()) return {};
  std::error_code error;
  const fs::path images = fs::canonical(scene / "images", error);
  if (error) return {};
  for (const char* ending : {".png", ".jpg", ".jpeg", ".JPG", ".JPEG", ".PNG"}) {
    if (auto found = ServedFile::open(images, std::string(view) + ending)) return found;
  }
  return {};
}

std::string ServedRun::events(uint64_t& offset, size_t limit) const {
  if (!only_.empty()) return {};
  const auto file = ServedFile::open(root_, "events.ndjson");
  if (!file) return {};
  const uint64_t size = file->size();
  if (offset > size) offset = 0;
  const size_t wanted = static_cast<size_t>(std::min<uint64_t>(size - offset, std::max(limit, kMaxLine)));
  std::string text(wanted, '\0');
  text.resize(file->read(offset, text));
  size_t end = text.rfind('\n', limit == 0 ? 0 : limit - 1);
  if (end == std::string::npos) end = text.find('\n');  // the first line is longer than the limit
  if (end == std::string::npos && text.size() >= kMaxLine) {
    offset += text.size();  // no event is that long: a torn file does not hide what follows
    return {};
  }
  text.resize(end == std::string::npos ? 0 : end + 1);
  offset += text.size();
  return text;
}

}  // namespace aligngs
