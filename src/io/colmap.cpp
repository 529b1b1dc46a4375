// Format: https://colmap.github.io/format.html
#include "io/colmap.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/colmap_camera_models.h"
#include "io/colmap_text.h"
#include "io/colmap_validity.h"
#include "io/ply.h"
#include "io/ply_colors.h"
#include "io/text_tokens.h"
#include "io/waiting_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

std::vector<ColmapCamera> parse_cameras_binary(const std::string& bytes, const fs::path& name) {
  ByteReader reader(bytes, name);
  constexpr uint64_t kLeastBytes = 4 + 4 + 8 + 8 + 2 * 8;  // id, model, size, the two parameters of a panorama
  const uint64_t count = reader.count_of(reader.little<uint64_t>("count"), kLeastBytes, "number of cameras");
  std::vector<ColmapCamera> cameras(count);
  for (ColmapCamera& camera : cameras) {
    camera.id = reader.little<uint32_t>("camera id");
    const int model_id = reader.little<int32_t>("camera model");
    const ColmapCameraModel* model = find_colmap_camera_model(model_id);
    if (!model) {
      throw_bad_input(name, "model of camera " + std::to_string(camera.id),
                      "unknown camera model " + std::to_string(model_id), kUnknownCameraModelRemedy);
    }
    camera.model = model->name;
    camera.width = reader.little<uint64_t>("camera width");
    camera.height = reader.little<uint64_t>("camera height");
    camera.params.resize(model->parameters);
    for (double& value : camera.params) value = reader.little<double>("camera parameters");
  }
  if (reader.remaining() != 0) reader.fail("end", "bytes after the last camera");
  return cameras;
}

std::vector<ColmapImage> parse_images_binary(const std::string& bytes, const fs::path& name) {
  ByteReader reader(bytes, name);
  constexpr uint64_t kLeastBytes = 4 + 7 * 8 + 4 + 1 + 8;  // id, pose, camera, empty name, number of keypoints
  const uint64_t count = reader.count_of(reader.little<uint64_t>("count"), kLeastBytes, "number of images");
  std::vector<ColmapImage> images(count);
  for (ColmapImage& image : images) {
    image.id = reader.little<uint32_t>("image id");
    for (double* value : {&image.rotation.w, &image.rotation.x, &image.rotation.y, &image.rotation.z,
                          &image.translation.x, &image.translation.y, &image.translation.z}) {
      *value = reader.little<double>("pose");
    }
    image.camera_id = reader.little<uint32_t>("camera id of an image");
    while (const char c = reader.little<char>("name of an image")) image.name += c;
    constexpr uint64_t kKeypointBytes = 2 * 8 + 8;
    const uint64_t points = reader.count_of(reader.little<uint64_t>("number of keypoints"), kKeypointBytes,
                                            "number of keypoints of " + image.name);
    image.points.resize(points);
    image.point_ids.resize(points);
    for (uint64_t i = 0; i < points; ++i) {
      image.points[i].x = reader.little<double>("keypoint");
      image.points[i].y = reader.little<double>("keypoint");
      image.point_ids[i] = reader.little<int64_t>("keypoint");  // 2^64 - 1 on disk is -1: no point
    }
  }
  if (reader.remaining() != 0) reader.fail("end", "bytes after the last image");
  return images;
}

std::vector<ColmapPoint> parse_points_binary(const std::string& bytes, const fs::path& name) {
  ByteReader reader(bytes, name);
  constexpr uint64_t kLeastBytes = 8 + 3 * 8 + 3 + 8 + 8, kTrackBytes = 8;
  const uint64_t count = reader.count_of(reader.little<uint64_t>("count"), kLeastBytes, "number of points");
  std::vector<ColmapPoint> points(count);
  for (ColmapPoint& point : points) {
    point.id = reader.little<uint64_t>("point id");
    for (double* value : {&point.position.x, &point.position.y, &point.position.z}) {
      *value = reader.little<double>("point position");
    }
    for (uint8_t& channel : point.color) channel = reader.little<uint8_t>("point colour");
    point.error = reader.little<double>("point error");
    point.track.resize(reader.count_of(reader.little<uint64_t>("track length"), kTrackBytes, "track length"));
    for (auto& [image, keypoint] : point.track) {
      image = reader.little<uint32_t>("track");
      keypoint = reader.little<uint32_t>("track");
    }
  }
  if (reader.remaining() != 0) reader.fail("end", "bytes after the last point");
  return points;
}

