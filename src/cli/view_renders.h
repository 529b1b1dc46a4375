// Pictures of any view of a run, made when the page asks for them.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "cli/stages/loaded_run.h"
#include "serve/view_server.h"

namespace aligngs {

class ViewRenders {
 public:
  /// `drawing` is held while a run is opened or drawn: two pictures at a time would need twice the memory.
  ViewRenders(std::filesystem::path run, LoadRunOptions options, std::mutex& drawing)
      : folder_(std::move(run)), options_(std::move(options)), drawing_(drawing) {
    options_.shown_classes = true;
  }

  /// "<view>/<kind>.png" with kind rgb, depth, normal or label -> the picture, as `aligngs render` draws it. Nothing
  /// for other names. Error{kUsage} while a process works on the run.
  std::optional<GetAnswer> picture(const std::string& name);

  /// Adds GET /api/render/. This must outlive the server.
  void serve(ViewServerOptions& options);

 private:
  std::filesystem::path folder_;
  LoadRunOptions options_;
  std::mutex& drawing_;
  std::optional<LoadedRun> run_;
  std::string opened_;  ///< name of the checkpoint that was read
};

}  // namespace aligngs
