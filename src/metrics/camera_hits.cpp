#include "metrics/camera_hits.h"

namespace aligngs {

HitCache::Looks& HitCache::looks(const std::vector<uint8_t>& there) {
  for (Looks& known : looks_) {
    if (known.there == there) return known;
  }
  return looks_.emplace_back(Looks{there, std::vector<std::optional<CameraHits>>(cameras_.size())});
}

const CameraHits& HitCache::of(size_t camera, const std::vector<uint8_t>& there) {
  std::optional<CameraHits>& look = looks(there).of_camera.at(camera);
  if (look) return *look;
  const FirstHits first = rays_.cast(cameras_[camera], pool_, &there);
  look.emplace();
  look->hit = Image<uint8_t>(first.triangle.width, first.triangle.height, 1);
  std::vector<uint8_t> known(triangles_, 0);
  for (size_t i = 0; i < first.triangle.data.size(); ++i) {
    const uint32_t t = first.triangle.data[i];
    if (t == kNoTriangle) continue;
    look->hit.data[i] = 1;
    if (!known[t]) look->triangles.push_back(t);
    known[t] = 1;
  }
  return *look;
}

std::vector<uint8_t> HitCache::seen(const std::vector<size_t>& cameras, const std::vector<uint8_t>& there) {
  std::vector<uint8_t> seen(triangles_, 0);
  for (const size_t camera : cameras) {
    for (const uint32_t t : of(camera, there).triangles) seen[t] = 1;
  }
  return seen;
}

}  // namespace aligngs
