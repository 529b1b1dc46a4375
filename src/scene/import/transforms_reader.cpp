// transforms.json of nerfstudio and instant-ngp, or Blender's transforms_train.json and transforms_test.json
// (transforms_val.json):
// OpenGL camera-to-world per frame, a lens for all of them or for each. transforms_fields.h has what the fields mean.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/foreign_content.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "io/text_encoding.h"
#include "scene/import/capture_frames.h"
#include "scene/import/capture_text.h"
#include "scene/import/json_number.h"
#include "scene/import/transforms_fields.h"
#include "scene/import/transforms_place.h"
#include "scene/mesh_ply.h"
#include "scene/photo_places.h"
#include "scene/view_names.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// A document with a list of frames.
struct Transforms {
  fs::path file;
  Json document;
};

Transforms read_document(const fs::path& file) {
  const std::string content = read_file(file);
  const std::string text = without_comments(as_utf8(text_of_file(content, file)));  // old programs write latin-1
  Transforms transforms{file, parse_json(text)};
  const Json& document = transforms.document;
  if (document.is_discarded()) {
    refuse_foreign_content(text, file);
    throw_bad_input(file, place_of_json_fault(text), "this is no valid JSON", "correct this place");
  }
  if (!document.is_object() || !document.contains("frames") || !document["frames"].is_array()) {
    throw_bad_input(file, "frames", "this is no transforms.json", "expected a JSON object with a list \"frames\"");
  }
  return transforms;
}

/// Camera-to-world in OpenGL axes as world-to-camera in OpenCV ones. A matrix that scales space does so to depth as
/// well.
Rigidd pose_of(const Json& matrix, const fs::path& file, const std::string& field, double& scale) {
  std::vector<double> m;
  const auto add = [&](const Json& entry, const std::string& place) {
    if (!is_number_of_json(entry)) throw_bad_input(file, place, no_number(entry), "correct the matrix");
    m.push_back(number_of_json(entry));
  };
  size_t index = 0;
  for (const Json& row : matrix) {  // rows, or all numbers in one list
    const std::string place = fmt::format("{}[{}]", field, index++);
    size_t column = 0;
    if (!row.is_array())
      add(row, place);
    else
      for (const Json& entry : row) add(entry, fmt::format("{}[{}]", place, column++));
  }
  if (m.size() != 16 && m.size() != 12) throw_bad_input(file, field, "expected 4x4 numbers", "correct the matrix");
  return opencv_world_to_camera_from_opengl(rigid_from_scaled_matrix(m, file, field, scale));
}

/// A file that the document names, below its folder. A path of another machine counts by its last parts. If nothing is
/// there: the place where it should be.
fs::path named_file(const PhotoLookup& files, const fs::path& folder, const std::string& given) {
  const std::string name = slashed_name(given);
  if (const fs::path found = files.find(name).file; !found.empty()) return found;
  std::error_code error;
  if (!is_absolute_name(name)) {
    const fs::path decoded = folder / percent_decoded(name);
    return fs::is_regular_file(decoded, error) ? decoded : folder / name;
  }
  for (fs::path rest = fs::path(name).relative_path(); rest.has_parent_path();) {  // never a bare name
    if (fs::is_regular_file(folder / rest, error)) return folder / rest;
    fs::path shorter;
    for (auto part = std::next(rest.begin()); part != rest.end(); ++part) shorter /= *part;
    rest = shorter;
  }
  return folder / name;
}

/// Scene units per stored depth value, of the frame or the file; 0 where neither says it. Files without depth may say 0.
double depth_unit_of(const TransformsFields& fields, bool has_depth, const fs::path& file) {
  for (const char* name : {"depth_unit_scale_factor", "integer_depth_scale"}) {
    const double unit = fields.number(name, 0);
    if (unit > 0) return unit;
    if (unit < 0 || (has_depth && fields.find(name) != nullptr))
      throw_bad_input(file, name, "a positive number expected", "scene units per stored depth value");
  }
  return 0;
}

class FrameReader {
 public:
  FrameReader(const Transforms& transforms, const PhotoLookup& photos, Capture& capture, fs::path masks)
      : transforms_(transforms),
        photos_(photos),
        capture_(capture),
        folder_(transforms.file.parent_path()),
        masks_(std::move(masks)),
        files_({}, folder_) {}

