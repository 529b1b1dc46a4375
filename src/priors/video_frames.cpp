#include "priors/video_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "core/log.h"
#include "io/file_system_error.h"
#include "priors/child_process.h"
#include "priors/frame_choice.h"
#include "priors/video_probe.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr size_t kFewestFrames = 2;    // of a video: one photo tells no depth
constexpr int kCandidatesPerView = 8;  // a hand shakes for a fraction of a step between two photos
constexpr int kFrameSmallWidth = 384;  // pixels of a candidate: enough to tell blur of more than a few pixels

[[noreturn]] void refuse(const fs::path& video, const std::string& message) {
  throw_bad_input(video, "", message, "give a video that ffmpeg plays, or a folder of photos");
}

/// The last line of messages; ffprobe mixes them with the braces of an empty answer.
std::string last_line(const std::string& text) {
  std::istringstream lines(text);
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    if (line.find_first_not_of("{}[], \t\r") != std::string::npos) last = line;
  }
  return last;
}

[[noreturn]] void refuse_few(const fs::path& video, size_t frames) {
  refuse(video, fmt::format("it has {} frame{}, and two are needed", frames, frames == 1 ? "" : "s"));
}

VideoStream stream_of(const fs::path& video) {
  std::string text;
  const ChildResult result = run_child({"ffprobe", "-v", "error", "-select_streams", "v:0", "-show_streams",
                                        "-show_format", "-of", "json", video.string()},
                                       "/dev/null", [&](const std::string& line) { text += line + "\n"; });
  if (result.status != 0) refuse(video, "ffprobe cannot read it: " + last_line(result.last_lines));
  const VideoStream stream = parse_video_probe(text, video);
  const auto frames = size_t(std::lround(stream.frames));
  if (frames < kFewestFrames) refuse_few(video, frames);
  return stream;
}

VideoStream readable_stream(const fs::path& video) {
  if (!fs::is_regular_file(video))
    throw_bad_input(video, "", "there is no such file", "give a video, or a folder of photos");
  if (find_program("ffmpeg").empty() || find_program("ffprobe").empty()) {
    throw Error({ErrorKind::kFailed, "a video needs the program ffmpeg, which is not in PATH", video, "",
                 "apt-get install ffmpeg, or give a folder of photos"});
  }
  return stream_of(video);
}

/// A run of ffmpeg with progress; `filter` ends with what makes the frames.
void run_ffmpeg(const fs::path& video, const std::string& filter, const std::vector<std::string>& output,
                const fs::path& log, double seconds, const std::string& name, ProgressStyle style) {
  std::vector<std::string> arguments = {"ffmpeg", "-nostdin",     "-y",   "-v",    "error", "-progress", "pipe:1",
                                        "-i",     video.string(), "-map", "0:v:0", "-an",   "-vf",       filter};
  arguments.insert(arguments.end(), output.begin(), output.end());
  constexpr double kUnits = 1e3;  // of progress, a second
  Progress progress(style, name, std::max<uint64_t>(1, uint64_t(seconds * kUnits)));
  const ChildResult result = run_child(arguments, log, [&](const std::string& line) {
    constexpr const char* kTime = "out_time_us=";
    if (line.rfind(kTime, 0) == 0)
      progress.update(
          std::min(uint64_t(std::max(0.0, std::atof(line.c_str() + 12)) * kUnits / 1e6), uint64_t(seconds * kUnits)));
  });
  refuse_full_disk(log.parent_path());  // ffmpeg may end well with half a file
  if (result.status != 0) refuse(video, "ffmpeg cannot read it: " + last_line(result.last_lines));
}

struct FrameChoiceFilter {
  bool whole = false;  ///< every frame is looked at
  std::string begin;   ///< of the filter
  const char* sync;    ///< of ffmpeg: how frames follow each other in the output
};

/// Neighbours at a higher rate are the same picture. A clip so short that too few are left is looked at whole.
FrameChoiceFilter filter_of(const VideoStream& stream, int views) {
  const double wanted = double(views) * kCandidatesPerView / stream.seconds;
  const double rate = std::min(wanted, double(kMostVideoRate));
  if (stream.frames <= views || kMostVideoRate * stream.seconds <= views || rate >= stream.frame_rate)
    return {true, "", "passthrough"};
  return {false, fmt::format("fps={:.6f},", rate), "cfr"};
}

/// Measures of every candidate, in the order of ffmpeg's frames.
std::vector<FrameFeatures> features_of(const fs::path& raw, int width, int height) {
  std::ifstream in(raw, std::ios::binary);
  std::vector<FrameFeatures> features;
  FrameMeter meter;
  Image<uint8_t> frame(width, height, 1);
  while (in.read(reinterpret_cast<char*>(frame.data.data()), static_cast<std::streamsize>(frame.data.size())))
    features.push_back(meter.measure(frame));
  return features;
}

}  // namespace

void require_readable_video(const fs::path& video) { readable_stream(video); }

VideoFramesReport take_video_frames(const fs::path& video, const fs::path& folder, const VideoFramesOptions& options) {
  const VideoStream stream = readable_stream(video);
  make_folders(folder);
  const FrameChoiceFilter filter = filter_of(stream, options.views);
  const int width = std::min(stream.width, kFrameSmallWidth),
            height = std::max(3, int(double(stream.height) * width / stream.width + 0.5));
  const fs::path raw = folder / "candidates.raw", log = folder / "ffmpeg.log";
  run_ffmpeg(video, fmt::format("{}scale={}:{}:flags=area,format=gray", filter.begin, width, height),
             {"-vsync", filter.sync, "-f", "rawvideo", raw.string()}, log, stream.seconds, "look at the video",
             options.progress);
  const std::vector<FrameFeatures> features = features_of(raw, width, height);
  fs::remove(raw);
  const std::vector<size_t> chosen = choose_frames(features, size_t(options.views));
  if (chosen.size() < kFewestFrames) refuse_few(video, features.size());

  // The same filter gives the same candidates, so that their numbers name frames of full size.
  std::string select = filter.begin + "select='";
  for (size_t i = 0; i < chosen.size(); ++i) select += fmt::format("{}eq(n\\,{})", i ? "+" : "", chosen[i]);
  constexpr const char* kBestQuality = "2";  // of ffmpeg's scale for JPEG, 1 to 31
  run_ffmpeg(video, select + "'",
             {"-vsync", filter.whole ? filter.sync : "vfr", "-q:v", kBestQuality, "-pix_fmt", "yuvj420p",
              (folder / "frame_%05d.jpg").string()},
             log, stream.seconds, "take frames", options.progress);
  const auto counted = size_t(std::lround(stream.frames));
  VideoFramesReport report{chosen.size(), features.size(), filter.whole ? features.size() : counted, stream.seconds, 1};
  const auto [darkest, brightest] = std::minmax_element(chosen.begin(), chosen.end(), [&](size_t a, size_t b) {
    return features[a].brightness < features[b].brightness;
  });
  report.exposure_walk = features[*brightest].brightness / std::max(features[*darkest].brightness, 1e-3);
  return report;
}

}  // namespace aligngs