/// "<folder>/<stem>.bin" or ".txt", whichever is there. The binary goes first, unless the text alone has cameras and
/// images: a file that another model left behind is not mixed with it.
std::optional<fs::path> find_file(const fs::path& folder, const std::string& stem) {
  const auto is_whole = [&](const char* extension) {
    return fs::is_regular_file(folder / (std::string("cameras") + extension)) &&
           fs::is_regular_file(folder / (std::string("images") + extension));
  };
  const bool text_first = is_whole(".txt") && !is_whole(".bin");
  for (const char* extension : {text_first ? ".txt" : ".bin", text_first ? ".bin" : ".txt"}) {
    const fs::path path = folder / (stem + extension);
    if (fs::is_regular_file(path)) return path;
  }
  return std::nullopt;
}

fs::path require_file(const fs::path& folder, const std::string& stem) {
  if (const auto path = find_file(folder, stem)) return *path;
  if (fs::exists(folder / "points3D.ply")) {
    throw_bad_input(folder / "points3D.ply", stem, "this is a cloud of points without cameras",
                    "put cameras and images (.bin or .txt) of the same model beside it");
  }
  throw_bad_input(folder, stem, "neither " + stem + ".bin nor " + stem + ".txt is there",
                  "give the folder of a COLMAP model");
}

bool is_model_folder(const fs::path& folder) { return find_file(folder, "cameras") && find_file(folder, "images"); }

/// A cheap look at how many images a file has: the binary count, or the image lines of the text.
uint64_t images_in(const fs::path& file) {
  if (file.extension() != ".bin") return parse_colmap_images_text(read_file(file), file).size();
  require_no_waiting(file);
  char bytes[8];
  std::ifstream stream(file, std::ios::binary);
  return stream.read(bytes, 8) ? load_number<uint64_t>(bytes, false) : 0;
}

uint64_t count_images(const fs::path& folder) {
  const auto path = find_file(folder, "images");
  return path ? images_in(*path) : 0;
}

/// A sentence where a model is there as binary and as text, and the two differ; else empty.
std::string choice_of_kind(const fs::path& folder) {
  const auto used_file = find_file(folder, "images");
  if (!used_file) return "";
  const fs::path other_file = folder / (used_file->extension() == ".bin" ? "images.txt" : "images.bin");
  if (!fs::is_regular_file(other_file)) return "";
  const uint64_t used = images_in(*used_file);
  uint64_t other = 0;
  try {
    other = images_in(other_file);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    return "";  // no model, and not used
  }
  if (used == other) return "";
  return used_file->string() + " is used, with " + std::to_string(used) + " images; " + other_file.filename().string() +
         " beside it has " + std::to_string(other);
}

/// The numbered models (0, 1, ...) of a mapper's output folder.
std::map<uint64_t, fs::path> numbered_models(const fs::path& folder) {
  std::map<uint64_t, fs::path> models;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    uint64_t number = 0;
    if (parse_number(entry->path().filename().string(), number) && is_model_folder(entry->path())) {
      models[number] = entry->path();
    }
  }
  return models;
}

/// The one of them with most images, the first of equals.
std::optional<fs::path> best_numbered_model(const fs::path& folder) {
  const std::map<uint64_t, fs::path> models = numbered_models(folder);
  if (models.size() <= 1) return models.empty() ? std::nullopt : std::optional(models.begin()->second);
  std::optional<fs::path> best;
  uint64_t most = 0;
  for (const auto& [number, path] : models) {
    const uint64_t images = count_images(path);
    if (!best || images > most) best = path, most = images;
  }
  return best;
}

/// Points of a PLY, in which 3DGS' tools keep them; there is no reprojection error and no track in it.
std::vector<ColmapPoint> points_of_ply(const fs::path& path) {
  const PlyFile file = read_ply(path);
  const PlyElement* vertices = file.find("vertex");
  const auto column = [&](const char* name) { return vertices ? vertices->find(name) : nullptr; };
  const PlyProperty* position[3] = {column("x"), column("y"), column("z")};
  if (!position[0] || !position[1] || !position[2])
    throw_bad_input(path, "vertex", "no x, y, z", "export the points again");
  const std::vector<Vec3f> colors = ply_colors(*vertices);
  constexpr uint8_t kUnknown = 128;  // mid grey
  std::vector<ColmapPoint> points(vertices->count);
  for (size_t i = 0; i < points.size(); ++i) {
    points[i].id = i + 1;
    for (int k = 0; k < 3; ++k) {
      points[i].position[k] = position[k]->values[i];
      points[i].color[k] = colors.empty() ? kUnknown : static_cast<uint8_t>(std::lround(255 * colors[i][k]));
    }
  }
  return points;
}

std::vector<fs::path> places_of_models(const fs::path& scene_folder) {
  return {scene_folder / "sparse", scene_folder, scene_folder / "colmap" / "sparse", scene_folder / "colmap"};
}

