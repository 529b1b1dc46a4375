#include "scene/segment_file.h"

#include <algorithm>
#include <map>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/prior_maps.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t kPerClass = 256;  // numbers of a class, kStuff among them
constexpr const char* kRemedy = "make the segments again: aligngs priors SCENE --semantics eomt-panoptic --overwrite";

void require_kind(const fs::path& file, const ImageInfo& info) {
  if (info.bit_depth == 16 && info.channels == 1) return;
  throw_bad_input(file, "bits",
                  std::to_string(info.channels) + " channels of " + std::to_string(info.bit_depth) +
                      " bits; segments are 1 channel of 16 bits",
                  kRemedy);
}

}  // namespace

void write_segments(const fs::path& file, const SegmentMap& segments) {
  std::vector<uint16_t> values;
  for (const Segment& s : segments.list) {
    const uint32_t value = 1 + kPerClass * s.label + s.number;
    if (s.number >= kPerClass || value > 0xffff) {
      throw Error({ErrorKind::kFailed,
                   "a segment does not fit into 16 bits",
                   file,
                   "class " + std::to_string(s.label) + ", number " + std::to_string(s.number),
                   {}});
    }
    values.push_back(static_cast<uint16_t>(value));
  }
  Image<uint16_t> picture(segments.width, segments.height, 1);
  for (size_t p = 0; p < picture.data.size(); ++p) {
    const uint16_t segment = segments.of_pixel[p];
    picture.data[p] = segment == SegmentMap::kNone ? 0 : values.at(segment);
  }
  write_png16(file, picture);
}

SegmentMap read_segments(const fs::path& file, int classes) {
  require_kind(file, read_image_info(file));
  const Image<uint16_t> picture = read_gray_png(file);
  SegmentMap out;
  out.width = picture.width;
  out.height = picture.height;
  out.of_pixel.assign(picture.data.size(), SegmentMap::kNone);
  std::map<uint16_t, uint16_t> index;  // by value: by class, then number
  for (const uint16_t value : picture.data) {
    if (value > 0) index.emplace(value, uint16_t(0));
  }
  for (auto& [value, segment] : index) {
    const Segment s{static_cast<uint16_t>((value - 1) / kPerClass), static_cast<uint16_t>((value - 1) % kPerClass)};
    if (s.label >= classes) {
      throw_bad_input(file, "value " + std::to_string(value),
                      "class " + std::to_string(s.label) + ", the label set has " + std::to_string(classes), kRemedy);
    }
    segment = static_cast<uint16_t>(out.list.size());
    out.list.push_back(s);
  }
  for (size_t p = 0; p < picture.data.size(); ++p) {
    if (picture.data[p] > 0) out.of_pixel[p] = index.at(picture.data[p]);
  }
  return out;
}

fs::path segment_file_of(const Scene& scene, const View& view) {
  return scene.folder / "segments" / (view.name + ".png");
}

bool has_segments(const Scene& scene) {
  return !scene.train.empty() && std::all_of(scene.train.begin(), scene.train.end(), [&](int i) {
    return fs::is_regular_file(segment_file_of(scene, scene.views[static_cast<size_t>(i)]));
  });
}

void check_segment_header(const Scene& scene, const View& view) {
  const fs::path file = segment_file_of(scene, view);
  if (!fs::is_regular_file(file)) return;
  const ImageInfo info = read_image_info(file);
  require_kind(file, info);
  require_same_aspect({1, info.stored_height, info.stored_width}, view.camera.width, view.camera.height, file, "size");
}

}  // namespace aligngs
