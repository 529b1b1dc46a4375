// segments/ of a scene folder: the pixels of a photo that are one thing, as a panoptic network tells them apart.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "scene/scene.h"

namespace aligngs {

struct Segment {
  /// number of stuff, whose pixels are one segment whatever they belong to
  static constexpr uint16_t kStuff = 255;
  uint16_t label = 0;   ///< class, below 255
  uint16_t number = 0;  ///< within its class and photo: 0 .. 254 for things, or kStuff
  bool is_thing() const { return number != kStuff; }
};

/// The segments of one photo, at any resolution of its aspect.
struct SegmentMap {
  static constexpr uint16_t kNone = 0xffff;
  int width = 0, height = 0;
  std::vector<uint16_t> of_pixel;  ///< [height][width] index into `list`, or kNone
  std::vector<Segment> list;       ///< by class, then number
  bool empty() const { return of_pixel.empty(); }
};

/// PNG of 16 bits, one channel: 0 where there is no segment, else 1 + 256 class + number. Atomic. Error{kFailed} for a
/// class or number that does not fit.
void write_segments(const std::filesystem::path& file, const SegmentMap& segments);
/// `classes`: of the label set. Error{kBadInput} for another kind of file, and for a class that the set has not.
SegmentMap read_segments(const std::filesystem::path& file, int classes);

/// SCENE/segments/VIEW.png, whether it is there or not.
std::filesystem::path segment_file_of(const Scene& scene, const View& view);
/// Every training view has one.
bool has_segments(const Scene& scene);
/// Kind of file and aspect, from the header. Error{kBadInput}. Nothing happens where the view has none.
void check_segment_header(const Scene& scene, const View& view);

}  // namespace aligngs
