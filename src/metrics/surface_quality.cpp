#include "metrics/surface_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/median.h"
#include "metrics/surface_points.h"
#include "metrics/undefined.h"

namespace aligngs {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr size_t kSurfaceGrain = 512;  // samples per chunk of work
constexpr int kRayColumns = 320;       // of the images whose pixels are beside a point
// metres that a true sample may lie behind its own surface: rounding of single precision
constexpr double kSeenTolerance = 0.005;
// metres: rays beside a point that end this far from its tangent plane meet another surface
constexpr double kPlaneOfContour = 0.02;

Vec3d corner(const TriangleMesh& mesh, size_t triangle, int i) {
  return mesh.vertices[mesh.triangles[triangle][i]].cast<double>();
}

/// Unit; zero for a degenerate triangle.
Vec3d face_normal(const TriangleMesh& mesh, size_t triangle) {
  const Vec3d a = corner(mesh, triangle, 0);
  return normalized(cross(corner(mesh, triangle, 1) - a, corner(mesh, triangle, 2) - a));
}

double angle_degrees(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegrees; }

/// An angle and how much it counts.
struct WeightedAngle {
  float degrees = 0, weight = 0;
};

AngleSummary summary_of(std::vector<WeightedAngle> angles) {
  double total = 0, sum = 0;
  for (const WeightedAngle& a : angles) {
    total += a.weight;
    sum += double(a.weight) * a.degrees;
  }
  if (!(total > 0)) return {kUndefined, kUndefined};
  std::sort(angles.begin(), angles.end(),
            [](const WeightedAngle& a, const WeightedAngle& b) { return a.degrees < b.degrees; });
  double passed = 0;
  for (const WeightedAngle& a : angles) {
    passed += a.weight;
    if (passed >= total / 2) return {sum / total, a.degrees};
  }
  return {sum / total, angles.back().degrees};
}

Camera at_ray_columns(const Camera& camera) {
  const int rows = std::max(1, static_cast<int>(std::lround(double(camera.height) * kRayColumns / camera.width)));
  return camera.resized(kRayColumns, rows);
}

class Measurement {
 public:
  Measurement(const SurfaceQualityInput& input, ThreadPool& pool, const SurfaceQualityOptions& options)
      : input_(input),
        options_(options),
        pool_(pool),
        truth_(*input.truth),
        truth_rays_(*input.truth_rays),
        predicted_rays_(*input.predicted_rays) {
    for (const Camera& c : input.training) training_.push_back(at_ray_columns(c));
  }

  SurfaceQuality run() {
    const TriangleMesh seen = keep_triangles(*input_.predicted, input_.seen);
    measure_normals(seen);
    measure_roughness(seen);
    measure_pinholes();
    return result_;
  }

 private:
  bool structural(uint32_t triangle) const {
    if (input_.structural.empty() || truth_.labels.size() != truth_.vertices.size()) return false;
    const uint16_t label = truth_.labels[truth_.triangles[triangle][0]];
    return label < input_.structural.size() && input_.structural[label];
  }

