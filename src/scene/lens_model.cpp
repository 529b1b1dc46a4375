#include "scene/lens_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "io/colmap_camera_models.h"

namespace aligngs {
namespace {

constexpr int kMaxSide = 65535;  // pixels; what image files can hold

/// tan and atan of small angles over their argument lose nothing in double precision down to here.
constexpr double kSmallRadius = 1e-9;

Vec2d projected(const LensModel& lens, const Vec2d& p) {
  const double r2 = p.x * p.x + p.y * p.y, r = std::sqrt(r2);
  switch (lens.projection) {
    case LensProjection::kPerspective:
      return p;
    case LensProjection::kFisheye: {
      const double factor = r > kSmallRadius ? std::atan(r) / r : 1;
      return {p.x * factor, p.y * factor};
    }
    case LensProjection::kFieldOfView: {
      const double w = lens.radial[0], slope = 2 * std::tan(w / 2);
      const double factor = w == 0 ? 1 : r > kSmallRadius ? std::atan(r * slope) / (r * w) : slope / w;
      return {p.x * factor, p.y * factor};
    }
    case LensProjection::kDivision: {
      const double factor = 2 / (1 + std::sqrt(1 - 4 * lens.radial[0] * r2));  // nan beyond the lens's last ray
      return {p.x * factor, p.y * factor};
    }
    case LensProjection::kUnified: {
      const double a = lens.radial[0], factor = 1 / (a * std::sqrt(lens.radial[1] * r2 + 1) + 1 - a);
      return {p.x * factor, p.y * factor};
    }
  }
  return p;
}

double radial_factor(const LensModel& lens, double s2) {
  const std::array<double, 6>& k = lens.radial;
  if (lens.projection == LensProjection::kFisheye) {
    return 1 + s2 * (k[0] + s2 * (k[1] + s2 * (k[2] + s2 * (k[3] + s2 * (k[4] + s2 * k[5])))));
  }
  if (lens.projection != LensProjection::kPerspective) return 1;
  return (1 + s2 * (k[0] + s2 * (k[1] + s2 * k[2]))) / (1 + s2 * (k[3] + s2 * (k[4] + s2 * k[5])));
}

/// Takes a model's parameters behind focal lengths and principal point one after the other.
void read_distortion(const std::string& model, const double* k, LensModel& lens) {
  const auto radial = [&](std::initializer_list<double> values) {
    std::copy(values.begin(), values.end(), lens.radial.begin());
  };
  if (model == "SIMPLE_RADIAL") {
    radial({k[0]});
  } else if (model == "RADIAL") {
    radial({k[0], k[1]});
  } else if (model == "OPENCV") {
    radial({k[0], k[1]});
    lens.p1 = k[2], lens.p2 = k[3];
  } else if (model == "FULL_OPENCV") {
    radial({k[0], k[1], k[4], k[5], k[6], k[7]});
    lens.p1 = k[2], lens.p2 = k[3];
  } else if (model == "OPENCV_FISHEYE") {
    radial({k[0], k[1], k[2], k[3]});
  } else if (model == "SIMPLE_RADIAL_FISHEYE") {
    radial({k[0]});
  } else if (model == "RADIAL_FISHEYE") {
    radial({k[0], k[1]});
  } else if (model == "THIN_PRISM_FISHEYE") {  // k1 k2 p1 p2 k3 k4 sx1 sy1
    radial({k[0], k[1], k[4], k[5]});
    lens.p1 = k[2], lens.p2 = k[3];
    lens.prism = {k[6], 0, k[7], 0};
  } else if (model == "RAD_TAN_THIN_PRISM_FISHEYE") {  // k0..k5 p0 p1 s0..s3; its p0 is our p2
    radial({k[0], k[1], k[2], k[3], k[4], k[5]});
    lens.p1 = k[7], lens.p2 = k[6];
    lens.prism = {k[8], k[9], k[10], k[11]};
    lens.bent_first = true;
  } else if (model == "FOV" || model == "SIMPLE_DIVISION" || model == "DIVISION") {
    radial({k[0]});
  } else if (model == "EUCM") {
    radial({k[0], k[1]});
  }
}

LensProjection projection_of(const std::string& model) {
  if (model.find("FISHEYE") != std::string::npos) return LensProjection::kFisheye;
  if (model == "FOV") return LensProjection::kFieldOfView;
  if (model.find("DIVISION") != std::string::npos) return LensProjection::kDivision;
  if (model == "EUCM") return LensProjection::kUnified;
  return LensProjection::kPerspective;
}

/// Some programs give intrinsics as parts of the width and height.
void require_pixels(const LensModel& lens, const std::filesystem::path& path, const std::string& field) {
  constexpr const char* kInPixels = "focal lengths and principal points are in pixels, not in parts of the width";
  constexpr double kShortest = 0.02;  // of the longer side: a perspective view of 176 degrees
  constexpr double kLongest = 1000;   // of the longer side: a view of 0.06 degrees
  const double side = std::max(lens.width, lens.height);
  for (const double focal : {lens.fx, lens.fy}) {
    if (focal >= kShortest * side && focal <= kLongest * side) continue;
    throw_bad_input(path, field,
                    fmt::format("a focal length of {:.4g} pixels is impossible for a picture of {} x {}", focal,
                                lens.width, lens.height),
                    kInPixels);
  }
  // A part of a larger photo may have its principal point outside, but not a whole photo away.
  constexpr double kSmallest = 16;  // of the longer side: pictures in which one pixel is no corner
  const bool corner = lens.cx <= 1 && lens.cy <= 1 && side >= kSmallest;
  const auto far = [](double at, double length) { return !(at >= -length && at <= 2 * length); };
  if (!corner && !far(lens.cx, lens.width) && !far(lens.cy, lens.height)) return;
  throw_bad_input(path, field,
                  fmt::format("a principal point of ({:.4g}, {:.4g}) is impossible for a picture of {} x {}", lens.cx,
                              lens.cy, lens.width, lens.height),
                  kInPixels);
}

}  // namespace

bool LensModel::distorted() const {
  if (projection == LensProjection::kFisheye) return true;
  if (projection == LensProjection::kUnified) return radial[0] != 0;  // alpha = 0 is a pinhole whatever beta is
  const auto any = [](const auto& values) {
    return std::any_of(values.begin(), values.end(), [](double k) { return k != 0; });
  };
  return p1 != 0 || p2 != 0 || any(radial) || any(prism);
}

Camera LensModel::pinhole() const {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = fx;
  camera.fy = fy;
  camera.cx = cx;
  camera.cy = cy;
  return camera;
}

Vec2d LensModel::distort(const Vec2d& p) const {
  const Vec2d q = projected(*this, p);
  const double factor = radial_factor(*this, q.x * q.x + q.y * q.y);
  const Vec2d bent{q.x * factor, q.y * factor};
  const Vec2d& from = bent_first ? bent : q;
  const double s2 = from.x * from.x + from.y * from.y, s4 = s2 * s2, xy = from.x * from.y;
  return {bent.x + 2 * p1 * xy + p2 * (s2 + 2 * from.x * from.x) + prism[0] * s2 + prism[1] * s4,
          bent.y + 2 * p2 * xy + p1 * (s2 + 2 * from.y * from.y) + prism[2] * s2 + prism[3] * s4};
}

Vec2d LensModel::project(const Vec2d& p) const {
  const Vec2d d = distort(p);
  return {fx * d.x + cx, fy * d.y + cy};
}

LensModel LensModel::resized(int w, int h) const {
  LensModel lens = *this;
  const double sx = static_cast<double>(w) / width, sy = static_cast<double>(h) / height;
  lens.width = w;
  lens.height = h;
  lens.fx *= sx;
  lens.cx *= sx;
  lens.fy *= sy;
  lens.cy *= sy;
  return lens;
}

LensModel lens_of(const ColmapCamera& camera, const std::filesystem::path& path) {
  const std::string field = "camera " + std::to_string(camera.id);
  const ColmapCameraModel* model = find_colmap_camera_model(camera.model);
  if (!model) throw_bad_input(path, field, "camera model " + camera.model + " is unknown", kUnknownCameraModelRemedy);
  if (model->focal_lengths == 0) {
    throw_bad_input(
        path, field, "camera model " + camera.model + ": a panorama is not the view of one pinhole camera",
        "cut each panorama into perspective views and find their cameras (python/examples/panorama_sfm.py of COLMAP)");
  }
  const std::vector<double>& p = camera.params;
  if (p.size() != model->parameters || std::any_of(p.begin(), p.end(), [](double v) { return !std::isfinite(v); })) {
    throw_bad_input(path, field, camera.model + " needs " + std::to_string(model->parameters) + " finite parameters",
                    "write the model again");
  }
  if (camera.width < 1 || camera.height < 1 || camera.width > kMaxSide || camera.height > kMaxSide) {
    throw_bad_input(path, field,
                    "size " + std::to_string(camera.width) + " x " + std::to_string(camera.height) + " is impossible",
                    "write the model again with the size of the images in pixels");
  }
  LensModel lens;
  lens.projection = projection_of(camera.model);
  lens.width = static_cast<int>(camera.width);
  lens.height = static_cast<int>(camera.height);
  const size_t focals = model->focal_lengths;
  lens.fx = p[0];
  lens.fy = p[focals - 1];
  lens.cx = p[focals];
  lens.cy = p[focals + 1];
  if (!(lens.fx > 0 && lens.fy > 0)) {
    throw_bad_input(path, field, "the focal length is not positive", "write the camera again");
  }
  require_pixels(lens, path, field);
  read_distortion(camera.model, p.data() + focals + 2, lens);
  if (lens.projection == LensProjection::kUnified && !(p[4] >= 0 && p[4] <= 1 && p[5] > 0)) {
    throw_bad_input(path, field, "EUCM needs alpha within [0, 1] and a positive beta", "write the model again");
  }
  return lens;
}

ColmapCamera resized_camera(const ColmapCamera& camera, int w, int h) {
  const ColmapCameraModel* model = find_colmap_camera_model(camera.model);
  ColmapCamera out = camera;
  if (!model || model->focal_lengths == 0 || camera.width == 0 || camera.height == 0) return out;
  const double sx = static_cast<double>(w) / static_cast<double>(camera.width),
               sy = static_cast<double>(h) / static_cast<double>(camera.height);
  out.width = static_cast<uint64_t>(w);
  out.height = static_cast<uint64_t>(h);
  const size_t focals = model->focal_lengths;
  out.params[0] *= sx;  // one focal length: the sides share a factor up to rounding
  if (focals == 2) out.params[1] *= sy;
  out.params[focals] *= sx;
  out.params[focals + 1] *= sy;
  return out;
}

}  // namespace aligngs
