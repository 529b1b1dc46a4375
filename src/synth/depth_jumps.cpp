#include "synth/depth_jumps.h"

#include <algorithm>
#include <cmath>

namespace aligngs {

DepthJumps find_depth_jumps(const RenderedView& view, int radius) {
  const int w = view.depth.width, h = view.depth.height;
  DepthJumps jumps{ImageF(w, h, 1), ImageF(w, h, 1)};
  const auto point = [&](int x, int y) {
    return view.camera.ray(x + 0.5, y + 0.5) * static_cast<double>(view.depth.at(x, y));
  };
  const Mat3d& rotation = view.camera.world_to_camera.rotation;
  const auto normal = [&](int x, int y) {
    return rotation * Vec3d{view.normal.at(x, y, 0), view.normal.at(x, y, 1), view.normal.at(x, y, 2)};
  };
  // A jump: each point lies off the other's tangent plane by more than 2 % of the depth (a slanted plane does not).
  const auto jump = [&](int ax, int ay, int bx, int by) {
    const double za = view.depth.at(ax, ay), zb = view.depth.at(bx, by);
    if (!(za > 0) || !(zb > 0)) return false;
    const Vec3d d = point(bx, by) - point(ax, ay);
    return std::min(std::fabs(dot(normal(ax, ay), d)), std::fabs(dot(normal(bx, by), d))) > 0.02 * std::min(za, zb);
  };
  const auto spread = [&](int px, int py, int qx, int qy) {
    // p and q touch across a jump; pixels on p's side near it learn of q's depth.
    const double edge_x = 0.5 * (px + qx), edge_y = 0.5 * (py + qy);
    const float zp = view.depth.at(px, py), zq = view.depth.at(qx, qy);
    for (int y = std::max(0, py - radius); y <= std::min(h - 1, py + radius); ++y) {
      for (int x = std::max(0, px - radius); x <= std::min(w - 1, px + radius); ++x) {
        const float z = view.depth.at(x, y);
        if (!(z > 0) || std::fabs(z - zp) >= std::fabs(z - zq)) continue;
        const float d = static_cast<float>(std::hypot(x - edge_x, y - edge_y));
        if (d > static_cast<float>(radius)) continue;
        if (jumps.distance.at(x, y) == 0 || d < jumps.distance.at(x, y)) {
          jumps.distance.at(x, y) = d;
          jumps.other.at(x, y) = zq;
        }
      }
    }
  };
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
        if (x + dx >= w || y + dy >= h || !jump(x, y, x + dx, y + dy)) continue;
        spread(x, y, x + dx, y + dy);
        spread(x + dx, y + dy, x, y);
      }
    }
  }
  return jumps;
}

ImageF mix_across_edges(const ImageF& depth, const DepthJumps& jumps, double width) {
  ImageF out = depth;
  for (size_t i = 0; i < depth.data.size(); ++i) {
    const float d = jumps.distance.data[i];
    if (d <= 0 || !(depth.data[i] > 0)) continue;
    // The sigmoid rises from 12 % to 88 % over its width; half and half on the edge.
    const double own = 1 / (1 + std::exp(-4.0 * d / width));
    out.data[i] = static_cast<float>(own * depth.data[i] + (1 - own) * jumps.other.data[i]);
  }
  return out;
}

}  // namespace aligngs
