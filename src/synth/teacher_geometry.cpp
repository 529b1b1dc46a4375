#include "synth/teacher_geometry.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/rotation_vector.h"
#include "synth/depth_jumps.h"
#include "synth/noise.h"
#include "synth/shared_misjudgement.h"

namespace aligngs {
namespace {

constexpr int kNetworkWidth = 518;  // input width of VGGT and DINOv2 heads, pixels
constexpr int kPatch = 14;          // of their tokens, network pixels

Vec3d gaussian_vector(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

/// Depth along the ray of each pixel of the bent camera. One is of the bent surface alone, one of the bent surface with
/// the errors common to all views.
struct BentDepth {
  ImageF bent, misjudged;
};

BentDepth bent_depth(const RenderedView& view, const WorldBend& bend, const SharedMisjudgement& misjudged,
                     const Rigidd& bent_pose) {
  const Rigidd to_world = view.camera.world_to_camera.inverse(), bent_to_world = bent_pose.inverse();
  BentDepth out{ImageF(view.depth.width, view.depth.height, 1), ImageF(view.depth.width, view.depth.height, 1)};
  const auto along_ray = [&](const Vec3d& surface, const Vec3d& normal, const Vec3d& direction) {
    const double depth = (bent_pose * surface).z, slope = dot(normal, direction) / norm(direction);
    if (std::fabs(slope) <= 0.15) return depth;
    // Intersection of the surface's tangent plane with this pixel's own ray.
    const double t = dot(normal, surface - bent_to_world.translation) / dot(normal, direction);
    return std::clamp(t, 0.9 * depth, 1.1 * depth);
  };
  for (int y = 0; y < view.depth.height; ++y) {
    for (int x = 0; x < view.depth.width; ++x) {
      const float z = view.depth.at(x, y);
      if (!(z > 0)) continue;
      const Vec3d ray = view.camera.ray(x + 0.5, y + 0.5), point = to_world * (ray * static_cast<double>(z));
      const Vec3d n{view.normal.at(x, y, 0), view.normal.at(x, y, 1), view.normal.at(x, y, 2)};
      const Vec3d moved = bend(point);
      // Normals transform with the cofactors of the Jacobian.
      const Mat3d j = bend.jacobian(point);
      const Vec3d c0 = j.column(0), c1 = j.column(1), c2 = j.column(2);
      const Vec3d normal = normalized(cross(c1, c2) * n.x + cross(c2, c0) * n.y + cross(c0, c1) * n.z);
      const Vec3d direction = bent_to_world.rotation * ray;
      out.bent.at(x, y) = static_cast<float>(along_ray(moved, normal, direction));
      const double shift = misjudged(point);
      out.misjudged.at(x, y) =
          shift == 0 ? out.bent.at(x, y) : static_cast<float>(along_ray(moved + normal * shift, normal, direction));
    }
  }
  return out;
}

/// Per object of a view: the relative depth error of glass and black gloss, +-10 to 30 %. Half of it belongs to the
/// object in all views. Also whether the network knows that it fails there.
struct UnreliableError {
  double relative = 0;
  bool noticed = false;
};
UnreliableError unreliable_error(uint16_t instance, size_t view, const Random& random) {
  Random object = random.fork(9000 + instance), own = random.fork(90000 + 977 * view + instance);
  const auto draw = [](Random& r) {
    const double size = r.uniform(0.1, 0.3);
    return r.chance(0.5) ? size : -size;
  };
  const double shared = draw(object);
  UnreliableError e;
  e.relative = own.chance(0.5) ? shared : draw(own);
  e.noticed = own.chance(0.5);
  return e;
}

/// Box mean with the given radius; borders use what there is.
ImageF box_mean(const ImageF& in, int radius) {
  ImageF rows(in.width, in.height, 1), out(in.width, in.height, 1);
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) {
      float sum = 0;
      int n = 0;
      for (int k = std::max(0, x - radius); k <= std::min(in.width - 1, x + radius); ++k) sum += in.at(k, y), ++n;
      rows.at(x, y) = sum / static_cast<float>(n);
    }
  }
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) {
      float sum = 0;
      int n = 0;
      for (int k = std::max(0, y - radius); k <= std::min(in.height - 1, y + radius); ++k) sum += rows.at(x, k), ++n;
      out.at(x, y) = sum / static_cast<float>(n);
    }
  }
  return out;
}