  CapturedFrame read(const Json& item, const std::string& field) const {
    CapturedFrame frame;
    const std::string path = slashed_name(item.at("file_path").get<std::string>());
    const PhotoLookup::Answer photo = photos_.find(path);
    if (photo.file.empty()) throw_bad_input({}, "", photo.problem, "put the photo where file_path says");
    const auto bad = item.find("is_bad");  // ScanNet++'s
    if (bad != item.end() && bad->is_boolean() && bad->get<bool>())
      throw_bad_input({}, "", "is_bad says that the photo is bad", "set it to false to use the photo");
    frame.name = path;
    frame.image = photo.file;
    const TransformsFields fields(transforms_.document, item, transforms_.file);
    frame.world_to_camera =
        pose_of(item.at("transform_matrix"), transforms_.file, field + ".transform_matrix", frame.depth_scale);
    const ImageInfo info = read_image_info(frame.image);
    set_camera(frame, fields.camera(info.stored_width, info.stored_height), transforms_.file);
    frame.depth = depth(fields);
    if (const double unit = depth_unit_of(fields, !frame.depth.empty(), transforms_.file); unit > 0)
      frame.depth_scale *= unit / capture_.depth_unit;
    if (const std::string mask = fields.text("mask_path"); !mask.empty()) {
      frame.mask = named_file(files_, folder_, mask);
      if (!masks_.empty() && !fs::is_regular_file(frame.mask)) frame.mask = masks_ / slashed_name(mask);
      if (!fs::is_regular_file(frame.mask))
        throw_bad_input(frame.mask, "mask_path", "the mask is missing", "add it, or remove mask_path");
    }
    note_lens(fields, info);
    return frame;
  }

  /// To be called after the last frame.
  void note_missing_depth() const {
    if (depths_named_ > 0 && depths_found_ == 0)
      note_once("depth_file_path: none of its files is there, so depth is not used");
  }

 private:
  fs::path depth(const TransformsFields& fields) const {
    const std::string path = slashed_name(fields.text("depth_file_path").empty() ? fields.text("depth_path")
                                                                                 : fields.text("depth_file_path"));
    if (path.empty()) return {};
    const fs::path file = named_file(files_, folder_, path);
    if (file.extension() != ".png" && file.extension() != ".PNG") {
      note_once("depth in " + file.extension().string() + " files is not read and not used: 16-bit PNG is");
      return {};
    }
    ++depths_named_;
    if (!fs::is_regular_file(file)) return {};
    ++depths_found_;
    return file;
  }

  void note_lens(const TransformsFields& fields, const ImageInfo& info) const {
    if (fields.number("fisheye_crop_radius", 0) != 0)
      note_once("fisheye_crop_radius is not used: pixels outside of the circle count; mask_path can leave them out");
    if (const Json* shutter = fields.find("rolling_shutter")) {
      const bool any = !shutter->is_array() || std::any_of(shutter->begin(), shutter->end(), [](const Json& v) {
        return !v.is_number() || v.get<double>() != 0;
      });
      if (any) note_once("rolling_shutter is not used: every photo counts as taken at one moment");
    }
    for (const std::string& note : fields.contradictions(info.stored_width, info.stored_height)) note_once(note);
    if (fields.find("time")) note_once("time is not used: the scene counts as one that does not move");
  }

  void note_once(const std::string& note) const {
    const std::string line = transforms_.file.filename().string() + ": " + note;
    if (std::find(capture_.notes.begin(), capture_.notes.end(), line) == capture_.notes.end())
      capture_.notes.push_back(line);
  }

  const Transforms& transforms_;
  const PhotoLookup& photos_;
  Capture& capture_;
  fs::path folder_, masks_;
  PhotoLookup files_;  ///< masks and depth
  mutable size_t depths_named_ = 0, depths_found_ = 0;
};

/// Adds the frames of a list of a file; returns their names as the file writes them.
std::vector<std::string> add_frames(const Transforms& transforms, const PhotoLookup& photos, Capture& capture,
                                    const fs::path& masks, const char* list = "frames") {
  const FrameReader reader(transforms, photos, capture, masks);
  std::vector<std::string> names;
  size_t index = 0;
  for (const Json& item : transforms.document[list]) {
    const std::string field = list + std::string("[") + std::to_string(index++) + "]";
    const bool has_path = item.is_object() && item.contains("file_path") && item["file_path"].is_string();
    const std::string name = has_path ? slashed_name(item["file_path"].get<std::string>()) : field;
    names.push_back(name);
    add_frame(capture, name, [&] {
      if (!has_path || !item.contains("transform_matrix"))
        throw_bad_input(transforms.file, field, "a frame needs file_path and transform_matrix", "correct the frame");
      return reader.read(item, field);
    });
  }
  reader.note_missing_depth();
  return names;
}

/// Unknown keys of the file and of its frames, once.
void note_unknown(const Transforms& transforms, Capture& capture) {
  std::set<std::string> unknown;
  for (const std::string& key : unknown_fields(transforms.document)) unknown.insert(key);
  for (const Json& item : transforms.document["frames"]) {
    if (!item.is_object()) continue;
    for (const std::string& key : unknown_fields(item)) unknown.insert("frames." + key);
  }
  if (unknown.empty()) return;
  std::string list;
  for (const std::string& key : unknown) list += (list.empty() ? "" : ", ") + as_utf8(key);
  capture.notes.push_back(transforms.file.filename().string() +
                          ": fields that are not known here and not used: " + list);
}

