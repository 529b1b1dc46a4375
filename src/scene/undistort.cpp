#include "scene/undistort.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr int kMaxSide = 65535;  // pixels; what image files can hold
constexpr double kMinFocalScale = 0.5, kMaxFocalScale = 2;

double radial_factor(const std::array<double, 6>& k, double r2) {
  const double numerator = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]));
  const double denominator = 1 + r2 * (k[3] + r2 * (k[4] + r2 * k[5]));
  return numerator / denominator;
}

/// Positive determinant of the distortion's Jacobian (by central differences) and a source inside of the image.
bool usable(const LensModel& lens, const Vec2d& p) {
  const Vec2d source = lens.project(p);
  if (!(source.x >= 0 && source.y >= 0 && source.x <= lens.width && source.y <= lens.height)) return false;
  constexpr double h = 1e-5;  // normalised image units; second-order error ~1e-10
  const Vec2d right = lens.distort({p.x + h, p.y}), left = lens.distort({p.x - h, p.y});
  const Vec2d down = lens.distort({p.x, p.y + h}), up = lens.distort({p.x, p.y - h});
  const double dxx = right.x - left.x, dyx = right.y - left.y, dxy = down.x - up.x, dyy = down.y - up.y;
  return dxx > 0 && dyy > 0 && dxx * dyy - dxy * dyx > 0;
}

/// Whether all pixels of the pinhole with focal lengths scaled by s have a source: tested on a grid that
/// includes the outermost pixel borders. The grid (33 x 33) is finer than any distortion polynomial of degree 6.
bool fully_covered(const LensModel& lens, double s) {
  constexpr int kSteps = 32;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const double u = static_cast<double>(lens.width) * i / kSteps, v = static_cast<double>(lens.height) * j / kSteps;
      if (!usable(lens, {(u - lens.cx) / (s * lens.fx), (v - lens.cy) / (s * lens.fy)})) return false;
    }
  }
  return true;
}

/// Calls body(x, y, source position in continuous pixels of the map) for each output pixel.
void for_each_source(int width, int height, const LensModel& lens, const Camera& pinhole, int out_width, int out_height,
                     const std::function<void(int, int, const Vec2d&)>& body) {
  const LensModel source = lens.resized(width, height);
  const Camera target = pinhole.resized(out_width, out_height);
  for (int y = 0; y < out_height; ++y) {
    for (int x = 0; x < out_width; ++x) {
      const Vec3d ray = target.ray(x + 0.5, y + 0.5);
      body(x, y, source.project({ray.x, ray.y}));
    }
  }
}

int target_height(int map_width, const Camera& pinhole) {
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(map_width) * pinhole.height / pinhole.width)));
}

bool inside(const Vec2d& p, int width, int height) { return p.x >= 0 && p.y >= 0 && p.x <= width && p.y <= height; }

/// The four samples around a continuous position, clamped to the map, and the weight of the right and lower ones.
struct Corners {
  int x0, y0, x1, y1;
  float fx, fy;
  Corners(const Vec2d& p, int width, int height) {
    const double sx = std::clamp(p.x - 0.5, 0.0, width - 1.0), sy = std::clamp(p.y - 0.5, 0.0, height - 1.0);
    x0 = static_cast<int>(sx);
    y0 = static_cast<int>(sy);
    x1 = std::min(x0 + 1, width - 1);
    y1 = std::min(y0 + 1, height - 1);
    fx = static_cast<float>(sx - x0);
    fy = static_cast<float>(sy - y0);
  }
};

float blend(const ImageF& map, const Corners& k, int c) {
  const float top = map.at(k.x0, k.y0, c) * (1 - k.fx) + map.at(k.x1, k.y0, c) * k.fx;
  const float bottom = map.at(k.x0, k.y1, c) * (1 - k.fx) + map.at(k.x1, k.y1, c) * k.fx;
  return top * (1 - k.fy) + bottom * k.fy;
}

template <class T>
T nearest(const Image<T>& map, const Vec2d& p) {
  return map.at(std::clamp(static_cast<int>(p.x), 0, map.width - 1),
                std::clamp(static_cast<int>(p.y), 0, map.height - 1));
}

}  // namespace