/// Replaces values by their rank, as a standard normal score.
void normal_scores(std::vector<float>& values) {
  std::vector<uint32_t> order(values.size());
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return values[a] != values[b] ? values[a] < values[b] : a < b; });
  for (size_t rank = 0; rank < order.size(); ++rank) {
    // Inverse of the logistic approximation to the normal distribution: enough for a score.
    const double p = (static_cast<double>(rank) + 0.5) / static_cast<double>(order.size());
    values[order[rank]] = static_cast<float>(std::log(p / (1 - p)) / 1.702);
  }
}

/// Confidence from the view's own relative error (without the bend): rank correlation 0.4 to 0.6 with it.
ImageF confidence_of(const ImageF& error, const DepthJumps& jumps, const Image<uint8_t>& known_bad, Random random) {
  ImageF score = box_mean(error, 1);
  for (float& e : score.data) e = std::log(e + 1e-3f);
  normal_scores(score.data);
  ImageF blind = smooth_random_map(score.width, score.height, 8, 6, 1, random);
  ImageF out(score.width, score.height, 1);
  for (size_t i = 0; i < out.data.size(); ++i) {
    // A network is least sure at edges, whatever its error there.
    const float edge = jumps.distance.data[i] > 0 ? 0.8f * std::exp(-jumps.distance.data[i] / 2) : 0.0f;
    float s = -0.48f * score.data[i] + 0.62f * blind.data[i] + 0.3f * static_cast<float>(random.normal()) - edge;
    if (known_bad.data[i] != 0) s -= 2.5f;
    out.data[i] = 1 + 5 * std::exp(0.7f * s);
  }
  return out;
}

}  // namespace

