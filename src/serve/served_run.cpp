#include "serve/served_run.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "scene/label_set.h"
#include "serve/file_version.h"
#include "serve/request_rules.h"
#include "train/run_control.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

constexpr uint64_t kMaxJson = uint64_t(64) << 20;  // bytes of one description file
constexpr size_t kMaxLine = size_t(1) << 20;       // bytes of one event

Json read_json(const fs::path& path) {
  try {
    Json json = parse_json(read_file(path, kMaxJson));
    return json.is_discarded() ? Json() : json;
  } catch (const Error&) {
    return nullptr;
  }
}

Json field(const Json& object, const char* name) {
  return object.is_object() && object.contains(name) ? object.at(name) : Json();
}

/// Names of views -> {"split": ..., "kinds": [...]} from the folders of renders/.
Json rendered_views(const fs::path& root) {
  Json views = Json::object();
  std::error_code error;
  for (const char* split : {"test", "train"}) {
    for (const char* kind : {"gt", "rgb", "depth", "normal", "label", "error"}) {
      for (fs::directory_iterator i(root / "renders" / split / kind, error), end; !error && i != end; i.increment(error)) {
        if (i->path().extension() != ".png") continue;
        Json& view = views[i->path().stem().string()];
        view["split"] = split;
        view["kinds"].push_back(kind);
      }
      error.clear();
    }
  }
  return views;
}

/// The classes of a run that has not written its classes.json yet: those of its scene.
Json scene_classes(const fs::path& scene) {
  LabelSet labels = ade20k_labels();
  try {
    if (fs::exists(scene / "labels.csv")) labels = read_label_csv(scene / "labels.csv");
  } catch (const Error&) {
    return nullptr;
  }
  Json classes = Json::array();
  for (int i = 0; i < labels.size(); ++i) {
    const LabelClass& c = labels.classes[static_cast<size_t>(i)];
    classes.push_back({{"id", i}, {"name", c.name}, {"synonyms", c.synonyms}, {"color", c.color}});
  }
  return classes;
}

/// Stages of `aligngs run`, in order, and the progress of this run.
Json stages_of(const fs::path& root, const Json& run, bool active) {
  struct Stage {
    const char *name, *product;
  };
  constexpr Stage kStages[] = {{"train", "scene.ply"}, {"render", "renders"}, {"mesh", "mesh/mesh.ply"},
                               {"measure", "metrics.json"}, {"report", "report.html"}};
  const Json named = field(run, "stage");
  const std::string current = !active ? "" : named.is_string() ? named.get<std::string>() : "train";
  Json stages = Json::array();
  bool later = false;  // than the one in progress: products there are of an earlier time
  for (const Stage& stage : kStages) {
    const bool now = current == stage.name;
    const bool done = !now && !later && fs::exists(root / stage.product);
    later |= now;
    stages.push_back({{"name", stage.name}, {"state", now ? "now" : done ? "done" : "waiting"}});
  }
  return stages;
}

}  // namespace

ServedRun::ServedRun(const fs::path& path, bool expect_run) {
  std::error_code error;
  const fs::path found = fs::canonical(path, error);
  const auto refuse = [&](const char* what) {
    throw_bad_input(path, {}, what, "give a run folder (it holds run.json or scene.ply) or a .ply file");
  };
  if (error) refuse("there is no such run or file");
  if (fs::is_directory(found)) {
    if (!expect_run && !fs::exists(found / "run.json") && !fs::exists(found / "scene.ply")) refuse("the folder is not a run");
    root_ = found;
  } else {
    if (found.extension() != ".ply") refuse("the file is not a .ply file");
    root_ = found.parent_path();
    only_ = found.filename().string();
  }
}

fs::path ServedRun::scene_folder() const {
  const Json scene = field(read_json(root_ / "run.json"), "scene");
  return scene.is_string() ? root_ / scene.get<std::string>() : fs::path();
}