bool LensModel::distorted() const {
  return p1 != 0 || p2 != 0 || std::any_of(radial.begin(), radial.end(), [](double k) { return k != 0; });
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
  const double r2 = p.x * p.x + p.y * p.y, factor = radial_factor(radial, r2), xy = p.x * p.y;
  return {p.x * factor + 2 * p1 * xy + p2 * (r2 + 2 * p.x * p.x),
          p.y * factor + 2 * p2 * xy + p1 * (r2 + 2 * p.y * p.y)};
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
  struct Layout {
    const char* model;
    size_t params;
    bool one_focal;
  };
  static constexpr Layout kLayouts[] = {{"SIMPLE_PINHOLE", 3, true}, {"PINHOLE", 4, false}, {"SIMPLE_RADIAL", 4, true},
                                        {"RADIAL", 5, true},         {"OPENCV", 8, false},  {"FULL_OPENCV", 12, false}};
  const Layout* layout =
      std::find_if(std::begin(kLayouts), std::end(kLayouts), [&](const Layout& l) { return camera.model == l.model; });
  if (layout == std::end(kLayouts)) {
    throw_bad_input(path, field, "camera model " + camera.model + " is not supported",
                    "undistort the images first (colmap image_undistorter), which gives PINHOLE cameras");
  }
  const std::vector<double>& p = camera.params;
  if (p.size() != layout->params || std::any_of(p.begin(), p.end(), [](double v) { return !std::isfinite(v); })) {
    throw_bad_input(path, field, camera.model + " needs " + std::to_string(layout->params) + " finite parameters",
                    "write the model again");
  }
  if (camera.width < 1 || camera.height < 1 || camera.width > kMaxSide || camera.height > kMaxSide) {
    throw_bad_input(path, field,
                    "size " + std::to_string(camera.width) + " x " + std::to_string(camera.height) + " is impossible",
                    "write the model again with the size of the images in pixels");
  }
  LensModel lens;
  lens.width = static_cast<int>(camera.width);
  lens.height = static_cast<int>(camera.height);
  size_t next = 0;
  lens.fx = p[next++];
  lens.fy = layout->one_focal ? lens.fx : p[next++];
  lens.cx = p[next++];
  lens.cy = p[next++];
  if (!(lens.fx > 0 && lens.fy > 0)) {
    throw_bad_input(path, field, "the focal length is not positive", "write the model again");
  }
  if (next < p.size()) lens.radial[0] = p[next++];                   // k1
  if (next < p.size()) lens.radial[1] = p[next++];                   // k2
  if (next < p.size()) lens.p1 = p[next++], lens.p2 = p[next++];     // OPENCV and FULL_OPENCV
  for (int k = 2; next < p.size(); ++k) lens.radial[k] = p[next++];  // FULL_OPENCV: k3 .. k6
  return lens;
}

ColmapCamera colmap_camera_of(const LensModel& lens) {
  const auto& k = lens.radial;
  return {0, "FULL_OPENCV", uint64_t(lens.width), uint64_t(lens.height),
          {lens.fx, lens.fy, lens.cx, lens.cy, k[0], k[1], lens.p1, lens.p2, k[2], k[3], k[4], k[5]}};
}

Camera undistorted_camera(const LensModel& lens, const std::filesystem::path& path) {
  Camera camera = lens.pinhole();
  if (!lens.distorted()) return camera;
  if (!fully_covered(lens, kMaxFocalScale)) {
    throw_bad_input(path, "camera", "the distortion cannot be undone within the image: its parameters are too strong",
                    "calibrate the camera again, or undistort the images with the program that estimated it");
  }
  double low = kMinFocalScale, high = kMaxFocalScale;
  if (fully_covered(lens, low)) high = low;
  for (int i = 0; i < 40 && high > low; ++i) {  // 40 halvings of 1.5: far below a thousandth of a pixel
    const double middle = (low + high) / 2;
    (fully_covered(lens, middle) ? high : low) = middle;
  }
  camera.fx *= high;
  camera.fy *= high;
  return camera;
}

ImageF undistort_image(const ImageF& image, const LensModel& lens, const Camera& pinhole) {
  ImageF out(image.width, target_height(image.width, pinhole), image.channels);
  for_each_source(image.width, image.height, lens, pinhole, out.width, out.height, [&](int x, int y, const Vec2d& p) {
    if (!inside(p, image.width, image.height)) return;
    const Corners corners(p, image.width, image.height);
    for (int c = 0; c < image.channels; ++c) out.at(x, y, c) = blend(image, corners, c);
  });
  return out;
}

ImageF undistort_depth(const ImageF& depth, const LensModel& lens, const Camera& pinhole, float jump) {
  const auto valid = [](float z) { return std::isfinite(z) && z > 0; };
  ImageF out(depth.width, target_height(depth.width, pinhole), 1);
  for_each_source(depth.width, depth.height, lens, pinhole, out.width, out.height, [&](int x, int y, const Vec2d& p) {
    if (!inside(p, depth.width, depth.height)) return;
    const float centre = nearest(depth, p);
    if (!valid(centre)) return;
    const Corners k(p, depth.width, depth.height);
    const float samples[4] = {depth.at(k.x0, k.y0), depth.at(k.x1, k.y0), depth.at(k.x0, k.y1), depth.at(k.x1, k.y1)};
    const bool smooth =
        std::all_of(samples, samples + 4, [&](float z) { return valid(z) && std::abs(z - centre) <= jump * centre; });
    out.at(x, y) = smooth ? blend(depth, k, 0) : centre;
  });
  return out;
}

Image<uint16_t> undistort_labels(const Image<uint16_t>& labels, const LensModel& lens, const Camera& pinhole,
                                 uint16_t none) {
  Image<uint16_t> out(labels.width, target_height(labels.width, pinhole), 1, none);
  for_each_source(labels.width, labels.height, lens, pinhole, out.width, out.height, [&](int x, int y, const Vec2d& p) {
    if (inside(p, labels.width, labels.height)) out.at(x, y) = nearest(labels, p);
  });
  return out;
}

}  // namespace aligngs
