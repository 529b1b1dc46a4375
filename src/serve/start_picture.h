// The picture of a room that the page shows until its splats are drawn.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "serve/served_run.h"
#include "serve/start_pose.h"
#include "serve/view_server.h"

namespace aligngs {

/// From the start pose, 1056 x 704 pixels and 80 degrees high: what a wide or a tall page shows of it is a part.
class StartPicture {
 public:
  /// Begins to draw, on a thread of its own. `scene` as ServedRun's. `threads` draw; 0: all. Errors as ServedRun's.
  StartPicture(const std::filesystem::path& run, bool expect_run, const std::filesystem::path& scene, int threads);
  ~StartPicture();
  StartPicture(const StartPicture&) = delete;
  StartPicture& operator=(const StartPicture&) = delete;

  /// A JPEG file. A transparent pixel as a PNG file where there is no picture, as nobody waits for one. So it is while
  /// it is being drawn, during a training, with edits, without a start pose, and for splats of more than 512 MiB.
  GetAnswer picture();

  /// Adds GET /api/start.jpg. This must outlive the server.
  void serve(ViewServerOptions& options);

 private:
  /// The splats and the pose of a picture.
  struct Subject {
    std::string splats, version;
    StartPose pose;
  };
  std::optional<Subject> subject() const;
  void draw(const Subject& subject);

  ServedRun run_;
  int threads_;
  std::mutex mutex_;
  std::string version_;                      ///< of the picture, or of the one that is being drawn
  std::shared_ptr<const std::string> jpeg_;  ///< null while it is being drawn, and where that fails
  std::atomic<bool> drawing_{true};
  std::jthread work_;  // last: ends before what it uses
};

}  // namespace aligngs
