// `aligngs info FILE_OR_FOLDER`: what it is, what is in it, who wrote it.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "cli/command.h"
#include "cli/folder_kind.h"
#include "cli/help_text.h"
#include "cli/print_json.h"
#include "core/error.h"
#include "edit/edit_operation.h"
#include "gaussians/gaussian_ply.h"
#include "io/atomic_file.h"
#include "io/byte_source.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "io/npy.h"
#include "io/npz.h"
#include "io/picture_format.h"
#include "io/ply.h"
#include "io/safetensors.h"
#include "io/torch_archive.h"
#include "io/weight_file.h"
#include "metrics/metrics_json.h"
#include "priors/model_registry.h"
#include "scene/scene.h"
#include "scene/scene_json.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

Json bounds_of(const PlyElement& vertices) {
  Json low = Json::array(), high = Json::array();
  for (const char* axis : {"x", "y", "z"}) {
    const PlyProperty* column = vertices.find(axis);
    if (!column || column->values.empty()) return nullptr;
    const auto [least, most] = std::minmax_element(column->values.begin(), column->values.end());
    low.push_back(*least);
    high.push_back(*most);
  }
  return {{"min", low}, {"max", high}};
}

Json label_counts(const PlyElement& vertices, const LabelSet& labels) {
  const PlyProperty* column = vertices.find("label");
  if (!column) return nullptr;
  std::vector<size_t> counts(labels.classes.size(), 0);
  for (const double value : column->values) {
    if (value >= 0 && value < static_cast<double>(counts.size())) ++counts[static_cast<size_t>(value)];
  }
  Json classes = Json::object();
  for (size_t i = 0; i < counts.size(); ++i) {
    if (counts[i]) classes[labels.classes[i].name] = counts[i];
  }
  return classes;
}

/// Why the program cannot use a file of Gaussians; empty where it can.
std::string fault_of_gaussians(const PlyFile& file, const fs::path& path) {
  try {
    const bool empty = gaussians_of_ply(file, path).size() == 0;
    return empty ? "the file has no Gaussians" : "";
  } catch (const Error& error) {
    const std::string& field = error.details().field;
    return (field.empty() ? "" : field + ": ") + error.details().message;
  }
}

Json info_of_ply(const fs::path& path) {
  const PlyFile file = read_ply(path);
  const PlyElement* vertices = file.find("vertex");
  const PlyElement* faces = file.find("face");
  Json info = {{"comments", file.comments}};
  if (!vertices)
    throw_bad_input(path, "vertex", "the file has no vertices", "give a Gaussian scene, a mesh or a point cloud");
  const auto has_any = [&](std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(), [&](const char* name) { return vertices->find(name) != nullptr; });
  };
  // One of these columns makes a file of Gaussians; those that are missing are a fault of it.
  const bool gaussians = has_any({"scale_0", "rot_0", "f_dc_0"});
  const bool packed = vertices->find("packed_position") != nullptr;
  info["kind"] = gaussians               ? "Gaussian scene"
                 : packed                ? "packed Gaussian scene of SuperSplat"
                 : faces && faces->count ? "triangle mesh"
                                         : "point cloud";
  if (packed) info["not_usable"] = "packed values are not read: export the scene as PLY without compression";
  info[gaussians ? "gaussians" : "vertices"] = vertices->count;
  if (faces) info["faces"] = faces->count;
  info["properties"] = vertices->properties.size();
  if (gaussians) {
    const bool strict = vertices->properties.size() == 62;
    info["layout"] = strict ? "standard 62-float 3DGS" : vertices->find("label") ? "3DGS with labels" : "3DGS variant";
    if (const std::string fault = fault_of_gaussians(file, path); !fault.empty()) info["not_usable"] = fault;
  }
  info["bounds"] = bounds_of(*vertices);
  const Json classes = label_counts(*vertices, ade20k_labels());
  if (!classes.is_null()) info["classes"] = classes;
  return info;
}

