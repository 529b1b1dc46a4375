#include "room/seen_rays.h"

#include <algorithm>
#include <cmath>

#include "scene/triangle_mesh.h"

namespace aligngs {

std::vector<SeenRay> seen_rays(const std::vector<PlaneView>& views, const Similarity& to_room, int stride, int edge) {
  std::vector<SeenRay> out;
  for (const PlaneView& view : views) {
    const Vec3d from = to_room * view.camera.centre();
    const int width = view.depth.width, height = view.depth.height;
    const bool labelled = view.labels.width == width && view.labels.height == height;
    const auto label_of = [&](int x, int y) {
      if (!labelled) return kNoLabel;
      const uint16_t own = view.labels.at(x, y);
      for (int dy = -edge; dy <= edge; dy += std::max(1, edge)) {
        for (int dx = -edge; dx <= edge; dx += std::max(1, edge)) {
          if (view.labels.at(std::clamp(x + dx, 0, width - 1), std::clamp(y + dy, 0, height - 1)) != own)
            return kNoLabel;
        }
      }
      return own;
    };
    for (int y = stride / 2; y < height; y += stride) {
      for (int x = stride / 2; x < width; x += stride) {
        const float z = view.depth.at(x, y);
        if (!(z > 0) || !std::isfinite(z)) continue;
        const Vec3d to = to_room * view.camera.unproject(x + 0.5, y + 0.5, z);
        if (std::isfinite(dot(to, to))) out.push_back({from, to, label_of(x, y)});
      }
    }
  }
  return out;
}

}  // namespace aligngs
