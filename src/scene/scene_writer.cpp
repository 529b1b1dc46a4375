#include "scene/scene_writer.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/half.h"
#include "core/is_depth.h"
#include "io/atomic_file.h"
#include "io/colmap.h"
#include "io/file_system_error.h"
#include "io/image_file.h"
#include "io/npy.h"
#include "io/npz.h"
#include "io/ply.h"
#include "scene/colmap_model.h"
#include "scene/confidence_file.h"
#include "scene/mesh_ply.h"
#include "scene/photo_mask.h"
#include "scene/prior_maps.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& message, const fs::path& path, const std::string& field) {
  throw Error({ErrorKind::kFailed, message, path, field, {}});
}

/// Runs a file-system operation and turns its failure into Error{kResources}.
template <class Operation>
void on_disk(const fs::path& path, const char* what, Operation operation) {
  std::error_code error;
  operation(error);
  error = cause_of_write(error, path);
  if (error) throw_resources(path, std::string(what) + ": " + error.message(), remedy_for_write(error.value()));
}

void make_folder(const fs::path& path) {
  on_disk(path, "the folder cannot be made", [&](std::error_code& error) { fs::create_directories(path, error); });
}

void copy_into_place(const fs::path& from, const fs::path& to) {
  if (!fs::is_regular_file(from)) throw_bad_input(from, "file", "missing", "check the path");
  make_folder(to.parent_path());
  on_disk(to, "the file cannot be copied", [&](std::error_code& error) { fs::copy_file(from, to, error); });
}

fs::path free_place(fs::path folder, bool overwrite, const std::vector<fs::path>& sources) {
  require_scene_place(folder, overwrite, sources);
  return folder;
}

std::vector<uint16_t> to_half(const std::vector<float>& values) {
  std::vector<uint16_t> half(values.size());
  std::transform(values.begin(), values.end(), half.begin(), float_to_half);
  return half;
}

void write_depth(const fs::path& path, const SceneViewParts& view) {
  const ImageF& depth = view.prior_depth;
  const std::vector<int64_t> shape = {depth.height, depth.width};
  make_folder(path.parent_path());
  if (view.half_depth) {
    write_npy_float16(path, shape, to_half(depth.data).data());
  } else {
    write_npy_float32(path, shape, depth.data.data());
  }
}

void write_truth_depth(const fs::path& path, const ImageF& depth) {
  Image<uint16_t> millimetres(depth.width, depth.height, 1);
  for (size_t i = 0; i < depth.data.size(); ++i) {
    const float z = depth.data[i];
    if (is_depth(z)) {
      millimetres.data[i] = static_cast<uint16_t>(std::clamp(std::round(z * 1000.0f), 1.0f, 65535.0f));
    }
  }
  make_folder(path.parent_path());
  write_png16(path, millimetres);
}

void write_truth_labels(const fs::path& path, const Image<uint16_t>& labels) {
  Image<uint8_t> bytes(labels.width, labels.height, 1, 255);
  for (size_t i = 0; i < labels.data.size(); ++i) {
    if (labels.data[i] == kNoLabel) continue;
    if (labels.data[i] >= 255) fail("a label does not fit into uint8", path, "label " + std::to_string(labels.data[i]));
    bytes.data[i] = static_cast<uint8_t>(labels.data[i]);
  }
  make_folder(path.parent_path());
  write_png(path, bytes);
}

PlyProperty column(const char* name, PlyType type, size_t rows) {
  PlyProperty property;
  property.name = name;
  property.type = type;
  property.values.reserve(rows);
  return property;
}

}  // namespace