Json info_of_array(const char* kind, const ArrayHeader& header) {
  return {{"kind", kind}, {"shape", header.shape}, {"dtype", header.dtype}};
}

/// The published networks whose weights such tensors could be.
Json models_with(const std::map<std::string, WeightInfo>& tensors) {
  Json names = Json::array();
  for (const PublishedModel& model : published_models()) {
    for (const ModelFile& file : model.files) {
      if (tensors.count(file.probe) > 0 || tensors.count(file.other_probe) > 0) names.push_back(model.name);
    }
  }
  return names;
}

/// Named tensors of any format; their values stay in the file.
Json info_of_weights(const char* kind, const fs::path& path) {
  const std::shared_ptr<const WeightFile> file = WeightFile::open(path);
  Json tensors = Json::object();
  int64_t values = 0;
  for (const auto& [name, tensor] : file->tensors()) {
    tensors[name] = {{"dtype", tensor.dtype}, {"shape", tensor.shape}};
    values += std::accumulate(tensor.shape.begin(), tensor.shape.end(), int64_t(1), std::multiplies<>());
  }
  Json info = {{"kind", kind}, {"tensor_count", tensors.size()}, {"values", values}, {"tensors", tensors}};
  const Json models = models_with(file->tensors());
  if (!models.empty()) info["has_tensors_of"] = models;
  return info;
}

bool is_safetensors(const fs::path& path) {
  try {
    read_safetensors_directory(*file_source(path));
    return true;
  } catch (const Error&) {
    return false;
  }
}

Json info_of_safetensors(const fs::path& path) {
  Json info = info_of_weights("safetensors", path);
  info["metadata"] = read_safetensors_directory(*file_source(path)).metadata;
  return info;
}

/// One tensor, or a state dict. Some weights carry the wrong extension; their first bytes tell.
Json info_of_torch(const fs::path& path) {
  if (is_safetensors(path)) return info_of_safetensors(path);
  try {
    return info_of_array("torch tensor", read_torch_tensor_header(path));
  } catch (const Error&) {
    return info_of_weights("torch weights", path);
  }
}

Json info_of_run(const fs::path& folder) {
  Json info = {{"kind", "run"}, {"run", parse_json(read_file(folder / "run.json"))}};
  if (!info["run"].is_object())
    throw_bad_input(folder / "run.json", "", "this is no JSON object", "the run folder is damaged: make the run again");
  Json edits = Json::array();
  for (const EditOperation& edit : read_edits(folder / "edits.json")) edits.push_back(describe(edit));
  info["edit_count"] = edits.size();
  if (!edits.empty()) info["edits"] = edits;
  if (fs::exists(folder / "metrics.json")) {
    const Json metrics = metrics_json(read_metrics(folder / "metrics.json"));
    for (const char* part : {"nvs", "geometry", "semantics", "train"}) info["metrics"][part] = metrics[part];
  }
  if (fs::exists(folder / "scene.ply")) info["scene"] = info_of_ply(folder / "scene.ply");
  if (fs::exists(folder / "mesh" / "mesh.ply")) info["mesh"] = info_of_ply(folder / "mesh" / "mesh.ply");
  return info;
}

Json info_of_scene(const fs::path& folder) {
  const Scene scene = open_scene(folder);
  Json sizes = Json::object();
  for (const View& view : scene.views) {
    const std::string size = fmt::format("{}x{}", view.camera.width, view.camera.height);
    sizes[size] = sizes.value(size, 0) + 1;
  }
  const std::string units = scene.units_estimate
                                ? fmt::format("metres (an estimate of {}, photos spread by {:.1f} %)",
                                              scene.units_estimate->model, 100 * scene.units_estimate->spread)
                            : scene.metric ? "metres"
                                           : "arbitrary";
  return {{"kind", "scene folder"},
          {"source", scene.source},
          {"units", units},
          {"up", scene.up ? Json{scene.up->x, scene.up->y, scene.up->z} : Json(nullptr)},
          {"axes", "camera: x right, y down, z forward; poses world to camera"},
          {"views", scene.views.size()},
          {"train", scene.train.size()},
          {"test", scene.test.size()},
          {"image_sizes", sizes},
          {"points", scene.cloud.size()},
          {"prior_depth", scene.has_prior_depth()},
          {"prior_source", scene.prior_source},
          {"prior_scale", scene.has_prior_depth() ? name_of(scene.depth_scale) : ""},
          {"semantics", scene.has_semantics()},
          {"classes", scene.labels.size()},
          {"extent", robust_extent(scene)},
          {"truth_mesh", !scene.truth_mesh.empty()},
          {"fingerprint", scene_fingerprint(scene)}};
}

