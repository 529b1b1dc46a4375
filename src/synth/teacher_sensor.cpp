#include "synth/teacher_sensor.h"

#include <algorithm>
#include <cmath>

#include "core/angles.h"
#include "core/rotation_vector.h"
#include "core/srgb.h"
#include "synth/depth_jumps.h"

namespace aligngs {
namespace {

constexpr double kEdgeCells = 1.5;       // pixels of the sensor over which depths mix at an edge
constexpr double kFarShare = 0.85;       // of the range: beyond, the confidence is low
constexpr double kReferenceWidth = 320;  // pixels: image width that multipath_reach is given for
constexpr int kDirections = 8;           // in which a pixel looks for a surface that lights it

Vec3d gaussian_vector_of(Random& random) { return {random.normal(), random.normal(), random.normal()}; }

/// The tracker's cameras: errors that drift along the walk.
void track_cameras(const std::vector<RenderedView>& views, const DepthSensorSettings& s, Random random,
                   GeometryTeacher& out) {
  const double fresh = std::sqrt(1 - s.drift * s.drift), root3 = std::sqrt(3.0);
  const double focal = 1 + s.focal * random.uniform(-root3, root3);
  Vec3d turn = gaussian_vector_of(random), shift = gaussian_vector_of(random);
  for (size_t i = 0; i < views.size(); ++i) {
    if (i > 0) {
      turn = turn * s.drift + gaussian_vector_of(random) * fresh;
      shift = shift * s.drift + gaussian_vector_of(random) * fresh;
    }
    Camera& camera = out.views[i].camera;
    camera = views[i].camera;
    const Rigidd exact = camera.world_to_camera.inverse();
    const Vec3d axis = turn * (s.rotation_degrees * kRadiansPerDegree / root3),
                offset = shift * (s.translation / root3);
    camera.world_to_camera = Rigidd{exact.rotation * rotation_of(axis), exact.translation + offset}.inverse();
    camera.fx *= focal;
    camera.fy *= focal;
  }
}

Vec3d normal_at(const RenderedView& view, int x, int y) {
  return view.camera.world_to_camera.rotation *
         Vec3d{view.normal.at(x, y, 0), view.normal.at(x, y, 1), view.normal.at(x, y, 2)};
}

/// How much of the light at a pixel comes over a surface that faces it: 0 to 1. Concave edges bring such light.
double light_from_facing_surfaces(const RenderedView& view, int x, int y, int reach) {
  const auto point = [&](int u, int v) { return view.camera.ray(u + 0.5, v + 0.5) * double(view.depth.at(u, v)); };
  const Vec3d here = point(x, y), normal = normal_at(view, x, y);
  double sum = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * kPi * k / kDirections;
    const int u = x + static_cast<int>(std::lround(reach * std::cos(angle))),
              v = y + static_cast<int>(std::lround(reach * std::sin(angle)));
    if (u < 0 || v < 0 || u >= view.depth.width || v >= view.depth.height || !(view.depth.at(u, v) > 0)) continue;
    const Vec3d between = point(u, v) - here;
    const double distance = norm(between);
    if (distance < 1e-6) continue;
    const double leaves = dot(normal, between) / distance, arrives = -dot(normal_at(view, u, v), between) / distance;
    if (leaves > 0 && arrives > 0) sum += leaves * arrives;
  }
  return std::min(1.0, sum / kDirections * 2);
}

/// Linear luminance of the clean picture; 1 where there is none.
double brightness(const RenderedView& view, int x, int y) {
  if (view.color.empty()) return 1;
  return 0.2126 * srgb_decode(view.color.at(x, y, 0)) + 0.7152 * srgb_decode(view.color.at(x, y, 1)) +
         0.0722 * srgb_decode(view.color.at(x, y, 2));
}

/// Random numbers of the sensor's pixels, looked up in the pixels of the photo.
class SensorDraws {
 public:
  SensorDraws(int width, int height, int columns, Random& random)
      : width_(width), height_(height), columns_(std::min(width, columns)) {
    rows_ = std::max(1, static_cast<int>(std::lround(static_cast<double>(columns_) * height / width)));
    for (ImageF* map : {&noise_, &dark_, &unreliable_}) *map = ImageF(columns_, rows_, 1);
    for (size_t i = 0; i < noise_.data.size(); ++i) {
      // Drawn for every pixel, so that a hole changes nothing elsewhere.
      noise_.data[i] = static_cast<float>(random.normal());
      dark_.data[i] = static_cast<float>(random.uniform());
      unreliable_.data[i] = static_cast<float>(random.uniform());
    }
  }
  /// Standard normal at the middles of the sensor's pixels, interpolated between them.
  double noise(int x, int y) const {
    const double u = std::clamp((x + 0.5) * columns_ / width_ - 0.5, 0.0, columns_ - 1.0),
                 v = std::clamp((y + 0.5) * rows_ / height_ - 0.5, 0.0, rows_ - 1.0);
    const int x0 = static_cast<int>(u), y0 = static_cast<int>(v), x1 = std::min(x0 + 1, columns_ - 1),
              y1 = std::min(y0 + 1, rows_ - 1);
    const double fx = u - x0, fy = v - y0;
    return (noise_.at(x0, y0) * (1 - fx) + noise_.at(x1, y0) * fx) * (1 - fy) +
           (noise_.at(x0, y1) * (1 - fx) + noise_.at(x1, y1) * fx) * fy;
  }
  /// Uniform in [0, 1), of the pixel of the sensor.
  double dark(int x, int y) const { return nearest(dark_, x, y); }
  double unreliable(int x, int y) const { return nearest(unreliable_, x, y); }

