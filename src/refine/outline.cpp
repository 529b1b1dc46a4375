#include "refine/outline.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

constexpr double kStep = 0.5;      // pixels between places that edges are looked for at
constexpr double kReach = 3;       // standard deviations beyond which an edge is another one
constexpr int kOutlineRadius = 3;  // pixels: a label's outline is stairs, whose direction shows over several of them
constexpr int kBorder = 2;         // pixels: a region that ends there goes on outside

struct Sampler {
  const ImageF& gradient;

  /// Slope along a unit direction; 0 outside.
  double slope(double u, double v, const Vec2d& direction) const {
    const double x = u - 0.5, y = v - 0.5;
    if (!(x >= 0) || !(y >= 0) || x >= gradient.width - 1 || y >= gradient.height - 1) return 0;
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const double a = x - x0, b = y - y0;
    const auto between = [&](int c) {
      const double top = gradient.at(x0, y0, c) * (1 - a) + gradient.at(x0 + 1, y0, c) * a;
      const double bottom = gradient.at(x0, y0 + 1, c) * (1 - a) + gradient.at(x0 + 1, y0 + 1, c) * a;
      return top * (1 - b) + bottom * b;
    };
    return between(0) * direction.x + between(1) * direction.y;
  }
};

double length(const Vec2d& v) { return std::hypot(v.x, v.y); }

/// How much a place's surroundings rise into the region: towards it, not unit.
Vec2d inward(const Image<uint8_t>& region, int x, int y) {
  Vec2d sum;
  for (int dy = -kOutlineRadius; dy <= kOutlineRadius; ++dy) {
    for (int dx = -kOutlineRadius; dx <= kOutlineRadius; ++dx) {
      const int u = std::clamp(x + dx, 0, region.width - 1), v = std::clamp(y + dy, 0, region.height - 1);
      if (!region.at(u, v)) continue;
      sum.x += dx;
      sum.y += dy;
    }
  }
  return sum;
}

bool is_outline(const Image<uint8_t>& region, int x, int y) {
  if (!region.at(x, y) || x < kBorder || y < kBorder || x + kBorder >= region.width || y + kBorder >= region.height)
    return false;
  return !region.at(x - 1, y) || !region.at(x + 1, y) || !region.at(x, y - 1) || !region.at(x, y + 1);
}

/// The steepest place on a line across the outline whose edge runs along with it.
std::optional<OutlinePoint> edge_near(const ImageF& gradient, const Vec2d& place, const Vec2d& across,
                                      const OutlineSettings& s) {
  const Sampler sampler{gradient};
  const double reach = s.label_error * gradient.width;
  std::optional<OutlinePoint> best;
  for (double t = -reach; t <= reach; t += kStep) {
    const Vec2d at{place.x + t * across.x, place.y + t * across.y};
    if (at.x < kBorder || at.y < kBorder || at.x > gradient.width - kBorder || at.y > gradient.height - kBorder)
      continue;
    const Vec2d rise{sampler.slope(at.x, at.y, {1, 0}), sampler.slope(at.x, at.y, {0, 1})};
    const double slope = length(rise);
    if (slope < s.least_slope || (best && slope <= best->slope)) continue;
    if (std::abs(rise.x * across.x + rise.y * across.y) < s.along * slope) continue;
    best = OutlinePoint{at, {rise.x / slope, rise.y / slope}, slope};
  }
  return best;
}

/// 1 where an edge that rises along `rise` is at `place`, less the farther it is, 0 where there is none.
double edge_at(const Sampler& sampler, const Vec2d& place, const Vec2d& rise, double least_slope, double sigma) {
  const auto slope = [&](double t) { return sampler.slope(place.x + t * rise.x, place.y + t * rise.y, rise); };
  const double reach = std::ceil(kReach * sigma / kStep) * kStep;
  double before = slope(-reach - kStep), here = slope(-reach), best = 0;
  for (double t = -reach; t <= reach; t += kStep) {
    const double after = slope(t + kStep);
    if (here >= least_slope && here >= before && here > after) {
      const double curvature = before - 2 * here + after;
      const double exact = t + (curvature < 0 ? kStep * std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0);
      best = std::max(best, std::exp(-0.5 * exact * exact / (sigma * sigma)));
    }
    before = here;
    here = after;
  }
  return best;
}

/// Takes image points onto a plane and into another photo.
class Transfer {
 public:
  Transfer(const Camera& camera, const WorldPlane& plane, const Camera& other)
      : camera_(camera),
        other_(other),
        relative_(other.world_to_camera * camera.world_to_camera.inverse()),
        normal_(camera.world_to_camera.rotation * plane.normal),
        distance_(dot(plane.normal, camera.centre()) + plane.offset) {}

