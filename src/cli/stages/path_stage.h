// Pictures of a room along the way of a camera: a video, a folder of pictures, or one picture.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "cli/stages/loaded_run.h"
#include "core/progress.h"

namespace aligngs {

struct PictureSize {
  int width = 1280, height = 720;  ///< pixels
};
/// "1920x1080". Error{kUsage} for anything else, and beyond 16 to 8192 pixels.
PictureSize parse_picture_size(const std::string& text);

struct PathStageOptions {
  std::string path;              ///< "orbit", "walk" or a file of key frames (scene/camera_path_json.h)
  std::filesystem::path output;  ///< FILE.mp4, FILE.png for one picture, else a folder that is absent or empty
  PictureSize size;
  double frames_per_second = 30;
  std::optional<double> seconds;  ///< of the whole way; absent: those of the file, or kTourSeconds
  double at = 0;                  ///< seconds from the begin: of the one picture
  ProgressStyle progress;
};

inline constexpr double kTourSeconds = 16;

struct PathPictures {
  std::filesystem::path output;  ///< what was written
  size_t frames = 0;
  double seconds = 0;
  bool video_missing = false;  ///< a video was asked for and ffmpeg is not installed: output is a folder of pictures
};

/// For before the run is opened, which takes seconds. Error{kUsage} for a place that is taken or belongs to the run,
/// and for a size that a video cannot have. Error{kBadInput} for key frames that cannot be read.
void require_path_place(const std::filesystem::path& run, const PathStageOptions& options);

/// Draws the Gaussians that the run's engine holds. Everything appears whole or not at all. Error{kUsage} for more
/// pictures than anybody wants, Error{kResources} of the disk, Error{kFailed} of ffmpeg.
PathPictures render_path(LoadedRun& run, const PathStageOptions& options);

/// One picture at the place of a photo, with its field of view. Error{kUsage} for a name that no view has.
void render_view_picture(LoadedRun& run, const std::string& view, const PictureSize& size,
                         const std::filesystem::path& file);

}  // namespace aligngs
