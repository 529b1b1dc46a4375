#include "scene/import/transforms_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/angles.h"
#include "core/error.h"
#include "scene/import/capture.h"
#include "scene/import/intrinsics.h"
#include "scene/import/json_number.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

const std::set<std::string> kUsed = {"camera_model",
                                     "is_fisheye",
                                     "fl_x",
                                     "fl_y",
                                     "cx",
                                     "cy",
                                     "w",
                                     "h",
                                     "k1",
                                     "k2",
                                     "k3",
                                     "k4",
                                     "k5",
                                     "k6",
                                     "p1",
                                     "p2",
                                     "distortion_params",
                                     "camera_angle_x",
                                     "camera_angle_y",
                                     "x_fov",
                                     "y_fov",
                                     "frames",
                                     "test_frames",
                                     "file_path",
                                     "transform_matrix",
                                     "depth_file_path",
                                     "depth_path",
                                     "depth_unit_scale_factor",
                                     "integer_depth_scale",
                                     "mask_path",
                                     "ply_file_path",
                                     "train_filenames",
                                     "val_filenames",
                                     "test_filenames",
                                     "fisheye_crop_radius",
                                     "rolling_shutter",
                                     "ftheta_p0",
                                     "ftheta_p1",
                                     "ftheta_p2",
                                     "ftheta_p3",
                                     "ftheta_p4",
                                     "latlong",
                                     "equirectangular",
                                     "orthographic",
                                     "is_bad",
                                     "time"};

/// They change nothing here: poses and points are in the file's own world, which its viewers alone move and scale.
const std::set<std::string> kHarmless = {"applied_transform",
                                         "applied_scale",
                                         "aabb_scale",
                                         "aabb",
                                         "scale",
                                         "offset",
                                         "render_aabb",
                                         "up",
                                         "n_frames",
                                         "has_mask",
                                         "sharpness",
                                         "sharpen",
                                         "colmap_im_id",
                                         "rotation",
                                         "orientation_override",
                                         "auto_scale_poses_override",
                                         "white_transparent",
                                         "black_transparent",
                                         "from_na",
                                         "from_mitsuba",
                                         "enable_depth_loading",
                                         "enable_ray_loading",
                                         "is_hdr",
                                         "fix_premult",
                                         "light_dir",
                                         "n_extra_learnable_dims",
                                         "wants_importance_sampling",
                                         "timestamp",
                                         "camera_id",
                                         "image_id",
                                         "cam_id",
                                         "id",
                                         "name",
                                         "version",
                                         "average_focal_length",
                                         "near",
                                         "far",
                                         "camera",
                                         "envmap"};

const std::set<std::string> kPerspective = {"",       "PERSPECTIVE", "SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL",
                                            "RADIAL", "OPENCV",      "FULL_OPENCV"};
const std::set<std::string> kFisheye = {"FISHEYE", "OPENCV_FISHEYE", "SIMPLE_FISHEYE", "SIMPLE_RADIAL_FISHEYE",
                                        "RADIAL_FISHEYE"};

/// A matrix of intrinsics, as programs call it.
constexpr const char* kMatrices[] = {"camera_intrinsics", "intrinsic_matrix", "intrinsics", "camera_matrix", "K"};

const char* const kUndistort =
    "undistort the images with the program that estimated the lens, and write a transforms.json for those";

}  // namespace

const Json* TransformsFields::find(const char* key) const {
  for (const Json* source : {&frame_, &document_}) {
    const auto found = source->find(key);
    if (found != source->end() && !found->is_null()) return &*found;
  }
  return nullptr;
}

double TransformsFields::number(const char* key, double fallback) const {
  const Json* value = find(key);
  if (!value) return fallback;
  if (!is_number_of_json(*value)) throw_bad_input(file_, key, no_number(*value), "correct the value");
  const double stated = number_of_json(*value);
  if (!std::isfinite(stated)) throw_bad_input(file_, key, "expected a finite number", "correct the value");
  return stated;
}

bool TransformsFields::flag(const char* key) const {
  const Json* value = find(key);
  if (!value) return false;
  if (value->is_boolean()) return value->get<bool>();
  if (value->is_number()) return value->get<double>() != 0;
  throw_bad_input(file_, key, "expected true or false", "correct the value");
}

std::string TransformsFields::text(const char* key) const {
  const Json* value = find(key);
  if (!value) return "";
  if (!value->is_string()) throw_bad_input(file_, key, "expected a text", "correct the value");
  return value->get<std::string>();
}