  bool faces_both(const WorldPlane& plane) const {
    const double there = dot(plane.normal, other_.centre()) + plane.offset;
    return distance_ > 0 && there > 0;
  }
  std::optional<Vec2d> operator()(double u, double v) const {
    const Vec3d ray = camera_.ray(u, v);
    const double slope = -dot(normal_, ray);
    if (!(slope > 0)) return std::nullopt;
    const Vec3d there = relative_ * (ray * (distance_ / slope));
    if (!(there.z > 0)) return std::nullopt;
    return other_.project(there);
  }

 private:
  const Camera& camera_;
  const Camera& other_;
  Rigidd relative_;
  Vec3d normal_;
  double distance_;
};

}  // namespace

ImageF luma_gradient(const ImageF& luma) {
  const int width = luma.width, height = luma.height;
  const auto smooth = [&](const ImageF& in, int dx, int dy) {  // [1 2 1] twice: a variance of one pixel
    ImageF out(width, height, 1);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        float sum = 0;
        constexpr float kWeights[5] = {1, 4, 6, 4, 1};
        for (int k = -2; k <= 2; ++k) {
          sum += kWeights[k + 2] * in.at(std::clamp(x + k * dx, 0, width - 1), std::clamp(y + k * dy, 0, height - 1));
        }
        out.at(x, y) = sum / 16;
      }
    }
    return out;
  };
  const ImageF soft = smooth(smooth(luma, 1, 0), 0, 1);
  ImageF out(width, height, 2);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int left = std::max(x - 1, 0), right = std::min(x + 1, width - 1), above = std::max(y - 1, 0),
                below = std::min(y + 1, height - 1);
      if (right > left) out.at(x, y, 0) = (soft.at(right, y) - soft.at(left, y)) / static_cast<float>(right - left);
      if (below > above) out.at(x, y, 1) = (soft.at(x, below) - soft.at(x, above)) / static_cast<float>(below - above);
    }
  }
  return out;
}

std::vector<OutlinePoint> outline_of(const Image<uint8_t>& region, const ImageF& gradient,
                                     const OutlineSettings& settings) {
  std::vector<OutlinePoint> out;
  int number = 0;
  for (int y = 0; y < region.height; ++y) {
    for (int x = 0; x < region.width; ++x) {
      if (!is_outline(region, x, y) || number++ % settings.stride != 0) continue;
      const Vec2d into = inward(region, x, y);
      const double size = length(into);
      if (!(size > 0)) continue;
      const auto point = edge_near(gradient, {x + 0.5, y + 0.5}, {into.x / size, into.y / size}, settings);
      if (point) out.push_back(*point);
    }
  }
  return out;
}

OutlineAgreement agreement(const std::vector<OutlinePoint>& outline, const Camera& camera, const WorldPlane& plane,
                           const Camera& other, const ImageF& gradient, const OutlineSettings& settings) {
  const Transfer transfer(camera, plane, other);
  if (outline.empty() || !transfer.faces_both(plane)) return {};
  const Sampler sampler{gradient};
  const double sigma = settings.sigma * gradient.width, margin = kReach * sigma + 1;
  double sum = 0;
  size_t inside = 0;
  for (const OutlinePoint& point : outline) {
    const Vec2d along{-point.rise.y, point.rise.x};
    const auto place = transfer(point.place.x, point.place.y);
    if (!place || place->x < margin || place->y < margin || place->x > gradient.width - margin ||
        place->y > gradient.height - margin)
      continue;
    const auto beside = transfer(point.place.x + along.x, point.place.y + along.y),
               up = transfer(point.place.x + point.rise.x, point.place.y + point.rise.y);
    if (!beside || !up) continue;
    const Vec2d run{beside->x - place->x, beside->y - place->y};
    const double size = length(run);
    if (!(size > 0)) continue;
    Vec2d rise{run.y / size, -run.x / size};
    if (rise.x * (up->x - place->x) + rise.y * (up->y - place->y) < 0) rise = {-rise.x, -rise.y};
    ++inside;
    sum += edge_at(sampler, *place, rise, std::max(settings.least_slope, settings.slope_share * point.slope), sigma);
  }
  if (inside == 0) return {};
  return {sum / static_cast<double>(inside), static_cast<double>(inside) / static_cast<double>(outline.size())};
}

std::vector<Vec3d> on_plane(const std::vector<OutlinePoint>& outline, const Camera& camera, const WorldPlane& plane) {
  const Rigidd to_world = camera.world_to_camera.inverse();
  const double distance = dot(plane.normal, to_world.translation) + plane.offset;
  std::vector<Vec3d> out;
  for (const OutlinePoint& point : outline) {
    const Vec3d ray = to_world.rotation * camera.ray(point.place.x, point.place.y);
    const double slope = -dot(plane.normal, ray);
    if (distance > 0 && slope > 0) out.push_back(to_world.translation + ray * (distance / slope));
  }
  return out;
}

}  // namespace aligngs
