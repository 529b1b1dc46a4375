// Pictures of any view of a run, made when the page asks for them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "cli/stages/loaded_run.h"
#include "serve/view_server.h"

namespace aligngs {

class ViewRenders {
 public:
  ViewRenders(std::filesystem::path run, LoadRunOptions options)
      : folder_(std::move(run)), options_(std::move(options)) {}

  /// "<view>/<kind>.png" with kind rgb, depth, normal or label -> the picture, as `aligngs render` draws it. Nothing
  /// for
  /// other names. Error{kUsage} while a process works on the run.
  std::optional<GetAnswer> picture(const std::string& name);

  /// Adds GET /api/render/. This must outlive the server.
  void serve(ViewServerOptions& options);

 private:
  std::filesystem::path folder_;
  LoadRunOptions options_;
  std::optional<LoadedRun> run_;
  std::string opened_;  ///< name of the checkpoint that was read
};

}  // namespace aligngs