/// Folders in a folder that hold a model each, by name.
std::vector<fs::path> models_one_level_down(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (is_model_folder(entry->path())) found.push_back(entry->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The only model in a folder of another name beside images/, as ETH3D has it; empty where there is none.
fs::path model_beside_photos(const fs::path& scene_folder) {
  std::error_code error;
  if (!fs::is_directory(scene_folder / "images", error)) return {};
  const std::vector<fs::path> models = models_one_level_down(scene_folder);
  return models.size() == 1 ? models.front() : fs::path();
}

}  // namespace

ColmapModel decode_colmap_binary(const std::string& cameras, const std::string& images, const std::string& points,
                                 const std::filesystem::path& folder_for_errors) {
  const fs::path camera_path = folder_for_errors / "cameras.bin", image_path = folder_for_errors / "images.bin",
                 point_path = folder_for_errors / "points3D.bin";
  ColmapModel model;
  model.cameras = parse_cameras_binary(cameras, camera_path);
  model.images = parse_images_binary(images, image_path);
  if (!points.empty()) model.points = parse_points_binary(points, point_path);
  leave_out_invalid(model, camera_path, image_path);
  return model;
}

ColmapModel read_colmap_model(const std::filesystem::path& folder) {
  ColmapModel model;
  const auto is_binary = [](const fs::path& path) { return path.extension() == ".bin"; };
  const fs::path cameras = require_file(folder, "cameras"), images = require_file(folder, "images");
  const auto points = find_file(folder, "points3D");
  const std::string camera_bytes = read_file(cameras);
  model.cameras = is_binary(cameras) ? parse_cameras_binary(camera_bytes, cameras)
                                     : parse_colmap_cameras_text(camera_bytes, cameras);
  const std::string image_bytes = read_file(images);
  model.images =
      is_binary(images) ? parse_images_binary(image_bytes, images) : parse_colmap_images_text(image_bytes, images);
  if (points) {
    const std::string point_bytes = read_file(*points);
    model.points =
        is_binary(*points) ? parse_points_binary(point_bytes, *points) : parse_colmap_points_text(point_bytes, *points);
  } else if (fs::is_regular_file(folder / "points3D.ply")) {
    model.points = points_of_ply(folder / "points3D.ply");
  }
  leave_out_invalid(model, cameras, images);
  return model;
}

bool may_hold_colmap_model(const fs::path& scene_folder) {
  for (const char* name :
       {"sparse", "cameras.bin", "cameras.txt", "colmap/sparse", "colmap/cameras.bin", "colmap/cameras.txt"}) {
    if (fs::exists(scene_folder / name)) return true;
  }
  return !model_beside_photos(scene_folder).empty();
}

std::filesystem::path find_colmap_folder(const std::filesystem::path& scene_folder) {
  for (const fs::path& folder : places_of_models(scene_folder)) {
    if (const auto numbered = best_numbered_model(folder)) return *numbered;
    if (is_model_folder(folder)) return folder;
  }
  for (const fs::path& folder : {scene_folder / "sparse" / "0", scene_folder / "sparse", scene_folder}) {
    if (fs::exists(folder / "points3D.ply")) require_file(folder, "cameras");  // says what that file is
  }
  if (const fs::path beside = model_beside_photos(scene_folder); !beside.empty()) return beside;
  std::string deeper;
  for (const fs::path& model : models_one_level_down(scene_folder))
    deeper += (deeper.empty() ? "" : ", ") + model.string();
  throw_bad_input(
      scene_folder, "sparse", "no COLMAP model found (cameras and images, .bin or .txt)",
      deeper.empty() ? "put it into sparse/ or sparse/0/" : "name one of the folders that hold one: " + deeper);
}

std::string choice_of_model(const fs::path& scene_folder) {
  for (const fs::path& folder : places_of_models(scene_folder)) {
    const auto best = best_numbered_model(folder);
    if (!best && is_model_folder(folder)) return choice_of_kind(folder);
    if (!best) continue;
    std::string others;
    for (const auto& [number, path] : numbered_models(folder)) {
      if (path != *best)
        others += (others.empty() ? "" : ", ") + std::to_string(number) + " has " + std::to_string(count_images(path));
    }
    if (others.empty()) return choice_of_kind(*best);
    return "model " + best->filename().string() + " of " + folder.string() + " is used, with " +
           std::to_string(count_images(*best)) + " images (" + others + "); models of one mapper run share no world";
  }
  const fs::path beside = model_beside_photos(scene_folder);
  return beside.empty() ? "" : "the model in " + beside.string() + " is used";
}

}  // namespace aligngs
