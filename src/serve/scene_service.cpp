#include "serve/scene_service.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/free_memory.h"
#include "serve/compact_scene.h"
#include "serve/splat_table.h"

namespace aligngs {
namespace {

constexpr size_t kKept = 2;                            // scenes: the live snapshot, and the trained room after it
constexpr uint64_t kLargestScene = uint64_t(4) << 30;  // bytes of a PLY file

}  // namespace

SceneService::SceneService(const std::filesystem::path& run, bool expect_run) : run_(run, expect_run) {
  ahead_ = std::jthread([this] {
    try {
      const nlohmann::json state = run_.description();
      if (state["splats"].is_string() && !state["active"].get<bool>())
        part("coarse/" + state["splats"].get<std::string>());
    } catch (const std::exception&) {
      // The page asks for the same scene and gets the reason.
    }
  });
}

SceneService::Prepared SceneService::prepared(const std::string& path, const ServedFile& file) {
  const std::lock_guard lock(mutex_);
  for (const Prepared& scene : scenes_) {
    if (scene.path == path && scene.version == file.etag()) return scene;
  }
  std::optional<std::string> ply = file.content(kLargestScene);
  if (!ply)
    throw_bad_input(file.path(), {}, "the file is larger than 4 GiB",
                    "load it from the run folder with another viewer");
  SplatTable table = read_splat_table(*ply, file.path());
  ply.reset();  // the text of the file and its table are not needed at a time
  CompactScene made = compact_scene(table);
  scenes_.remove_if([&](const Prepared& scene) { return scene.path == path; });
  scenes_.push_front({path, file.etag(), std::make_shared<const std::string>(std::move(made.coarse)),
                      std::make_shared<const std::string>(std::move(made.rest)),
                      std::make_shared<const ShownSplats>(ShownSplats{std::move(made.order), table.harmonics.size()})});
  if (scenes_.size() > kKept) scenes_.pop_back();
  table = {};
  give_back_free_memory();
  return scenes_.front();
}

std::optional<GetAnswer> SceneService::part(const std::string& name) {
  const size_t slash = name.find('/');
  const std::string which = name.substr(0, slash), path = slash == std::string::npos ? "" : name.substr(slash + 1);
  if ((which != "coarse" && which != "rest") || !path.ends_with(".ply")) return {};
  const auto file = run_.file(path);
  if (!file) return {};
  const Prepared scene = prepared(path, *file);
  std::string etag = scene.version;
  etag.insert(etag.size() - 1, "-" + which);
  return GetAnswer{"application/octet-stream", {}, which == "coarse" ? scene.coarse : scene.rest, etag};
}

std::shared_ptr<const ShownSplats> SceneService::shown(const std::string& path) {
  const auto file = path.ends_with(".ply") ? run_.file(path) : std::nullopt;
  return file ? prepared(path, *file).shown : nullptr;
}

void SceneService::serve(ViewServerOptions& options) {
  options.get["/api/scene/"] = [this](const std::string& name) { return part(name); };
}

}  // namespace aligngs
