#include "edit/export/photo_weight.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace aligngs {
namespace {

/// A step between neighbouring pixels beyond this share of the depth is a jump to another surface.
constexpr float kJump = 0.05f;

}  // namespace

PhotoWeight::PhotoWeight(const TexturePhoto& photo, double extent, double texel, const BakeSettings& settings)
    : photo_(photo),
      settings_(settings),
      centre_(photo.camera.centre()),
      tolerance_(settings.tolerance * extent),
      texel_(texel),
      silhouette_(photo.depth.width, photo.depth.height, 1, 1.0f) {
  const ImageF& depth = photo.depth;
  const auto mark = [&](int x, int y) {
    for (int j = std::max(0, y - settings.silhouette); j <= std::min(depth.height - 1, y + settings.silhouette); ++j) {
      for (int i = std::max(0, x - settings.silhouette); i <= std::min(depth.width - 1, x + settings.silhouette); ++i)
        silhouette_.at(i, j) = static_cast<float>(settings.silhouette_weight);
    }
  };
  const auto jumps = [](float a, float b) { return (a > 0) != (b > 0) || std::abs(a - b) > kJump * std::min(a, b); };
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      if ((x + 1 < depth.width && jumps(depth.at(x, y), depth.at(x + 1, y))) ||
          (y + 1 < depth.height && jumps(depth.at(x, y), depth.at(x, y + 1))))
        mark(x, y);
    }
  }
}

PhotoWeight::Look PhotoWeight::at(const Vec3f& place, const Vec3f& normal) const {
  const Vec3d world = place.cast<double>(), seen = photo_.camera.world_to_camera * world;
  if (!(seen.z > 0)) return {};
  const Vec2d pixel = photo_.camera.project(seen);
  if (!photo_.camera.contains(pixel)) return {};
  const Vec3d ray = centre_ - world;
  const double distance = norm(ray), cosine = dot(ray, normal.cast<double>()) / distance;
  if (!(cosine > settings_.least_cosine)) return {};
  const int x = static_cast<int>(pixel.x), y = static_cast<int>(pixel.y);
  const double depth = photo_.depth.at(x, y);
  if (!(depth > 0) || std::abs(depth - seen.z) * cosine > tolerance_) return {};
  if (!photo_.mask.empty() && photo_.mask.at(x, y) < 128) return {};
  // Pixels per texel: more than one has no use.
  const double resolution = std::min(1.0, photo_.camera.fx * texel_ / seen.z);
  const double border = settings_.border * photo_.camera.width;
  const double edge = std::min({pixel.x, pixel.y, photo_.camera.width - pixel.x, photo_.camera.height - pixel.y});
  const double inside = std::clamp(edge / border, 0.01, 1.0);
  return {cosine * resolution * resolution * photo_.sharpness * inside * silhouette_.at(x, y), pixel};
}

Vec3d PhotoWeight::color(const Vec2d& pixel) const {
  const Image<uint8_t>& image = photo_.color;
  const double x = std::clamp(pixel.x - 0.5, 0.0, image.width - 1.0),
               y = std::clamp(pixel.y - 0.5, 0.0, image.height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y), x1 = std::min(x0 + 1, image.width - 1),
            y1 = std::min(y0 + 1, image.height - 1);
  const double fx = x - x0, fy = y - y0;
  Vec3d out;
  for (int c = 0; c < 3; ++c) {
    out[c] = ((1 - fy) * ((1 - fx) * image.at(x0, y0, c) + fx * image.at(x1, y0, c)) +
              fy * ((1 - fx) * image.at(x0, y1, c) + fx * image.at(x1, y1, c))) /
             255;
  }
  return out;
}

std::vector<PhotoWeight> photo_weights(const TexturePhotos& photos, double extent, double texel,
                                       const BakeSettings& settings, ThreadPool& pool) {
  std::vector<std::optional<PhotoWeight>> made(photos.photos.size());
  pool.parallel_for(made.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) made[i].emplace(photos.photos[i], extent, texel, settings);
  });
  std::vector<PhotoWeight> out;
  for (auto& weight : made) out.push_back(std::move(*weight));
  return out;
}

}  // namespace aligngs