std::optional<std::array<double, 4>> TransformsFields::intrinsics() const {
  for (const char* key : kMatrices) {
    const Json* value = find(key);
    if (!value || !value->is_array()) continue;  // an object of other names is listed as unknown
    std::vector<double> m;
    const auto add = [&](const Json& entry) {
      if (!is_number_of_json(entry))
        throw_bad_input(file_, key, no_number(entry), "write fx 0 cx / 0 fy cy / 0 0 1 in pixels");
      m.push_back(number_of_json(entry));
    };
    for (const Json& row : *value) {  // rows, or all numbers in one list
      if (!row.is_array()) add(row);
      for (const Json& entry : row.is_array() ? row : Json::array()) add(entry);
    }
    const size_t side = m.size() == 16 ? 4 : 3;
    const std::string fault = m.size() == side * side ? fault_of_matrix(m, side) : "it has not 3 or 4 rows";
    if (!fault.empty())
      throw_bad_input(file_, key, "this is no matrix of intrinsics: " + fault,
                      "write fx 0 cx / 0 fy cy / 0 0 1 in pixels");
    return std::array{m[0], m[side + 1], m[2], m[side + 2]};
  }
  return {};
}

void TransformsFields::refuse_unsupported() const {
  for (const char* key : {"ftheta_p0", "latlong", "equirectangular", "orthographic"}) {
    const Json* value = find(key);
    if (value && !(value->is_boolean() && !value->get<bool>()))
      throw_bad_input(file_, key, "this lens is no pinhole view", kUndistort);
  }
}

ColmapCamera TransformsFields::camera(int width, int height) const {
  refuse_unsupported();
  const double w = number("w", width), h = number("h", height);
  if (!(w >= 1 && h >= 1 && w <= 65535 && h <= 65535))
    throw_bad_input(file_, "w, h", "impossible sizes", "the size of the images in pixels");
  const std::array<double, 4> matrix = intrinsics().value_or(std::array<double, 4>{0, 0, w / 2, h / 2});
  const auto focal = [&](const char* pixels, double of_matrix, const char* radians, const char* degrees, double side) {
    const double direct = number(pixels, of_matrix), angle = number(radians, kRadiansPerDegree * number(degrees, 0));
    if (direct > 0) return direct;
    if (direct < 0) throw_bad_input(file_, pixels, "a negative focal length", "the focal length in pixels");
    return angle > 0 && angle < kPi ? 0.5 * side / std::tan(0.5 * angle) : 0.0;
  };
  double fx = focal("fl_x", matrix[0], "camera_angle_x", "x_fov", w),
         fy = focal("fl_y", matrix[1], "camera_angle_y", "y_fov", h);
  const auto refuse_zero = [&](const char* key, double own, double other) {
    if (!(own > 0) && other > 0 && find(key) != nullptr)
      throw_bad_input(file_, key, "a focal length of 0",
                      "the focal length in pixels, or no such key where both are equal");
  };
  refuse_zero("fl_x", fx, fy);
  refuse_zero("fl_y", fy, fx);
  if (!(fx > 0)) fx = fy;
  if (!(fy > 0)) fy = fx;
  for (const char* key : {"camera_angle_x", "camera_angle_y"}) {
    if (!(fx > 0) && number(key, 0) >= kPi)
      throw_bad_input(file_, key, "an angle of view above 3.14",
                      "this angle is in radians; x_fov and y_fov are degrees");
  }
  if (!(fx > 0))
    throw_bad_input(file_, "fl_x", "no focal length (fl_x, camera_angle_x or camera_intrinsics)", "add fl_x in pixels");

  const std::string model = text("camera_model");
  if (!kPerspective.count(model) && !kFisheye.count(model)) {
    throw_bad_input(file_, "camera_model", "'" + model + "' is no lens that is undone here",
                    "perspective (OPENCV, PINHOLE, ...) and OPENCV_FISHEYE are; for others " + std::string(kUndistort));
  }
  const bool fisheye = kFisheye.count(model) > 0 || flag("is_fisheye");
  double k[4] = {number("k1", 0), number("k2", 0), number("k3", 0), number("k4", 0)}, p1 = number("p1", 0),
         p2 = number("p2", 0);
  if (const Json* list = find("distortion_params")) {  // nerfstudio's order
    const bool good = list->is_array() && list->size() == 6 &&
                      std::all_of(list->begin(), list->end(), [](const Json& v) { return v.is_number(); });
    if (!good) throw_bad_input(file_, "distortion_params", "expected k1, k2, k3, k4, p1, p2", "correct the list");
    for (int i = 0; i < 4; ++i) k[i] = (*list)[size_t(i)].get<double>();
    p1 = (*list)[4].get<double>();
    p2 = (*list)[5].get<double>();
  }
  const double cx = number("cx", matrix[2]), cy = number("cy", matrix[3]);
  if (!find("w") && !find("h")) {
    if (const std::string problem = misfit_of_intrinsics(cx, cy, int(w), int(h)); !problem.empty())
      throw_bad_input(file_, "cx, cy", problem + "; w and h are absent",
                      "add w and h: the size of the photos that the camera was found in");
  }
  ColmapCamera camera = pinhole_camera(fx, fy, cx, cy, int(w), int(h));
  if (fisheye) {  // theta (1 + k1 theta^2 + ... + k4 theta^8) and the tangential terms
    camera.model = "THIN_PRISM_FISHEYE";
    camera.params.insert(camera.params.end(), {k[0], k[1], p1, p2, k[2], k[3], 0, 0});
    if (number("k5", 0) != 0 || number("k6", 0) != 0)
      throw_bad_input(file_, number("k5", 0) != 0 ? "k5" : "k6", "a fisheye lens has four radial terms", kUndistort);
    return camera;
  }
  const double k5 = number("k5", 0), k6 = number("k6", 0);
  const bool higher = k[3] != 0 || k5 != 0 || k6 != 0;
  if (higher && model != "FULL_OPENCV") {
    throw_bad_input(file_,
                    k[3] != 0 ? "k4"
                    : k5 != 0 ? "k5"
                              : "k6",
                    "a radial term of this order is undone for a lens of the model FULL_OPENCV alone", kUndistort);
  }
  if (k[2] != 0 || higher) {
    camera.model = "FULL_OPENCV";
    camera.params.insert(camera.params.end(), {k[0], k[1], p1, p2, k[2], k[3], k5, k6});
  } else if (k[0] != 0 || k[1] != 0 || p1 != 0 || p2 != 0) {
    camera.model = "OPENCV";
    camera.params.insert(camera.params.end(), {k[0], k[1], p1, p2});
  }
  return camera;
}

