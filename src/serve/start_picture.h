// The picture of a room that the page shows until its splats are drawn.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "gaussians/gaussian_model.h"
#include "serve/served_run.h"
#include "serve/start_pose.h"
#include "serve/view_server.h"

namespace aligngs {

/// From the start pose, 1056 x 704 pixels and 80 degrees high: what a wide or a tall page shows of it is a part.
class StartPicture {
 public:
  /// Begins to draw, on a thread of its own. `scene` as ServedRun's. `threads` draw; 0: all. `drawing` is held meanwhile:
  /// two pictures at a time would need twice the memory. Errors as ServedRun's.
  StartPicture(const std::filesystem::path& run, bool expect_run, const std::filesystem::path& scene, int threads,
               std::mutex* drawing = nullptr);
  ~StartPicture();
  StartPicture(const StartPicture&) = delete;
  StartPicture& operator=(const StartPicture&) = delete;

  /// A JPEG file. A transparent pixel as a PNG file where there is no picture, as nobody waits for one. So it is while
  /// it is being drawn, without a start pose, and for splats of more than 512 MiB. During a training it is the picture
  /// of the splats that a page last asked for. With edits it is that of edited().
  GetAnswer picture();

  /// The edited room has these splats from now on. They are drawn when it has been left alone for two seconds. From any
  /// thread.
  void edited(const GaussianModel& model);

  /// Adds GET /api/start.jpg. This must outlive the server.
  void serve(ViewServerOptions& options);

 private:
  /// The three rooms that a run may show, each with a picture of its own.
  enum class Room { kTrained, kEdited, kInTraining };
  struct Subject {
    Room room;
    std::string splats, version;
    StartPose pose;
  };
  struct Work {
    Subject subject;
    std::optional<GaussianModel> model;  ///< what the camera may see; nothing: read from the file
  };
  struct Picture {
    std::string version;                      ///< of what is drawn, or is being drawn
    std::shared_ptr<const std::string> jpeg;  ///< null where drawing fails
    std::string drawn;                        ///< version of `jpeg`
  };

  std::optional<Subject> subject() const;
  Picture& picture_of(Room room) { return pictures_[static_cast<size_t>(room)]; }
  void ask_for(Work work);                        ///< with mutex_; takes the place of work that has not begun
  bool was_undone(const Subject& subject) const;  ///< the edits of the run are others now
  void draw_what_is_asked(const std::stop_token& stop);
  std::shared_ptr<const std::string> drawn(Work work);

  ServedRun run_;
  int threads_;
  std::mutex own_drawing_;
  std::mutex& drawing_;
  std::mutex mutex_;
  std::condition_variable_any asked_;
  std::optional<Work> next_;
  Picture pictures_[3];
  std::jthread work_;  // last: ends before what it uses
};

}  // namespace aligngs
