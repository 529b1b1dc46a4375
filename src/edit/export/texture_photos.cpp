#include "edit/export/texture_photos.h"

#include <algorithm>
#include <cmath>

#include "io/image_file.h"
#include "metrics/visibility.h"
#include "refine/exposure.h"
#include "scene/image_quality.h"
#include "scene/view_data.h"

namespace aligngs {
namespace {

bool has_exposures(const Scene& scene) {
  return std::any_of(scene.train.begin(), scene.train.end(), [&](int v) {
    const Vec3f& gain = scene.views[static_cast<size_t>(v)].log_gain;
    return gain.x != 0 || gain.y != 0 || gain.z != 0;
  });
}

/// Divides each photo by its estimated gain.
void even_exposures(std::vector<TexturePhoto>& photos, ThreadPool& pool) {
  std::vector<ImageF> colors;
  std::vector<MatchView> matches;
  for (const TexturePhoto& photo : photos) {
    colors.push_back(to_float(photo.color));
    matches.push_back({photo.camera, {}, photo.depth});
  }
  std::vector<ExposureView> views;
  const ImageF none;
  for (size_t i = 0; i < photos.size(); ++i) views.push_back({&matches[i], &colors[i], &none});
  const std::vector<Vec3f> gains = estimate_log_gains(views, {}, pool);
  for (size_t i = 0; i < photos.size(); ++i) {
    divide_exposure(gains[i], colors[i]);
    photos[i].color = to_bytes(colors[i]);
  }
}

}  // namespace

TexturePhotos load_texture_photos(const Scene& scene, const TriangleMesh& surface, ThreadPool& pool, int largest) {
  TexturePhotos out;
  out.surface = surface;
  const RayScene rays(surface);
  LoadOptions options;
  options.prior_depth = options.semantics = false;
  options.exposure = has_exposures(scene);
  double sharpest = 0;
  int narrowest = kSharpnessWidth;  // pixels
  for (const int v : scene.train) {
    const Camera& camera = scene.views[static_cast<size_t>(v)].camera;
    options.scale = std::min(1.0, static_cast<double>(largest) / std::max(camera.width, camera.height));
    const ViewData view = load_view(scene, v, options);
    TexturePhoto photo;
    photo.camera = view.camera;
    photo.color = to_bytes(view.color);
    if (!view.mask.empty()) photo.mask = to_bytes(view.mask);
    photo.depth = rays.cast(view.camera, pool).depth;
    narrowest = std::min(narrowest, photo.camera.width);
    out.photos.push_back(std::move(photo));
  }
  for (TexturePhoto& photo : out.photos) {
    photo.sharpness = static_cast<float>(std::sqrt(sharpness(photo.color, narrowest)));
    sharpest = std::max(sharpest, static_cast<double>(photo.sharpness));
  }
  for (TexturePhoto& photo : out.photos)
    photo.sharpness = sharpest > 0 ? std::max(0.1f, static_cast<float>(photo.sharpness / sharpest)) : 1.0f;
  if (!options.exposure && out.photos.size() > 1) even_exposures(out.photos, pool);
  return out;
}

TexturePhotos moved(TexturePhotos photos, const Similarity& to) {
  for (TexturePhoto& photo : photos.photos) {
    photo.camera.world_to_camera = to.transform_world_to_camera(photo.camera.world_to_camera);
    for (float& z : photo.depth.data) z *= static_cast<float>(to.scale);
  }
  for (Vec3f& v : photos.surface.vertices) v = (to * v.cast<double>()).cast<float>();
  return photos;
}

}  // namespace aligngs