/// Names of a list as names of frames; those of frames that were left out stay recognisable.
void name_split(Capture& capture) {
  const FrameNames names(capture.frames);
  for (std::vector<std::string>* list : {&capture.train, &capture.test}) {
    for (std::string& name : *list) {
      const int frame = names.find(name);
      name = frame >= 0 ? capture.frames[static_cast<size_t>(frame)].name : as_utf8(name);
    }
  }
}

std::vector<std::string> listed_names(const Transforms& transforms, std::initializer_list<const char*> keys) {
  std::vector<std::string> names;
  for (const char* key : keys) {
    const auto found = transforms.document.find(key);
    if (found == transforms.document.end()) continue;
    if (!found->is_array()) throw_bad_input(transforms.file, key, "expected a list of file names", "correct the value");
    for (const Json& name : *found) {
      if (name.is_string()) names.push_back(slashed_name(name.get<std::string>()));
    }
  }
  return names;
}

CapturedCloud read_points(const fs::path& file, Capture& capture) {
  if (!fs::is_regular_file(file))
    throw_bad_input(file, "ply_file_path", "the points are missing", "add the file, or remove ply_file_path");
  CloudFile points = read_cloud_file(file);
  if (points.left_out > 0) capture.notes.push_back(note_of_unusable_points(points.left_out));
  CapturedCloud cloud;
  cloud.positions = std::move(points.positions);
  cloud.colors = std::move(points.cloud.colors);
  return cloud;
}

void set_depth_unit(const Transforms& transforms, Capture& capture) {
  const TransformsFields fields(transforms.document, transforms.document, transforms.file);
  if (const double unit = depth_unit_of(fields, false, transforms.file); unit > 0) capture.depth_unit = unit;
}

}  // namespace

bool may_hold_transforms(const fs::path& folder) {
  return fs::is_regular_file(folder / "transforms.json") || fs::is_regular_file(folder / "transforms_train.json") ||
         !transforms_place(folder).photos.empty();
}

Capture read_transforms(const fs::path& folder, const CaptureOptions&) {
  const TransformsPlace place = transforms_place(folder);
  return read_transforms(folder,
                         PhotoLookup(place.photos.empty() ? images_folder(folder) : place.photos, place.folder));
}

Capture read_transforms(const fs::path& given, const PhotoLookup& photos) {
  const TransformsPlace place = transforms_place(given, photos.photos());
  const fs::path& folder = place.folder;
  Capture capture;
  capture.layout = "nerfstudio";
  capture.folder = given;
  capture.up = Vec3d{0, 0, 1};
  capture.up_source = "nerfstudio's convention (+z)";
  const fs::path document = folder / (place.undistorted ? "transforms_undistorted.json" : "transforms.json");
  if (fs::is_regular_file(document)) {
    const Transforms transforms = read_document(document);
    set_depth_unit(transforms, capture);
    const std::vector<std::string> frames = add_frames(transforms, photos, capture, place.masks);
    capture.train = listed_names(transforms, {"train_filenames"});
    capture.test = listed_names(transforms, {"test_filenames", "val_filenames"});
    if (const auto held_out = transforms.document.find("test_frames");
        held_out != transforms.document.end() && held_out->is_array()) {  // ScanNet++'s
      const std::vector<std::string> test = add_frames(transforms, photos, capture, place.masks, "test_frames");
      if (capture.train.empty()) capture.train = frames;
      capture.test.insert(capture.test.end(), test.begin(), test.end());
    }
    const std::string ply =
        TransformsFields(transforms.document, transforms.document, transforms.file).text("ply_file_path");
    if (!ply.empty()) capture.cloud = read_points(named_file(PhotoLookup({}, folder), folder, ply), capture);
    note_unknown(transforms, capture);
  } else {
    const bool has_test = fs::is_regular_file(folder / "transforms_test.json");
    for (const char* split : {"train", "test", "val"}) {
      const fs::path file = folder / (std::string("transforms_") + split + ".json");
      if (!fs::is_regular_file(file)) continue;
      if (split == std::string("val") && has_test) {
        capture.notes.push_back("transforms_val.json is not used: test views are those of transforms_test.json");
        continue;
      }
      const Transforms transforms = read_document(file);
      if (split == std::string("train")) set_depth_unit(transforms, capture);
      const std::vector<std::string> names = add_frames(transforms, photos, capture, {});
      (split == std::string("train") ? capture.train : capture.test) = names;
      note_unknown(transforms, capture);
    }
  }
  shorten_names(capture);
  name_split(capture);
  return capture;
}

}  // namespace aligngs