std::vector<std::string> TransformsFields::contradictions(int width, int height) const {
  constexpr double kTolerance = 0.05;  // programs round angles, and measure them with or without the distortion
  std::vector<std::string> lines;
  const auto compare = [&](const char* pixels, const char* angle_key, double radians_per_unit, double side) {
    const double focal = number(pixels, 0), angle = radians_per_unit * number(angle_key, 0);
    if (!(focal > 0 && angle > 0 && angle < kPi)) return;
    const double other = 0.5 * side / std::tan(0.5 * angle);
    if (std::abs(other - focal) > kTolerance * focal)
      lines.push_back(fmt::format("{} is not used: it means a focal length of {:.4g} pixels, {} says {:.4g}", angle_key,
                                  other, pixels, focal));
  };
  const double w = number("w", width), h = number("h", height);
  if (const auto matrix = intrinsics()) {
    const double focal = number("fl_x", (*matrix)[0]);
    if (std::abs(focal - (*matrix)[0]) > kTolerance * focal)
      lines.push_back(
          fmt::format("the matrix of intrinsics is not used: it has a focal length of {:.4g}, fl_x says {:.4g}",
                      (*matrix)[0], focal));
  }
  compare("fl_x", "camera_angle_x", 1, w);
  compare("fl_y", "camera_angle_y", 1, h);
  compare("fl_x", "x_fov", kRadiansPerDegree, w);
  compare("fl_y", "y_fov", kRadiansPerDegree, h);
  return lines;
}

std::vector<std::string> unknown_fields(const Json& object) {
  std::vector<std::string> unknown;
  for (const auto& [key, value] : object.items()) {
    const bool matrix =
        value.is_array() && std::find(std::begin(kMatrices), std::end(kMatrices), key) != std::end(kMatrices);
    if (matrix || kUsed.count(key) || kHarmless.count(key) || value.is_null()) continue;
    unknown.push_back(key);
  }
  return unknown;
}

}  // namespace aligngs
