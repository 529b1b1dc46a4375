// Photos from a video: sharp, well-spread frames, taken out of it by the program ffmpeg.
#pragma once

#include <filesystem>

#include "core/progress.h"

namespace aligngs {

struct VideoFramesOptions {
  int views = 40;  ///< frames to take, at most; the length of a capture by hand
  ProgressStyle progress;
};

struct VideoFramesReport {
  size_t frames = 0;     ///< taken
  size_t looked_at = 0;  ///< candidates, spread evenly over the video
  size_t in_video = 0;   ///< all frames
  double seconds = 0;    ///< length of the video
  /// brightest over darkest of the frames taken, by mean grey value: an automatic exposure changes it
  double exposure_walk = 1;
};

/// Error{kBadInput} without such a file, or where ffprobe finds no picture or fewer than two frames. Error{kFailed} where
/// ffmpeg or ffprobe is not in PATH. The frames themselves are not read.
void require_readable_video(const std::filesystem::path& video);

/// At most kMostVideoRate frames a second are looked at, and all of a clip that has few.
inline constexpr int kMostVideoRate = 15;

/// Writes the frames as frame_00001.jpg, ... into `folder`, turned as the video is shown. Error{kFailed}: ffmpeg is not
/// installed. Error{kBadInput}: no video can be read, or it has fewer than two frames.
VideoFramesReport take_video_frames(const std::filesystem::path& video, const std::filesystem::path& folder,
                                    const VideoFramesOptions& options);

}  // namespace aligngs
