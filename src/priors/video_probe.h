// The picture of a video, as ffprobe describes it.
#pragma once

#include <filesystem>
#include <string>

namespace aligngs {

struct VideoStream {
  int width = 0, height = 0;           ///< pixels, as shown: a quarter turn is undone
  double seconds = 0, frame_rate = 0;  ///< frame rate in frames a second, on the mean
  double frames = 0;                   ///< as the file counts them, else by length and rate
};

/// Reads what `ffprobe -show_streams -show_format -of json` prints for one stream of pictures. Error{kBadInput} that
/// names the video when there is none, or its size, length or frame rate makes no sense.
VideoStream parse_video_probe(const std::string& text, const std::filesystem::path& video);

}  // namespace aligngs
