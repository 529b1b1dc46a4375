#include "scene/camera_path_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kFormat = "aligngs camera path";
constexpr int kVersion = 1;
constexpr uint64_t kLargest = uint64_t(1) << 20;  // bytes: a thousand keys have a fifth of it
constexpr size_t kMostKeys = 1000;
constexpr double kLongest = 3600;  // seconds
constexpr double kFarthest = 1e6;  // scene units from the origin

/// A reader that names the field of what is wrong.
class Reader {
 public:
  explicit Reader(std::filesystem::path file) : file_(std::move(file)) {}
  [[noreturn]] void fail(const std::string& field, const std::string& message) const {
    throw_bad_input(file_, field, message, "save the key frames on the page again; docs/page.md describes the file");
  }
  double number(const OrderedJson& value, const std::string& field, double low, double high) const {
    if (!value.is_number()) fail(field, "not a number");
    const double v = value.get<double>();
    if (!(v >= low && v <= high)) fail(field, "not within " + text(low) + " and " + text(high));
    return v;
  }
  Vec3d place(const OrderedJson& key, const char* name, const std::string& where) const {
    const std::string field = where + "." + name;
    if (!key.contains(name) || !key[name].is_array() || key[name].size() != 3)
      fail(field, "not a list of three numbers");
    Vec3d p;
    for (int k = 0; k < 3; ++k) p[k] = number(key[name][static_cast<size_t>(k)], field, -kFarthest, kFarthest);
    return p;
  }

 private:
  static std::string text(double v) {
    char out[32];
    std::snprintf(out, sizeof out, "%g", v);
    return out;
  }
  std::filesystem::path file_;
};

CameraKey read_key(const Reader& reader, const OrderedJson& json, const std::string& where) {
  if (!json.is_object()) reader.fail(where, "not an object");
  CameraKey key;
  if (!json.contains("time")) reader.fail(where + ".time", "the field is missing");
  key.time = reader.number(json["time"], where + ".time", 0, kLongest);
  key.eye = reader.place(json, "eye", where);
  key.target = reader.place(json, "target", where);
  if (norm(key.target - key.eye) < kShortestSight) reader.fail(where + ".target", "the same place as the eye");
  if (json.contains("fov")) key.fov = reader.number(json["fov"], where + ".fov", kNarrowestView, kWidestView);
  return key;
}

OrderedJson place_json(const Vec3d& p) { return {p.x, p.y, p.z}; }

}  // namespace

CameraPath parse_camera_path(std::string_view text, const std::filesystem::path& name_for_errors) {
  const Reader reader(name_for_errors);
  const OrderedJson json = parse_ordered_json(text);
  if (!json.is_object()) reader.fail("", "the file is no JSON object");
  if (!json.contains("format") || json["format"] != kFormat)
    reader.fail("format", std::string("not \"") + kFormat + "\"");
  if (!json.contains("version") || json["version"] != kVersion)
    reader.fail("version", "not 1: another version of the program wrote the file");
  if (!json.contains("keys") || !json["keys"].is_array()) reader.fail("keys", "not a list");
  const OrderedJson& keys = json["keys"];
  if (keys.empty() || keys.size() > kMostKeys) reader.fail("keys", "a path has 1 to 1000 keys");
  CameraPath path;
  for (size_t i = 0; i < keys.size(); ++i) {
    const std::string where = "keys[" + std::to_string(i) + "]";
    path.keys.push_back(read_key(reader, keys[i], where));
    if (i > 0 && !(path.keys[i].time > path.keys[i - 1].time)) reader.fail(where + ".time", "not after the key before");
  }
  return path;
}

CameraPath read_camera_path(const std::filesystem::path& file) {
  return parse_camera_path(read_file(file, kLargest), file);
}

std::string camera_path_json(const CameraPath& path) {
  OrderedJson keys = OrderedJson::array();
  for (const CameraKey& key : path.keys) {
    keys.push_back(
        {{"time", key.time}, {"eye", place_json(key.eye)}, {"target", place_json(key.target)}, {"fov", key.fov}});
  }
  return json_document(OrderedJson{{"format", kFormat}, {"version", kVersion}, {"keys", keys}});
}

}  // namespace aligngs