void write_cloud_ply(const fs::path& path, const PointCloud& cloud) {
  PlyElement vertex;
  vertex.name = "vertex";
  vertex.count = cloud.size();
  const auto add_columns = [&](std::initializer_list<const char*> names, PlyType type, const std::vector<Vec3f>& rows,
                               float scale) {
    int k = 0;
    for (const char* name : names) {
      PlyProperty property = column(name, type, rows.size());
      for (const Vec3f& row : rows) {
        const double value = static_cast<double>(row[k]) * scale;
        property.values.push_back(type == PlyType::kUint8 ? std::round(std::clamp(value, 0.0, 255.0)) : value);
      }
      vertex.properties.push_back(std::move(property));
      ++k;
    }
  };
  add_columns({"x", "y", "z"}, PlyType::kFloat32, cloud.positions, 1);
  if (cloud.has_normals()) add_columns({"nx", "ny", "nz"}, PlyType::kFloat32, cloud.normals, 1);
  add_columns({"red", "green", "blue"}, PlyType::kUint8, cloud.colors, 255);
  PlyFile file;
  file.elements.push_back(std::move(vertex));
  write_ply(path, file);
}

SceneWriter::SceneWriter(fs::path folder, bool overwrite, std::vector<fs::path> sources)
    : overwrite_(overwrite),
      sources_(std::move(sources)),
      replacement_(free_place(std::move(folder), overwrite, sources_)) {
  make_folder(replacement_.path() / "images");
}

fs::path SceneWriter::write_image(const SceneViewParts& view) const {
  const bool copy = !view.image_file.empty(), jpeg = view.jpeg_quality > 0 && view.image.channels == 3;
  const std::string extension = copy ? view.image_file.extension().string() : (jpeg ? ".jpg" : ".png");
  fs::path path = replacement_.path() / "images" / (view.name + extension);
  make_folder(path.parent_path());
  int width = view.image.width, height = view.image.height;
  bool stored = false;  // the camera is for pixels that EXIF orientation would turn
  if (copy) {
    const ImageInfo info = read_image_info(view.image_file);
    stored =
        info.stored_width == view.camera.width && info.stored_height == view.camera.height && info.orientation != 1;
    width = stored ? info.stored_width : info.width;
    height = stored ? info.stored_height : info.height;
  }
  if (width != view.camera.width || height != view.camera.height) {
    const std::string sizes = std::to_string(width) + " x " + std::to_string(height) + " pixels, its camera is for " +
                              std::to_string(view.camera.width) + " x " + std::to_string(view.camera.height);
    if (!copy) fail("the image has " + sizes, path, "size");
    throw_bad_input(view.image_file, "size", "the image has " + sizes,
                    "give the images that the cameras were found for");
  }
  if (stored) {
    write_file_atomically(path, without_orientation(read_file(view.image_file), view.image_file));
  } else if (copy) {
    copy_into_place(view.image_file, path);
  } else if (jpeg) {
    write_jpeg(path, view.image, view.jpeg_quality);
  } else {
    write_png(path, view.image);
  }
  return path;
}

