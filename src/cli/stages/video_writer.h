// A video file written by ffmpeg, picture by picture.
#pragma once

#include <sys/types.h>

#include <filesystem>

#include "core/image.h"

namespace aligngs {

/// Whether ffmpeg is in PATH.
bool can_write_video();

/// H.264 in an MP4 file. Pictures go to a child process; the file has a temporary name until commit(), and is removed
/// without it.
class VideoWriter {
 public:
  /// Starts ffmpeg. `width`, `height`: even. Error{kFailed} when it cannot be started, Error{kResources} for a place
  /// that cannot be written to.
  VideoWriter(std::filesystem::path file, int width, int height, double frames_per_second);
  ~VideoWriter();  ///< ends ffmpeg
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// The next picture: RGB of the size given. Error{kFailed} with what ffmpeg said when it has ended.
  void add(const Image<uint8_t>& picture);
  /// Waits for ffmpeg, then the file takes its place. A stop point (core/stop_signal.h).
  void commit();

 private:
  [[noreturn]] void fail();
  int wait();
  void end();

  std::filesystem::path file_, temporary_, log_;
  int to_child_ = -1;
  pid_t child_ = -1;
};

}  // namespace aligngs
