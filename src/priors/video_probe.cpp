#include "priors/video_probe.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

/// The member of an object; null where there is none.
const Json& member(const Json& object, const char* name) {
  static const Json none;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() ? *found : none;
}

/// ffprobe writes some numbers as texts; 0 where there is none.
double number_of(const Json& value) {
  if (value.is_number()) return value.get<double>();
  return value.is_string() ? std::atof(value.get_ref<const std::string&>().c_str()) : 0;
}

/// "30000/1001".
double ratio_of(const Json& value) {
  double above = 0, below = 1;
  if (!value.is_string() || std::sscanf(value.get_ref<const std::string&>().c_str(), "%lf/%lf", &above, &below) < 1)
    return 0;
  return below > 0 ? above / below : 0;
}

/// A quarter turn, from the display matrix or the older tag.
bool is_turned(const Json& stream) {
  double degrees = number_of(member(member(stream, "tags"), "rotate"));
  const Json& list = member(stream, "side_data_list");
  if (list.is_array()) {
    for (const Json& data : list) {
      if (member(data, "rotation").is_number()) degrees = member(data, "rotation").get<double>();
    }
  }
  return std::abs(std::remainder(degrees, 180.0)) > 45;
}

}  // namespace

VideoStream parse_video_probe(const std::string& text, const std::filesystem::path& video) {
  const auto refuse = [&](const char* message) {
    throw_bad_input(video, "", message, "give a video that ffmpeg plays, or a folder of photos");
  };
  const Json document = parse_json(text);
  const Json& streams = member(document, "streams");
  if (!streams.is_array() || streams.empty()) refuse("it has no picture");
  const Json& stream = streams.front();
  constexpr double kLongestSide = 1 << 16;  // pixels, of any video format
  const auto side = [&](const char* name) {
    const double pixels = number_of(member(stream, name));
    return pixels >= 3 && pixels <= kLongestSide ? static_cast<int>(pixels) : 0;
  };
  VideoStream out{side("width"), side("height"), number_of(member(stream, "duration")),
                  ratio_of(member(stream, "avg_frame_rate")), number_of(member(stream, "nb_frames"))};
  if (is_turned(stream)) std::swap(out.width, out.height);
  if (!(out.seconds > 0)) out.seconds = number_of(member(member(document, "format"), "duration"));
  const bool known = out.width > 0 && out.height > 0 && out.seconds > 0 && std::isfinite(out.seconds) &&
                     out.frame_rate > 0 && std::isfinite(out.frame_rate);
  if (known && !(out.frames >= 1 && std::isfinite(out.frames)))
    out.frames = std::max(1.0, out.seconds * out.frame_rate);
  if (!known) refuse("its size, length or frame rate is missing");
  return out;
}

}  // namespace aligngs