  void measure_normals(const TriangleMesh& seen) {
    const SurfaceSamples samples = sample_surface(seen, {options_.points_per_area, options_.max_points, options_.seed});
    const size_t count = samples.positions.size();
    std::vector<float> angles(count, -1.0f);
    std::vector<uint8_t> on_structure(count, 0);
    pool_.parallel_for(count, kSurfaceGrain, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        const auto hit = truth_rays_.nearest(samples.positions[i].cast<double>(), options_.reach);
        if (!hit) continue;
        angles[i] = static_cast<float>(
            angle_degrees(std::abs(dot(samples.normals[i].cast<double>(), face_normal(truth_, hit->triangle)))));
        on_structure[i] = structural(hit->triangle);
      }
    });
    std::vector<WeightedAngle> everywhere, structure;
    for (size_t i = 0; i < count; ++i) {
      if (angles[i] < 0) continue;
      everywhere.push_back({angles[i], 1});
      if (on_structure[i]) structure.push_back({angles[i], 1});
    }
    result_.normals = everywhere.size();
    result_.normal_error = summary_of(std::move(everywhere));
    result_.structure_normal_error = summary_of(std::move(structure));
  }

  bool planar_at(const SurfacePoint& at) const {
    const Vec3d n = face_normal(truth_, at.triangle);
    if (!(norm(n) > 0)) return false;
    const Vec3d u = normalized(cross(n, std::abs(n.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0})), v = cross(n, u);
    const double least = std::cos(options_.planar_degrees / kDegrees);
    for (int k = 0; k < 8; ++k) {
      const double angle = k * std::numbers::pi / 4;
      const auto beside = truth_rays_.nearest(
          at.position + (u * std::cos(angle) + v * std::sin(angle)) * options_.planar_radius, options_.planar_distance);
      if (!beside || std::abs(dot(face_normal(truth_, beside->triangle), n)) < least) return false;
    }
    return true;
  }

  void measure_roughness(const TriangleMesh& seen) {
    struct Edge {
      uint32_t a, b, triangle;
    };
    std::vector<Edge> edges;
    for (size_t t = 0; t < seen.triangles.size(); ++t) {
      for (int i = 0; i < 3; ++i) {
        const uint32_t a = seen.triangles[t][i], b = seen.triangles[t][(i + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b), static_cast<uint32_t>(t)});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
      return std::array{x.a, x.b, x.triangle} < std::array{y.a, y.b, y.triangle};
    });
    std::vector<std::pair<Edge, uint32_t>> inner;  // edges of exactly two faces, and the second face
    for (size_t i = 0; i < edges.size();) {
      size_t end = i + 1;
      while (end < edges.size() && edges[end].a == edges[i].a && edges[end].b == edges[i].b) ++end;
      if (end - i == 2) inner.push_back({edges[i], edges[i + 1].triangle});
      i = end;
    }
    const size_t count = std::min(inner.size(), options_.max_edges);
    std::vector<WeightedAngle> angles(count);
    pool_.parallel_for(count, kSurfaceGrain, [&](size_t begin, size_t end, int) {
      for (size_t k = begin; k < end; ++k) {
        const auto& [edge, other] = inner[k * inner.size() / count];
        const Vec3d a = seen.vertices[edge.a].cast<double>(), b = seen.vertices[edge.b].cast<double>();
        const Vec3d n0 = face_normal(seen, edge.triangle), n1 = face_normal(seen, other);
        if (!(norm(n0) > 0) || !(norm(n1) > 0)) continue;
        const auto hit = truth_rays_.nearest((a + b) * 0.5, options_.reach);
        if (hit && planar_at(*hit))
          angles[k] = {static_cast<float>(angle_degrees(dot(n0, n1))), static_cast<float>(norm(b - a))};
      }
    });
    std::erase_if(angles, [](const WeightedAngle& a) { return !(a.weight > 0); });
    result_.edges = angles.size();
    result_.roughness = summary_of(std::move(angles));
  }

  /// Whether the rays a few pixels beside the point's end on its tangent plane as well.
  bool away_from_contours(const Camera& camera, const Vec3d& eye, const Vec2d& uv, const Vec3d& point,
                          const Vec3d& normal) const {
    for (int k = 0; k < 4; ++k) {
      const double du = k == 0 ? options_.contour_pixels : k == 1 ? -options_.contour_pixels : 0;
      const double dv = k == 2 ? options_.contour_pixels : k == 3 ? -options_.contour_pixels : 0;
      const Vec3d direction = transpose_times(camera.world_to_camera.rotation, camera.ray(uv.x + du, uv.y + dv));
      const double slope = dot(direction, normal);
      if (!(std::abs(slope) > 0)) return false;
      const double z = dot(point - eye, normal) / slope;
      const Vec3d beside = eye + direction * z;
      if (!(z > 0) || !truth_rays_.sees(eye, beside, kSeenTolerance)) return false;
      if (truth_rays_.sees(eye, beside + direction * (kPlaneOfContour / std::abs(slope)), 0)) return false;
    }
    return true;
  }

  /// Share of the views that see the point whose ray passes through it; negative: none sees it.
  double passed_through(const Vec3d& point, const Vec3d& normal) const {
    int seen = 0, passed = 0;
    for (const Camera& camera : training_) {
      const auto uv = project_into_image(camera, point);
      if (!uv) continue;
      const Vec3d eye = camera.centre(), ray = normalized(point - eye);
      const double facing = std::abs(dot(ray, normal));
      if (facing < options_.min_cosine || !truth_rays_.sees(eye, point, kSeenTolerance)) continue;
      if (!away_from_contours(camera, eye, *uv, point, normal)) continue;
      ++seen;
      passed += predicted_rays_.sees(eye, point + ray * (options_.pass_depth / facing), 0);
    }
    return seen ? double(passed) / seen : -1;
  }

  void measure_pinholes() {
    const SurfaceSamples samples = sample_surface(truth_, {options_.rays_per_area, options_.max_points, options_.seed});
    const size_t count = samples.positions.size();
    std::vector<float> passed(count);
    std::vector<uint8_t> on_structure(count, 0);
    pool_.parallel_for(count, kSurfaceGrain, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3d point = samples.positions[i].cast<double>();
        passed[i] = static_cast<float>(passed_through(point, samples.normals[i].cast<double>()));
        on_structure[i] = structural(samples.triangles[i]);
      }
    });
    double sum[2] = {}, seen[2] = {};
    for (size_t i = 0; i < count; ++i) {
      if (passed[i] < 0) continue;
      for (int s = 0; s <= on_structure[i]; ++s) {
        sum[s] += passed[i];
        ++seen[s];
      }
    }
    result_.pinholes = seen[0] > 0 ? sum[0] / seen[0] : kUndefined;
    result_.structure_pinholes = seen[1] > 0 ? sum[1] / seen[1] : kUndefined;
    result_.truth_seen = count ? samples.area * seen[0] / static_cast<double>(count) : 0;
  }

  const SurfaceQualityInput& input_;
  const SurfaceQualityOptions& options_;
  ThreadPool& pool_;
  const TriangleMesh& truth_;
  const RayScene &truth_rays_, &predicted_rays_;
  std::vector<Camera> training_;  // at kRayColumns
  SurfaceQuality result_;
};

}  // namespace

SurfaceQuality measure_surface(const SurfaceQualityInput& input, ThreadPool& pool,
                               const SurfaceQualityOptions& options) {
  return Measurement(input, pool, options).run();
}

}  // namespace aligngs