/// Files of known kinds that are shown with their folder or not at all are no broken pictures.
void require_picture(const fs::path& path) {
  if (has_picture_extension(path) || path.extension().empty()) return;
  throw_bad_input(path, "", "this is no kind of file that is shown",
                  "kinds: PLY, npy, pt, safetensors, JPEG, PNG, WebP and HEIF files; scene folders; run folders");
}

/// Whether a name is one of the files of a COLMAP model.
bool is_of_colmap_model(const fs::path& path) {
  const std::string stem = path.stem().string(), extension = path.extension().string();
  return (extension == ".bin" || extension == ".txt") && (stem == "cameras" || stem == "images" || stem == "points3D");
}

Json info_of(const fs::path& path) {
  if (!fs::exists(path)) throw_bad_input(path, "", "there is no such file or folder", "check the name");
  if (fs::is_directory(path)) {
    const FolderKind kind = kind_of_folder(path);
    if (kind == FolderKind::kRun) return info_of_run(path);
    if (kind == FolderKind::kScene) return info_of_scene(path);
    refuse_folder(path, kind, "a scene folder or a run folder");
  }
  const std::string extension = path.extension().string();
  if (extension == ".ply") return info_of_ply(path);
  if (is_of_colmap_model(path))
    throw_bad_input(path, "", "this file belongs to a COLMAP model", "give the folder that holds images/ and sparse/");
  if (extension == ".npy") return info_of_array("NumPy array", read_npy_header(path));
  if (extension == ".npz") return info_of_array("compressed NumPy array", read_npz_header(path));
  // pytorch_model.bin
  if (extension == ".pt" || extension == ".pth" || extension == ".bin") return info_of_torch(path);
  if (extension == ".safetensors") return info_of_safetensors(path);
  require_picture(path);
  const ImageInfo image = read_image_info(path);
  return {{"kind", "image"},
          {"width", image.width},
          {"height", image.height},
          {"channels", image.channels},
          {"bits", image.bit_depth}};
}

/// JSON as indented "name: value" lines, which is what people want to read.
void print_plain(const Json& value, int indent) {
  for (const auto& [key, item] : value.items()) {
    if (item.is_object() && !item.empty()) {
      std::printf("%*s%s:\n", indent, "", key.c_str());
      print_plain(item, indent + 2);
    } else {
      const std::string text = item.is_string() ? item.get<std::string>() : json_line(item);
      std::printf("%*s%s: %s\n", indent, "", key.c_str(), text.c_str());
    }
  }
}

}  // namespace

void add_info_command(CLI::App& program, CommandContext& context) {
  CLI::App* command = program.add_subcommand("info", "Show the content of a file, a scene folder or a run folder");
  command->group("Look");
  command->footer(help_footer({.reads = "a file, a scene folder or a run folder",
                               .writes = "nothing",
                               .example = "aligngs info demo_run",
                               .advanced = "aligngs info demo_run/scene.ply --json"}));
  auto path = std::make_shared<std::string>();
  command->add_option("path", *path, "PLY, npy, npz, pt, safetensors or image file; scene folder; run folder")
      ->required();
  command->callback([&context, path] {
    const Json info = info_of(*path);
    if (context.global.json)
      print_json(info);
    else
      print_plain(info, 0);
  });
}

}  // namespace aligngs
