#include "refine/photo_alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"
#include "io/resample.h"

namespace aligngs {
namespace {

/// Six of the pose (translation, then rotation, of the camera frame), gain and bias of the photo.
constexpr int kNumbers = 8;
using Vector = Eigen::Matrix<double, kNumbers, 1>;
using Matrix = Eigen::Matrix<double, kNumbers, kNumbers>;

constexpr double kFirstDamping = 1e-4, kMostDamping = 1e4;  // shares of the diagonal
constexpr double kLeastLumaCurvature = 1e-12;               // of numbers that nothing determines
constexpr int kLeastSize = 24;                              // pixels: smaller pictures show nothing
constexpr int kBrightnessRounds = 6;
constexpr double kGainHold = 1e-4;  // variance of grey beside which a photo has no contrast

/// Data of a photo at one size.
struct PhotoLevel {
  Camera camera;  ///< size and lens
  ImageF grey, mask;
};

float grey_at(const ImageF& color, int x, int y) {
  return (color.at(x, y, 0) + color.at(x, y, 1) + color.at(x, y, 2)) / 3.0f;
}

ImageF grey_of(const ImageF& color) {
  ImageF grey(color.width, color.height, 1);
  for (int y = 0; y < color.height; ++y) {
    for (int x = 0; x < color.width; ++x) grey.at(x, y) = grey_at(color, x, y);
  }
  return grey;
}

std::vector<PhotoLevel> levels_of(const Camera& camera, const ImageF& photo, const ImageF& mask, int count) {
  std::vector<PhotoLevel> levels{{camera, grey_of(photo), mask}};
  for (int i = 1; i < count; ++i) {
    const PhotoLevel& larger = levels.back();
    const int width = larger.camera.width / 2, height = larger.camera.height / 2;
    if (width < kLeastSize || height < kLeastSize) break;
    levels.push_back({larger.camera.resized(width, height), resize_area(larger.grey, width, height),
                      larger.mask.empty() ? ImageF() : resize_area(larger.mask, width, height)});
  }
  return levels;
}

/// A pixel of a rendering whose surface continues to its four neighbours.
struct Sample {
  double render = 0, photo = 0;  ///< grey
  Eigen::Matrix<double, 6, 1> by_pose;
};

bool on_surface(const ImageF& depth, int x, int y, double jump) {
  const float z = depth.at(x, y);
  if (!(z > 0) || !std::isfinite(z)) return false;
  for (const float n : {depth.at(x - 1, y), depth.at(x + 1, y), depth.at(x, y - 1), depth.at(x, y + 1)}) {
    if (!(std::abs(n - z) <= jump * z)) return false;
  }
  return true;
}

/// The picture moves with the surface, so the value at a pixel changes by -slope . d(image point).
Eigen::Matrix<double, 6, 1> value_by_pose(const Camera& camera, const Vec3d& p, double slope_x, double slope_y) {
  const double u = slope_x * camera.fx / p.z, v = slope_y * camera.fy / p.z;
  const Vec3d by_point{u, v, -(u * p.x + v * p.y) / p.z}, by_turn = cross(p, by_point);
  Eigen::Matrix<double, 6, 1> j;
  j << -by_point.x, -by_point.y, -by_point.z, -by_turn.x, -by_turn.y, -by_turn.z;
  return j;
}

/// grey of the render = gain * that of the photo + bias.
struct Brightness {
  double gain = 1, bias = 0;
};

/// The normal equations of one rendering.
struct Equations {
  Matrix a = Matrix::Zero();
  Vector b = Vector::Zero();
  double error = 0;  ///< mean norm with the best brightness
  double depth = 0;  ///< mean of the samples, scene units
  bool usable = false;
};

class Aligner {
 public:
  Aligner(const LookAtScene& look, const PhotoAlignmentSettings& settings) : look_(look), settings_(settings) {}

  int renderings() const { return renderings_; }

  /// `seen` becomes the scene from the pose.
  Equations measure(const PhotoLevel& level, const Rigidd& pose, SceneLook& seen) {
    Camera camera = level.camera;
    camera.world_to_camera = pose;
    seen = look_(camera);
    ++renderings_;
    return equations(level, camera, seen);
  }

  /// `seen` is the scene from the camera, of the level's size.
  Equations equations(const PhotoLevel& level, const Camera& camera, const SceneLook& seen) const {
    Equations e;
    const std::vector<Sample> samples = samples_of(level, camera, seen, e.depth);
    const double all = static_cast<double>(camera.width) * camera.height;
    e.usable = static_cast<double>(samples.size()) >= std::max(1.0, settings_.least_share * all);
    if (!e.usable) return e;
    const Brightness brightness = fit_brightness(samples);
    for (const Sample& s : samples) {
      const double residual = s.render - brightness.gain * s.photo - brightness.bias, weight = weight_of(residual);
      Vector j;
      j << s.by_pose, -s.photo, -1;
      e.a.noalias() += weight * j * j.transpose();
      e.b.noalias() += weight * residual * j;
      e.error += norm_of(residual);
    }
    e.error /= static_cast<double>(samples.size());
    return e;
  }

