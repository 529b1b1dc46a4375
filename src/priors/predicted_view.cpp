#include "priors/predicted_view.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/error.h"
#include "core/is_depth.h"
#include "core/median.h"

namespace aligngs {
namespace {

/// Fields of view that a photograph can have, radians: a long telephoto lens, an ultra-wide one.
constexpr double kNarrowest = 2 * kPi / 180, kWidest = 160 * kPi / 180;

double field_of_view(double focal, double side) { return 2 * std::atan2(side / 2, focal); }

bool plausible(const nn::NetworkCamera& camera) {
  for (const double v : camera.rotation) {
    if (!std::isfinite(v)) return false;
  }
  for (const double v : camera.translation) {
    if (!std::isfinite(v)) return false;
  }
  // A field of view of half a turn or more gives a focal length that is not positive.
  const auto good = [](double focal, double centre) {
    if (!(focal > 0) || !std::isfinite(focal)) return false;
    const double angle = field_of_view(focal, 2 * centre);
    return angle >= kNarrowest && angle <= kWidest;
  };
  return good(camera.fx, camera.cx) && good(camera.fy, camera.cy);
}

}  // namespace

PredictedView view_of_photo(const Photo& photo, const nn::NetworkCamera& camera, const nn::FeatureMap& depth,
                            const nn::ImagePlacement& placement) {
  if (!plausible(camera)) {
    throw Error({ErrorKind::kFailed, "the network predicts an impossible camera for this photo", photo.file,
                 "field of view",
                 "leave the photo out, or use --method colmap; check the weights with `aligngs models verify`"});
  }
  PhotoMaps maps = maps_of_photo(depth, placement, photo.width, photo.height);
  return {camera_of_photo(camera, placement, photo.width, photo.height), std::move(maps.depth),
          std::move(maps.confidence)};
}

void finish_views(std::vector<PredictedView>& views, const ViewPredictionOptions& options) {
  // The first camera is predicted near the identity, not on it.
  const Rigidd to_first = views[0].camera.world_to_camera.inverse();
  for (PredictedView& view : views) view.camera.world_to_camera = view.camera.world_to_camera * to_first;
  if (options.shared_focal) {
    std::vector<double> relative;  // to the longer side, so that photos turned upright agree
    for (const PredictedView& view : views) {
      relative.push_back((view.camera.fx + view.camera.fy) / 2 / std::max(view.camera.width, view.camera.height));
    }
    const double median = double(float(median_of(relative)));
    for (PredictedView& view : views) {
      view.camera.fx = view.camera.fy = median * std::max(view.camera.width, view.camera.height);
    }
  }
}

Camera camera_of_photo(const nn::NetworkCamera& predicted, const nn::ImagePlacement& placement, int width, int height) {
  // Pixel i of the photo covers [i, i + 1); u = x * scale + offset holds for such coordinates, and
  // the network's principal point is the middle of its input.
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = predicted.fx / placement.scale_x;
  camera.fy = predicted.fy / placement.scale_y;
  camera.cx = (predicted.cx - placement.offset_x) / placement.scale_x;
  camera.cy = (predicted.cy - placement.offset_y) / placement.scale_y;
  for (int i = 0; i < 9; ++i) camera.world_to_camera.rotation.m[i] = predicted.rotation[size_t(i)];
  const auto& t = predicted.translation;
  camera.world_to_camera.translation = {t[0], t[1], t[2]};
  return camera;
}

PhotoMaps maps_of_photo(const nn::FeatureMap& depth, const nn::ImagePlacement& placement, int width, int height) {
  constexpr float kJump = 0.05f;  // relative step of depth that separates surfaces
  const double part_width = width * placement.scale_x, part_height = height * placement.scale_y;
  const double scale = std::max(part_width, part_height) / std::max(width, height);
  const int w = std::max(1, int(width * scale + 0.5)), h = std::max(1, int(height * scale + 0.5));
  PhotoMaps maps{ImageF(w, h, 1), ImageF(w, h, 1)};
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const double u = (x + 0.5) * width / w * placement.scale_x + placement.offset_x;
      const double v = (y + 0.5) * height / h * placement.scale_y + placement.offset_y;
      if (u < 0 || v < 0 || u >= double(depth.width) || v >= double(depth.height)) continue;
      const auto nearest_x = int64_t(u), nearest_y = int64_t(v);
      const float nearest = depth.at(nearest_y, nearest_x)[0];
      if (!is_depth(nearest)) continue;
      const double left = std::clamp(u - 0.5, 0.0, double(depth.width - 1));
      const double top = std::clamp(v - 0.5, 0.0, double(depth.height - 1));
      const auto x0 = int64_t(left), y0 = int64_t(top);
      const int64_t x1 = std::min(x0 + 1, depth.width - 1), y1 = std::min(y0 + 1, depth.height - 1);
      const float fx = float(left - double(x0)), fy = float(top - double(y0));
      const float weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
      const float* corners[4] = {depth.at(y0, x0), depth.at(y0, x1), depth.at(y1, x0), depth.at(y1, x1)};
      float z = 0, confidence = 0;
      bool one_surface = true;
      for (int k = 0; k < 4; ++k) {
        one_surface = one_surface && is_depth(corners[k][0]) && std::abs(corners[k][0] - nearest) <= kJump * nearest;
        z += weights[k] * corners[k][0];
        confidence += weights[k] * corners[k][1];
      }
      maps.depth.at(x, y) = one_surface ? z : nearest;
      maps.confidence.at(x, y) = one_surface ? confidence : depth.at(nearest_y, nearest_x)[1];
    }
  }
  return maps;
}

float confidence_at(const std::vector<PredictedView>& views, double percent) {
  std::vector<float> values;
  for (const PredictedView& view : views) {
    for (const float c : view.confidence.data) {
      if (c > 0 && std::isfinite(c)) values.push_back(c);
    }
  }
  if (values.empty()) return 0;
  const size_t rank =
      std::min(values.size() - 1, size_t(double(values.size()) * std::clamp(percent, 0.0, 100.0) / 100));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(rank), values.end());
  return values[rank];
}

}  // namespace aligngs
