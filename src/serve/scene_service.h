// The compact form of a run's splats for the page, made once per version of a file.
#pragma once

#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "serve/edited_scene.h"
#include "serve/served_run.h"
#include "serve/view_server.h"

namespace aligngs {

/// Safe to use from several threads; a scene is made by one of them while the others wait.
class SceneService {
 public:
  /// Begins to prepare the scene that the page will ask for. Errors as ServedRun's.
  SceneService(const std::filesystem::path& run, bool expect_run);
  SceneService(const SceneService&) = delete;
  SceneService& operator=(const SceneService&) = delete;

  /// "coarse/PATH" or "rest/PATH", PATH a .ply file of the run -> a gzip stream (compact_scene.h). Nothing for other
  /// names. Error{kBadInput} for a file without splats.
  std::optional<GetAnswer> part(const std::string& name);

  /// The splats of a .ply file of the run as the page has them. Nothing for other names.
  std::shared_ptr<const ShownSplats> shown(const std::string& path);

  /// Adds GET /api/scene/. The service must outlive the server.
  void serve(ViewServerOptions& options);

 private:
  struct Prepared {
    std::string path, version;
    std::shared_ptr<const std::string> coarse, rest;
    std::shared_ptr<const ShownSplats> shown;
  };
  Prepared prepared(const std::string& path, const ServedFile& file);

  ServedRun run_;
  std::mutex mutex_;
  std::list<Prepared> scenes_;  ///< the latest first; at most kKept
  std::jthread ahead_;          // last: ends before what it uses
};

}  // namespace aligngs