  /// Improves `pose` at one size. Returns the equations there; `seen` becomes the scene from there.
  Equations descend(const PhotoLevel& level, Rigidd& pose, SceneLook& seen) {
    Equations e = measure(level, pose, seen);
    double damping = kFirstDamping;
    for (int step = 1; step < settings_.steps && e.usable && damping < kMostDamping; ++step) {
      Matrix a = e.a;
      for (int k = 0; k < kNumbers; ++k) a(k, k) += damping * e.a(k, k) + kLeastLumaCurvature;
      const Vector d = a.ldlt().solve(-e.b);
      if (!d.allFinite()) break;
      const Rigidd turn{rotation_matrix(normalized(Quaterniond{1, d[3] / 2, d[4] / 2, d[5] / 2})), {d[0], d[1], d[2]}};
      const Rigidd moved = turn * pose;
      SceneLook seen_next;
      const Equations next = measure(level, moved, seen_next);
      if (!next.usable || !(next.error < e.error)) {
        damping *= 10;
        continue;
      }
      const double motion = level.camera.fx * (d.segment<3>(3).norm() + d.head<3>().norm() / e.depth);
      pose = moved;
      e = next;
      seen = std::move(seen_next);
      damping = std::max(kFirstDamping, damping / 10);
      if (motion < settings_.still) break;
    }
    return e;
  }

 private:
  // Cauchy's norm: what the scene does not have, as a person in the photo, must not pull.
  double weight_of(double residual) const {
    const double share = residual / settings_.scale;
    return 1 / (1 + share * share);
  }
  double norm_of(double residual) const {
    const double share = residual / settings_.scale;
    return 0.5 * settings_.scale * settings_.scale * std::log1p(share * share);
  }

  std::vector<Sample> samples_of(const PhotoLevel& level, const Camera& camera, const SceneLook& seen,
                                 double& depth) const {
    const ImageF grey = grey_of(seen.color);
    std::vector<Sample> samples;
    double sum = 0;
    for (int y = 1; y + 1 < camera.height; ++y) {
      for (int x = 1; x + 1 < camera.width; ++x) {
        if (!level.mask.empty() && !(level.mask.at(x, y) > 0.5f)) continue;
        if (!on_surface(seen.depth, x, y, settings_.depth_jump)) continue;
        const double z = seen.depth.at(x, y);
        Sample s;
        s.render = grey.at(x, y);
        s.photo = level.grey.at(x, y);
        s.by_pose =
            value_by_pose(camera, camera.ray(x + 0.5, y + 0.5) * z, 0.5 * (grey.at(x + 1, y) - grey.at(x - 1, y)),
                          0.5 * (grey.at(x, y + 1) - grey.at(x, y - 1)));
        if (!std::isfinite(s.render) || !std::isfinite(s.photo) || !s.by_pose.allFinite()) continue;
        samples.push_back(s);
        sum += z;
      }
    }
    depth = samples.empty() ? 1 : sum / static_cast<double>(samples.size());
    return samples;
  }

  /// Reweighted least squares; a gain of 1 holds where a photo has no contrast.
  Brightness fit_brightness(const std::vector<Sample>& samples) const {
    Brightness out;
    for (int round = 0; round < kBrightnessRounds; ++round) {
      double n = 0, x = 0, y = 0, xx = 0, xy = 0;
      for (const Sample& s : samples) {
        const double w = weight_of(s.render - out.gain * s.photo - out.bias);
        n += w;
        x += w * s.photo;
        y += w * s.render;
        xx += w * s.photo * s.photo;
        xy += w * s.photo * s.render;
      }
      const double hold = kGainHold * n, variance = xx - x * x / n, covariance = xy - x * y / n;
      out.gain = (covariance + hold) / (variance + hold);
      out.bias = (y - out.gain * x) / n;
    }
    return out;
  }

  const LookAtScene& look_;
  const PhotoAlignmentSettings& settings_;
  int renderings_ = 0;
};

}  // namespace

PhotoAlignment align_to_photo(PhotoToAlign photo, const LookAtScene& look, const PhotoAlignmentSettings& settings) {
  const Camera& start = photo.start;
  const auto fits = [&](const ImageF& map) { return map.width == start.width && map.height == start.height; };
  const bool sizes = fits(photo.color) && photo.color.channels == 3 && (photo.mask.empty() || fits(photo.mask)) &&
                     (!photo.seen || (fits(photo.seen->color) && fits(photo.seen->depth)));
  if (!sizes) {
    throw Error({ErrorKind::kFailed,
                 "a photo to be aligned does not have the size of its camera",
                 {},
                 "color",
                 "bring every map of a view to the size of its camera"});
  }
  PhotoAlignment result;
  result.camera = start;
  result.renderings = photo.seen ? 0 : 1;
  result.seen = photo.seen ? std::move(*photo.seen) : look(start);
  if (start.width < kLeastSize || start.height < kLeastSize) return result;
  const std::vector<PhotoLevel> levels = levels_of(start, photo.color, photo.mask, std::max(1, settings.levels));
  Aligner aligner(look, settings);
  Rigidd pose = start.world_to_camera;
  const Equations first = aligner.equations(levels.front(), start, result.seen);
  Equations last;
  SceneLook seen;
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) last = aligner.descend(*level, pose, seen);
  result.renderings += aligner.renderings();
  result.before = first.error;
  result.after = last.error;
  if (!first.usable || !last.usable || !(last.error < first.error)) return result;
  result.camera.world_to_camera = pose;
  result.seen = std::move(seen);
  return result;
}

}  // namespace aligngs
