#include "mesh/view_consistency.h"

#include <algorithm>
#include <cmath>

#include "core/median.h"

namespace aligngs {
namespace {

constexpr size_t kConsistencyRows = 8;  // image rows per chunk
constexpr int kResidualStride = 8;      // pixels between the samples of two_view_residual
constexpr double kOccluded = 0.10;      // relative depth difference of different surfaces

/// The way of a pixel of one view into the image of another.
struct Transfer {
  Rigidd motion;  // camera a -> camera b
  const Camera* a;
  const Camera* b;

  Transfer(const Camera& from, const Camera& to)
      : motion(to.world_to_camera * from.world_to_camera.inverse()), a(&from), b(&to) {}

  /// Depth in b of the point of a at image point (u, v) and depth z, and the pixel that it falls on.
  bool apply(double u, double v, double z, double& depth, int& x, int& y) const {
    const Vec3d p = motion * (a->ray(u, v) * z);
    if (!(p.z > 0)) return false;
    const Vec2d uv = b->project(p);
    if (!b->contains(uv)) return false;
    depth = p.z;
    x = static_cast<int>(uv.x);
    y = static_cast<int>(uv.y);
    return true;
  }
};

}  // namespace

ImageF usable_depth(const FusionFrame& frame, double min_alpha, double max_depth) {
  ImageF depth(frame.camera.width, frame.camera.height, 1);
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const float d = valid_depth(frame.depth, x, y);
      if (max_depth > 0 && d > max_depth) continue;
      if (!frame.alpha.empty() && !(frame.alpha.at(x, y) >= min_alpha)) continue;
      depth.at(x, y) = d;
    }
  }
  return depth;
}

Image<uint8_t> pixel_support(const std::vector<FusionFrame>& frames, const std::vector<ImageF>& depths, size_t index,
                             ThreadPool& pool, const ConsistencyOptions& options) {
  const Camera& camera = frames[index].camera;
  struct Pair {
    Transfer there, back;
    const ImageF* depth;
  };
  std::vector<Pair> others;
  std::vector<std::pair<double, size_t>> by_distance;  // near views first: they decide most pixels
  for (size_t i = 0; i < frames.size(); ++i) {
    if (i == index || frames[i].interpolated) continue;
    by_distance.emplace_back(norm(frames[i].camera.centre() - camera.centre()), i);
  }
  std::sort(by_distance.begin(), by_distance.end());
  for (const auto& [distance, i] : by_distance) {
    others.push_back({Transfer(camera, frames[i].camera), Transfer(frames[i].camera, camera), &depths[i]});
  }

  Image<uint8_t> support(camera.width, camera.height, 1, static_cast<uint8_t>(PixelSupport::kNone));
  const double pixels2 = options.pixel_tolerance * options.pixel_tolerance;
  const auto judge = [&](int x, int y) {
    const double u = x + 0.5, v = y + 0.5, z = depths[index].at(x, y);
    if (z == 0) return PixelSupport::kNone;
    bool seen_through = false;
    for (const Pair& pair : others) {
      double expected = 0;
      int bx = 0, by = 0;
      if (!pair.there.apply(u, v, z, expected, bx, by)) continue;
      const double found = pair.depth->at(bx, by);
      if (found == 0) continue;
      if (std::abs(found - expected) <= options.depth_tolerance * expected) {
        // The surface found there, at the same image point, seen from here again.
        const Vec3d p = pair.there.motion * (camera.ray(u, v) * z);
        const Vec3d back = pair.back.motion * (p * (found / p.z));
        if (back.z > 0) {
          const Vec2d uv = camera.project(back);
          if ((uv.x - u) * (uv.x - u) + (uv.y - v) * (uv.y - v) <= pixels2) return PixelSupport::kConfirmed;
        }
      }
      seen_through = seen_through || found > expected * (1 + options.see_through);
    }
    return seen_through ? PixelSupport::kContradicted : PixelSupport::kSingleView;
  };
  pool.parallel_for(camera.height, kConsistencyRows, [&](size_t begin, size_t end, int) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < camera.width; ++x) support.at(x, y) = static_cast<uint8_t>(judge(x, y));
    }
  });
  return support;
}

double two_view_residual(const std::vector<FusionFrame>& frames, const std::vector<ImageF>& depths, ThreadPool& pool) {
  std::vector<std::vector<float>> residuals(frames.size());
  pool.parallel_for(frames.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      if (frames[i].interpolated) continue;
      for (size_t j = 0; j < frames.size(); ++j) {
        if (j == i || frames[j].interpolated) continue;
        const Transfer there(frames[i].camera, frames[j].camera);
        for (int y = kResidualStride / 2; y < frames[i].camera.height; y += kResidualStride) {
          for (int x = kResidualStride / 2; x < frames[i].camera.width; x += kResidualStride) {
            const double z = depths[i].at(x, y);
            double expected = 0;
            int bx = 0, by = 0;
            if (z == 0 || !there.apply(x + 0.5, y + 0.5, z, expected, bx, by)) continue;
            const double found = depths[j].at(bx, by);
            if (found == 0 || std::abs(found - expected) > kOccluded * expected) continue;
            residuals[i].push_back(static_cast<float>(std::abs(found - expected)));
          }
        }
      }
    }
  });
  std::vector<float> all;
  for (const auto& r : residuals) all.insert(all.end(), r.begin(), r.end());
  return median_of(std::move(all));
}

}  // namespace aligngs