GeometryTeacher simulate_geometry_teacher(const std::vector<RenderedView>& views, const GeometryTeacherSettings& s,
                                          const Vec3d& centre, double extent, const Vec3d& up, Random random,
                                          ThreadPool& pool) {
  GeometryTeacher teacher;
  teacher.views.resize(views.size());
  Random bend_random = random.fork(1), pose_random = random.fork(2), focal_random = random.fork(3);
  const WorldBend bend({s.bend_rms, s.bend_degrees, extent}, centre, up, bend_random);
  Random shared_random = random.fork(6);
  const SharedMisjudgement misjudged({s.shared_failure_share, s.shared_failure_size}, shared_random);
  if (s.similarity) {
    Random r = random.fork(4);
    teacher.world.scale = r.uniform(0.3, 0.7);  // VGGT's unit is the mean distance of the points
    teacher.world.rotation = rotation_matrix(normalized(Quaterniond{r.normal(), r.normal(), r.normal(), r.normal()}));
    teacher.world.translation = gaussian_vector(r);
  }
  // Outliers: as many views as the share says, the fraction by chance, on distinct views.
  const double expected = s.outlier_share * static_cast<double>(views.size());
  const int outliers = static_cast<int>(expected) + (pose_random.chance(expected - std::floor(expected)) ? 1 : 0);
  std::vector<size_t> order(views.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  pose_random.shuffle(order);
  for (int i = 0; i < outliers && i < static_cast<int>(order.size()); ++i)
    teacher.views[order[static_cast<size_t>(i)]].outlier = true;

  // Uniform with the given root mean square: no scene gets a focal length that no network would claim.
  const double shared_focal = s.shared_focal * focal_random.uniform(-std::sqrt(3.0), std::sqrt(3.0));
  const double keep = s.neighbour_correlation, fresh = std::sqrt(1 - keep * keep);
  Vec3d turn = gaussian_vector(pose_random), shift = gaussian_vector(pose_random);
  for (size_t i = 0; i < views.size(); ++i) {
    TeacherView& t = teacher.views[i];
    t.camera = views[i].camera;
    const Rigidd exact = t.camera.world_to_camera.inverse();
    // The camera moves and turns with the space around it ...
    Rigidd pose{bend.rotation(exact.translation) * exact.rotation, bend(exact.translation)};
    // ... and has a residual of its own; three components of s / sqrt(3) make a root mean square of s.
    if (i > 0) {
      turn = turn * keep + gaussian_vector(pose_random) * fresh;
      shift = shift * keep + gaussian_vector(pose_random) * fresh;
    }
    Vec3d axis = turn * (s.rotation_degrees * kPi / 180 / std::sqrt(3.0)),
          offset = shift * (s.translation / std::sqrt(3.0));
    Random own = pose_random.fork(100 + i);
    if (t.outlier) {
      const double angle = own.uniform(3, 8) * kPi / 180, distance = own.uniform(0.1, 0.2);
      axis = normalized(gaussian_vector(own)) * angle;
      offset = normalized(gaussian_vector(own)) * distance;
    }
    pose = {pose.rotation * rotation_of(axis), pose.translation + offset};
    t.camera.world_to_camera = pose.inverse();
    const double focal = 1 + shared_focal + s.view_focal * focal_random.normal();
    t.camera.fx *= focal;
    t.camera.fy *= focal;
  }

  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const RenderedView& view = views[i];
      TeacherView& t = teacher.views[i];
      Random r = random.fork(1000 + i);
      const int w = view.depth.width, h = view.depth.height;
      const Rigidd exact = view.camera.world_to_camera.inverse();
      const Rigidd bent_pose =
          Rigidd{bend.rotation(exact.translation) * exact.rotation, bend(exact.translation)}.inverse();
      const BentDepth depth = bent_depth(view, bend, misjudged, bent_pose);
      const DepthJumps jumps = find_depth_jumps(view, static_cast<int>(std::ceil(1.5 * s.edge_width)));
      // Region in which a smooth map of unit variance exceeds its (1 - share) quantile. The mean excess there is about
      // 0.5, and the mean of the clamped sign map 0.72.
      const double failure_level = upper_quantile(s.failure_share), failure_gain = s.failure_size / 0.36;
      t.depth = mix_across_edges(depth.misjudged, jumps, s.edge_width);
      const ImageF warp = smooth_random_map(w, h, 4, 3, s.warp_rms, r);
      const ImageF region = smooth_random_map(w, h, 6, 5, 1, r), sign = smooth_random_map(w, h, 6, 5, 1, r);
      const double scale = 1 + s.view_scale * r.normal(), patch = kPatch * static_cast<double>(w) / kNetworkWidth;
      const uint32_t patch_seed = static_cast<uint32_t>(r.next());
      Image<uint8_t> known_bad(w, h, 1, 0);
      ImageF error(w, h, 1);
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          float& z = t.depth.at(x, y);
          const double noise = s.white * r.normal();
          if (!(z > 0)) continue;
          const float cell = lattice_random(static_cast<int>(x / patch), static_cast<int>(y / patch), 0, patch_seed);
          double factor = scale * (1 + warp.at(x, y)) * (1 + noise) * (1 + s.patch * std::sqrt(12.0) * (cell - 0.5));
          if (const double excess = region.at(x, y) - failure_level; excess > 0) {
            factor *= 1 + failure_gain * excess * std::clamp(2.0 * sign.at(x, y), -1.0, 1.0);
          }
          if (view.unreliable.at(x, y) != 0) {
            const UnreliableError e = unreliable_error(view.instances.at(x, y), i, random);
            factor *= 1 + e.relative;
            known_bad.at(x, y) = e.noticed ? 1 : 0;
          }
          z = static_cast<float>(z * factor);
          error.at(x, y) = std::fabs(std::log(z / depth.bent.at(x, y)));
        }
      }
      t.confidence = confidence_of(error, jumps, known_bad, r.fork(5));
      t.own_error = std::move(error);
      for (size_t k = 0; k < t.depth.data.size(); ++k) {
        if (!(t.depth.data[k] > 0)) t.confidence.data[k] = 0;
      }
      if (s.similarity) {
        for (float& z : t.depth.data) z *= static_cast<float>(teacher.world.scale);
        t.camera.world_to_camera = teacher.world.transform_world_to_camera(t.camera.world_to_camera);
      }
    }
  });
  return teacher;
}

GeometryTeacher exact_geometry_teacher(const std::vector<RenderedView>& views) {
  GeometryTeacher teacher;
  for (const RenderedView& view : views) {
    ImageF confidence(view.depth.width, view.depth.height, 1);
    for (size_t i = 0; i < confidence.data.size(); ++i) confidence.data[i] = view.depth.data[i] > 0 ? 10.0f : 0.0f;
    teacher.views.push_back({view.camera, view.depth, std::move(confidence), {}, false});
  }
  return teacher;
}

}  // namespace aligngs