void SceneWriter::add_view(const SceneViewParts& view) {
  const fs::path name(view.name);
  const bool inside = !view.name.empty() && name.is_relative() && !name.filename().empty() &&
                      std::none_of(name.begin(), name.end(), [](const fs::path& part) { return part == ".."; });
  if (!inside)
    throw_bad_input(replacement_.target(), "name", "the name '" + view.name + "' cannot name a view",
                    "rename the image");
  const bool repeated =
      std::any_of(views_.begin(), views_.end(), [&](const Written& w) { return w.name == view.name; });
  if (repeated)
    throw_bad_input(replacement_.target(), "name", "two views have the name '" + view.name + "'",
                    "rename one of the images");

  const fs::path image = write_image(view);
  if (!view.mask_file.empty()) {
    const fs::path mask = replacement_.path() / kMaskFolder / image.lexically_relative(replacement_.path() / "images");
    make_folder(mask.parent_path());
    copy_into_place(view.mask_file, mask.string() + ".png");
  }
  const auto require_aspect = [&](int width, int height, const char* field) {
    require_same_aspect({1, height, width}, view.camera.width, view.camera.height, replacement_.target() / view.name,
                        field);
  };
  if (!view.prior_depth.empty()) {
    require_aspect(view.prior_depth.width, view.prior_depth.height, "prior_depth");
    write_depth(replacement_.path() / "pred_depths" / (view.name + ".npy"), view);
  }
  if (!view.prior_confidence.empty()) write_confidence(replacement_.path(), view.name, view.prior_confidence);
  const SemanticMap& semantics = view.semantics;
  if (!semantics.values.empty()) {
    require_aspect(semantics.width, semantics.height, "semantics");
    if (semantics.values.size() != size_t(semantics.channels) * semantics.width * semantics.height) {
      fail("the number of values is not C x height x width", replacement_.target() / view.name, "semantics");
    }
    const fs::path path = replacement_.path() / "segmentation_logits" / (view.name + ".npz");
    make_folder(path.parent_path());
    write_npz_float16(path, {semantics.channels, semantics.height, semantics.width}, to_half(semantics.values).data());
  }
  if (!view.truth_depth.empty()) {
    require_aspect(view.truth_depth.width, view.truth_depth.height, "truth_depth");
    write_truth_depth(replacement_.path() / "truth" / "depth" / (view.name + ".png"), view.truth_depth);
  }
  if (!view.truth_labels.empty()) {
    require_aspect(view.truth_labels.width, view.truth_labels.height, "truth_labels");
    write_truth_labels(replacement_.path() / "truth" / "labels" / (view.name + ".png"), view.truth_labels);
  }
  views_.push_back({view.name, image.lexically_relative(replacement_.path() / "images").generic_string(), view.camera,
                    view.truth_camera});
}

void SceneWriter::write_models(const SceneParts& parts) const {
  ColmapModel model, truth;
  size_t with_truth = 0;
  for (const Written& view : views_) {
    append_view(model, view.camera, view.image_name);
    if (!view.truth_camera) continue;
    append_view(truth, *view.truth_camera, view.image_name);
    ++with_truth;
  }
  if (with_truth != 0 && with_truth != views_.size()) {
    fail("a true camera for every view or for none expected", replacement_.target(), "truth_camera");
  }
  append_points(model, parts.cloud);
  const fs::path& folder = replacement_.path();
  make_folder(folder / "sparse");
  write_colmap_binary(folder / "sparse", model);
  if (parts.cloud.has_normals()) write_cloud_ply(folder / "sparse" / "points3D.ply", parts.cloud);
  if (with_truth == 0) return;
  make_folder(folder / "truth" / "sparse");
  write_colmap_binary(folder / "truth" / "sparse", truth);
}

void SceneWriter::finish(const SceneParts& parts) {
  write(parts);
  commit();
}

void SceneWriter::commit() { place_scene(replacement_, overwrite_, sources_); }

void SceneWriter::write(const SceneParts& parts) {
  if (views_.empty()) fail("a scene needs at least one view", replacement_.target(), "views");
  if (parts.cloud.colors.size() != parts.cloud.size())
    fail("one colour per point expected", replacement_.target(), "cloud");
  write_models(parts);
  const fs::path& folder = replacement_.path();
  write_scene_json(folder / "scene.json", parts.description);
  if (parts.split.train || parts.split.test) write_split_json(folder / "split.json", parts.split);
  if (parts.priors.depth || parts.priors.semantics) write_priors_json(folder / "priors.json", parts.priors);
  if (parts.labels.size() > 0) write_label_csv(folder / "labels.csv", parts.labels);
  if (!parts.truth_mesh_file.empty()) {
    copy_into_place(parts.truth_mesh_file, folder / "truth" / "mesh.ply");
  } else if (!parts.truth_mesh.vertices.empty()) {
    make_folder(folder / "truth");
    write_mesh_ply(folder / "truth" / "mesh.ply", parts.truth_mesh);
  }
}

}  // namespace aligngs
