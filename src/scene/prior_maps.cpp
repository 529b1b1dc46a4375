#include "scene/prior_maps.h"

#include <cmath>

#include "core/error.h"
#include "io/npz.h"
#include "io/torch_archive.h"

namespace aligngs {
namespace {

bool is_torch(const std::filesystem::path& path) { return path.extension() == ".pt" || path.extension() == ".pth"; }
bool is_compressed(const std::filesystem::path& path) { return path.extension() == ".npz"; }

constexpr int64_t kMaxMapSide = 65535;  // pixels; keeps sizes in int

bool fits(int64_t side) { return side >= 1 && side <= kMaxMapSide; }

}  // namespace

std::string describe_shape(const std::vector<int64_t>& shape) {
  std::string out = "[";
  for (size_t i = 0; i < shape.size(); ++i) out += (i ? ", " : "") + std::to_string(shape[i]);
  return out + "]";
}

FloatArray read_map(const std::filesystem::path& path) {
  if (is_torch(path)) return read_torch_tensor(path);
  return is_compressed(path) ? read_npz(path) : read_npy(path);
}

ArrayHeader read_map_header(const std::filesystem::path& path) {
  if (is_torch(path)) return read_torch_tensor_header(path);
  return is_compressed(path) ? read_npz_header(path) : read_npy_header(path);
}

MapShape depth_map_shape(const std::vector<int64_t>& shape, const std::filesystem::path& path) {
  std::vector<int64_t> sides = shape;
  while (sides.size() > 2 && sides.front() == 1) sides.erase(sides.begin());
  while (sides.size() > 2 && sides.back() == 1) sides.pop_back();
  if (sides.size() != 2 || !fits(sides[0]) || !fits(sides[1])) {
    throw_bad_input(path, "shape", describe_shape(shape) + " is no depth map", "write an array [height, width]");
  }
  return {1, static_cast<int>(sides[0]), static_cast<int>(sides[1])};
}

MapShape semantic_map_shape(const std::vector<int64_t>& shape, int classes, const std::filesystem::path& path) {
  std::vector<int64_t> sides = shape;
  if (sides.size() == 4 && sides.front() == 1) sides.erase(sides.begin());
  if (sides.size() != 3 || sides[0] < 1 || !fits(sides[1]) || !fits(sides[2])) {
    throw_bad_input(path, "shape", describe_shape(shape) + " is no semantic map",
                    "write an array [classes, height, width]");
  }
  if (sides[0] != classes) {
    throw_bad_input(
        path, "shape",
        "the map has " + std::to_string(sides[0]) + " classes, the label set has " + std::to_string(classes),
        "give the scene a labels.csv that lists the map's classes, or compute the maps for these classes");
  }
  return {static_cast<int>(sides[0]), static_cast<int>(sides[1]), static_cast<int>(sides[2])};
}

bool has_same_aspect(const MapShape& shape, int image_width, int image_height) {
  const double expected_height = static_cast<double>(shape.width) * image_height / image_width;
  const double expected_width = static_cast<double>(shape.height) * image_width / image_height;
  // One pixel of the map, plus rounding: sizes such as 518 x 389 for 640 x 480 are what networks deliver.
  return std::abs(expected_height - shape.height) <= 1.0 + 1e-9 || std::abs(expected_width - shape.width) <= 1.0 + 1e-9;
}

void require_same_aspect(const MapShape& shape, int image_width, int image_height, const std::filesystem::path& path,
                         const char* field) {
  if (has_same_aspect(shape, image_width, image_height)) return;
  throw_bad_input(path, field,
                  std::to_string(shape.width) + " x " + std::to_string(shape.height) +
                      " has not the aspect of its image, " + std::to_string(image_width) + " x " +
                      std::to_string(image_height),
                  "compute the map from the uncropped image");
}

void check_depth_header(const View& view) {
  const MapShape shape = depth_map_shape(read_map_header(view.prior_depth).shape, view.prior_depth);
  require_same_aspect(shape, view.camera.width, view.camera.height, view.prior_depth, "shape");
}

void check_semantic_header(const View& view, const LabelSet& labels) {
  const MapShape shape = semantic_map_shape(read_map_header(view.semantics).shape, labels.size(), view.semantics);
  require_same_aspect(shape, view.camera.width, view.camera.height, view.semantics, "shape");
}

}  // namespace aligngs