 private:
  double nearest(const ImageF& map, int x, int y) const {
    return map.at(static_cast<int>((x + 0.5) * columns_ / width_), static_cast<int>((y + 0.5) * rows_ / height_));
  }
  int width_, height_, columns_, rows_ = 1;
  ImageF noise_, dark_, unreliable_;
};

/// Depth of the surfaces from which light returns: mirrors show the room in them.
ImageF returning_depth(const RenderedView& view, const ImageF& mixed) {
  ImageF depth = mixed;
  for (size_t i = 0; i < view.sensed.data.size(); ++i) {
    if (view.sensed.data[i] != view.depth.data[i]) depth.data[i] = view.sensed.data[i];
  }
  return depth;
}

void measure_view(const RenderedView& view, const DepthSensorSettings& s, Random random, TeacherView& out) {
  const int w = view.depth.width, h = view.depth.height;
  const double cell = static_cast<double>(w) / s.columns, edge_width = std::max(1.0, kEdgeCells * cell);
  const DepthJumps jumps = find_depth_jumps(view, static_cast<int>(std::ceil(1.5 * edge_width)));
  out.depth = returning_depth(view, mix_across_edges(view.depth, jumps, edge_width));
  out.confidence = ImageF(w, h, 1);
  out.own_error = ImageF(w, h, 1);
  const int reach = std::max(1, static_cast<int>(std::lround(s.multipath_reach * w / kReferenceWidth)));
  const SensorDraws draws(w, h, s.columns, random);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      float& z = out.depth.at(x, y);
      if (!(z > 0)) continue;
      const Vec3d ray = view.camera.ray(x + 0.5, y + 0.5);
      const double along = norm(ray), distance = z * along;
      const double cosine = std::fabs(dot(normal_at(view, x, y), ray)) / along;
      const bool in_mirror = !view.sensed.empty() && view.sensed.at(x, y) != view.depth.at(x, y);
      const bool flat = cosine < s.least_cosine || (!view.mirrored.empty() && view.mirrored.at(x, y) > s.mirrored_loss);
      const bool lost = distance > s.range || (flat && !in_mirror) ||
                        (view.unreliable.at(x, y) != 0 && !in_mirror && draws.unreliable(x, y) < s.unreliable_loss) ||
                        (brightness(view, x, y) < s.dark && draws.dark(x, y) < s.dark_loss);
      if (lost) {
        z = 0;
        continue;
      }
      const double error = (s.noise + s.noise_growth * distance * distance) * draws.noise(x, y) +
                           s.wiggle * std::sin(2 * kPi * distance / s.wiggle_period) +
                           s.multipath * light_from_facing_surfaces(view, x, y, reach);
      z = static_cast<float>(std::max(1e-3, (distance + error) / along));
      out.own_error.at(x, y) = std::fabs(std::log(z / view.depth.at(x, y)));
      const bool near_edge = jumps.distance.at(x, y) > 0;
      out.confidence.at(x, y) = near_edge || distance > kFarShare * s.range ? 1.0f : 2.0f;
    }
  }
}

}  // namespace

GeometryTeacher simulate_depth_sensor(const std::vector<RenderedView>& views, const DepthSensorSettings& settings,
                                      Random random, ThreadPool& pool) {
  GeometryTeacher out;
  out.views.resize(views.size());
  track_cameras(views, settings, random.fork(2), out);
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) measure_view(views[i], settings, random.fork(1000 + i), out.views[i]);
  });
  return out;
}

}  // namespace aligngs