std::string ServedRun::state() const {
  Json state = {{"splats", nullptr}, {"original", nullptr}, {"mesh", nullptr}, {"up", nullptr}, {"units", nullptr},
                {"classes", nullptr}, {"cameras", nullptr}, {"views", Json::object()}, {"train", nullptr}, {"report", false},
                {"status", "file"}, {"stage", nullptr}, {"stages", Json::array()}, {"active", false}, {"editable", false}, {"edited", false}};
  if (!only_.empty()) {
    state["name"] = only_;
    state["splats"] = only_;
    state["version"] = file_version(root_ / only_);
    return json_line(state);
  }
  state["name"] = root_.filename().string();
  const Json run = read_json(root_ / "run.json");
  for (const char* name : {"status", "stage", "train"}) state[name] = field(run, name);
  if (run.is_null()) state["status"] = "starting";
  const bool active = RunControl(root_).active();
  state["active"] = active;
  state["stages"] = stages_of(root_, run, active);
  std::string trained;
  for (const char* name : {"scene.labels.ply", "scene.ply"}) {
    if (trained.empty() && fs::exists(root_ / name)) trained = name;
  }
  const bool live = active && fs::exists(root_ / "live" / "scene.ply");
  const bool labelled_edit = fs::exists(root_ / "edits" / "scene.labels.ply");  // a run without labels has edits without them
  const bool edited = !live && (labelled_edit || fs::exists(root_ / "edits" / "scene.ply"));
  const fs::path shown = edited ? root_ / "edits" : root_;
  if (live) {
    state["splats"] = "live/scene.ply";
  } else if (edited) {
    state["splats"] = labelled_edit ? "edits/scene.labels.ply" : "edits/scene.ply";
    if (!trained.empty()) state["original"] = trained;
  } else if (!trained.empty()) {
    state["splats"] = trained;
  }
  if (fs::exists(shown / "mesh" / "mesh.ply")) state["mesh"] = edited ? "edits/mesh/mesh.ply" : "mesh/mesh.ply";
  state["edited"] = edited;
  state["editable"] = !active && fs::exists(root_ / "scene.ply") && fs::exists(root_ / "checkpoints");
  state["version"] = (live ? file_version(root_ / "live" / "scene.ply") : file_version(shown / "scene.ply")) + file_version(shown / "mesh" / "mesh.ply");
  const fs::path scene = scene_folder();
  state["classes"] = field(read_json(shown / "classes.json"), "classes");
  if (state["classes"].is_null() && !scene.empty()) state["classes"] = scene_classes(scene);
  state["cameras"] = read_json(root_ / "cameras.json");
  state["views"] = rendered_views(root_);
  state["report"] = fs::exists(root_ / "report.html");
  if (!scene.empty()) {
    const Json description = read_json(scene / "scene.json");
    state["up"] = field(description, "up");
    state["units"] = field(description, "units");
  }
  return json_line(state);
}

std::string ServedRun::signature() const {
  if (!only_.empty()) return file_version(root_ / only_);
  std::string text = RunControl(root_).active() ? "active" : "";
  for (const char* name : {"run.json", "live/scene.ply", "scene.ply", "scene.labels.ply", "cameras.json", "edits.json", "edits/scene.ply",
                           "mesh/mesh.ply", "metrics.json", "report.html"}) {
    text += "/" + file_version(root_ / name);
  }
  return text;
}

void ServedRun::ask_for_snapshot() const {
  if (!only_.empty()) return;
  const RunControl control(root_);
  if (!control.active()) return;
  try {
    control.ask(RunControl::Flag::kSnapshot);
  } catch (const Error&) {
    // The folder may only be read: the page shows what is there.
  }
}

std::optional<fs::path> ServedRun::file(std::string_view relative) const {
  if (!only_.empty() && relative != only_) return {};
  return file_below(root_, relative);
}

std::optional<fs::path> ServedRun::photo(std::string_view view) const {
  if (!only_.empty() || view.find('/') != std::string_view::npos) return {};
  const fs::path scene = scene_folder();
  if (scene.empty()) return {};
  std::error_code error;
  const fs::path images = fs::canonical(scene / "images", error);
  if (error) return {};
  for (const char* ending : {".png", ".jpg", ".jpeg", ".JPG", ".JPEG", ".PNG"}) {
    if (auto found = file_below(images, std::string(view) + ending)) return found;
  }
  return {};
}

std::string ServedRun::events(uint64_t& offset, size_t limit) const {
  if (!only_.empty()) return {};
  std::ifstream in(root_ / "events.ndjson", std::ios::binary | std::ios::ate);
  if (!in) return {};
  const uint64_t size = static_cast<uint64_t>(in.tellg());
  if (offset > size) offset = 0;
  const size_t wanted = static_cast<size_t>(std::min<uint64_t>(size - offset, std::max(limit, kMaxLine)));
  std::string text(wanted, '\0');
  in.seekg(static_cast<std::streamoff>(offset));
  in.read(text.data(), static_cast<std::streamsize>(wanted));
  text.resize(static_cast<size_t>(in.gcount()));
  size_t end = text.rfind('\n', limit == 0 ? 0 : limit - 1);
  if (end == std::string::npos) end = text.find('\n');  // the first line is longer than the limit
  text.resize(end == std::string::npos ? 0 : end + 1);
  offset += text.size();
  return text;
}

}  // namespace aligngs
