#include "refine/plane_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angles.h"
#include "scene/depth_normals.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr uint64_t kPlaneSeed = 1;  // the same planes every time
constexpr int kNormalRadius = 4;  // pixels: only a rough direction is needed, and noise is worse than a rounded corner

struct NamedPlaneClass {
  const char* name;
  PlaneClass what;
};
constexpr NamedPlaneClass kNamedPlaneClasses[] = {
    {"wall", {PlaneKind::kWall, false}},         {"floor", {PlaneKind::kFloor, false}},
    {"rug", {PlaneKind::kFloor, false, true}},   {"ceiling", {PlaneKind::kCeiling, false}},
    {"door", {PlaneKind::kWall, false, true}},   {"painting", {PlaneKind::kWall, false, true}},
    {"poster", {PlaneKind::kWall, false, true}}, {"bulletin board", {PlaneKind::kWall, false, true}},
    {"windowpane", {PlaneKind::kWall, true}},    {"mirror", {PlaneKind::kWall, true}},
    {"table", {PlaneKind::kTable, false}},       {"coffee table", {PlaneKind::kTable, false}},
    {"desk", {PlaneKind::kTable, false}},        {"counter", {PlaneKind::kTable, false}},
    {"countertop", {PlaneKind::kTable, false}},
};

/// The class at each pixel, kNoLabel near the edge to something of another place and where no plane is.
Image<uint16_t> class_map(const PlaneView& view, const std::vector<PlaneClass>& classes, int edge) {
  const int width = view.camera.width, height = view.camera.height;
  const auto place = [&](int x, int y) {
    const uint16_t label = view.labels.at(x, y);
    const PlaneClass what = label < classes.size() ? classes[label] : PlaneClass{};
    return static_cast<uint8_t>(2 * static_cast<int>(what.kind) + (what.glass ? 1 : 0));
  };
  Image<uint8_t> kinds(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) kinds.at(x, y) = place(x, y);
  }
  const Image<uint8_t> inside = interior(kinds, edge);
  Image<uint16_t> out(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) out.at(x, y) = inside.at(x, y) ? view.labels.at(x, y) : kNoLabel;
  }
  return out;
}

struct PreparedView {
  Image<uint16_t> classes;
  ImageF normals;  // camera frame
};

PreparedView prepare(const PlaneView& view, const std::vector<PlaneClass>& classes, const PlaneDepthSettings& s) {
  PreparedView out;
  if (view.labels.data.empty() || view.depth.empty()) return out;
  out.classes = class_map(view, classes, s.label_edge);
  DepthNormalOptions options;
  options.radius = kNormalRadius;
  out.normals = camera_normals(view.depth, view.camera, options);
  return out;
}

Vec3d normal_at(const ImageF& normals, int x, int y) {
  return {normals.at(x, y, 0), normals.at(x, y, 1), normals.at(x, y, 2)};
}

void collect_points(const PlaneView& view, const PreparedView& prepared, const std::vector<PlaneClass>& classes,
                    int index, int stride, std::vector<PlanePoint>& points) {
  const Rigidd to_world = view.camera.world_to_camera.inverse();
  for (int y = stride / 2; y < prepared.classes.height; y += stride) {
    for (int x = stride / 2; x < prepared.classes.width; x += stride) {
      const uint16_t label = prepared.classes.at(x, y);
      const float z = view.depth.at(x, y);
      const Vec3d normal = normal_at(prepared.normals, x, y);
      if (label == kNoLabel || classes[label].glass || !(z > 0) || !std::isfinite(z) || dot(normal, normal) == 0)
        continue;
      PlanePoint p;
      p.position = to_world * (view.camera.ray(x + 0.5, y + 0.5) * static_cast<double>(z));
      p.normal = to_world.rotation * normal;
      p.depth = z;
      p.certainty = view.certainty.empty() ? 0 : view.certainty.at(x, y);
      p.view = index;
      p.kind = classes[label].kind;
      p.proud = classes[label].proud;
      points.push_back(p);
    }
  }
}

/// Tukey's biweight.
double biweight(double share) { return std::abs(share) < 1 ? (1 - share * share) * (1 - share * share) : 0; }

struct PixelMeasurement {
  double log_factor = 0, weight = 0;
  uint8_t plane = 0;
};

/// Glass is in the wall that the ray meets first, whatever its depth looks like.
PixelMeasurement measure_glass(const std::vector<CameraPlane>& planes, PlaneKind kind, const Vec3d& ray, double z,
                               const PlaneDepthSettings& s) {
  const CameraPlane* nearest = first_on_ray(planes, kind, ray);
  if (!nearest) return {};
  const double factor = std::log(nearest->depth(ray) / z);
  if (std::abs(factor) > s.glass_reach) return {};
  return {factor, s.strength, nearest->number};
}

/// Everything else is on the plane that is nearest to its depth, if that is near and turned alike.
PixelMeasurement measure_surface(const std::vector<CameraPlane>& planes, const PlaneClass& what, const Vec3d& ray,
                                 const Vec3d& normal, double z, const PlaneDepthSettings& s) {
  const double least_cosine = std::cos(s.normal_angle * kRadiansPerDegree);
  PixelMeasurement best;
  for (const CameraPlane& plane : planes) {
    if (plane.kind != what.kind || dot(plane.normal, normal) < least_cosine) continue;
    const double depth = plane.depth(ray, what.proud);
    if (!(depth > 0)) continue;
    const double factor = std::log(depth / z), weight = s.strength * biweight(factor / s.reach);
    if (weight > best.weight) best = {factor, weight, plane.number};
  }
  return best;
}

PlaneMeasurement measure(const PlaneView& view, const PreparedView& prepared, const std::vector<PlaneClass>& classes,
                         const std::vector<ScenePlane>& planes, const PlaneDepthSettings& s) {
  const int width = view.camera.width, height = view.camera.height;
  PlaneMeasurement out{ImageF(width, height, 1), ImageF(width, height, 1), Image<uint8_t>(width, height, 1)};
  if (prepared.classes.data.empty()) return out;
  const std::vector<CameraPlane> local = in_frame_of(view.camera, planes);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const uint16_t label = prepared.classes.at(x, y);
      const float z = view.depth.at(x, y);
      if (label == kNoLabel || !(z > 0) || !std::isfinite(z)) continue;
      const Vec3d ray = view.camera.ray(x + 0.5, y + 0.5);
      const PixelMeasurement m =
          classes[label].glass ? measure_glass(local, classes[label].kind, ray, z, s)
                               : measure_surface(local, classes[label], ray, normal_at(prepared.normals, x, y), z, s);
      out.log_factor.at(x, y) = static_cast<float>(m.log_factor);
      out.weight.at(x, y) =
          static_cast<float>(m.weight) * (view.label_share.empty() ? 1.0f : view.label_share.at(x, y));
      out.plane.at(x, y) = m.plane;
    }
  }
  return out;
}

template <class Work>
void for_each_view(const std::vector<PlaneView>& views, ThreadPool& pool, Work&& work) {
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) work(i);
  });
}

std::vector<PreparedView> prepare_all(const std::vector<PlaneView>& views, const std::vector<PlaneClass>& classes,
                                      const PlaneDepthSettings& settings, ThreadPool& pool) {
  std::vector<PreparedView> prepared(views.size());
  for_each_view(views, pool, [&](size_t i) { prepared[i] = prepare(views[i], classes, settings); });
  return prepared;
}

/// Planes, and the axes of a square room that they were turned to.
struct FoundPlanes {
  std::vector<ScenePlane> planes;
  std::optional<RoomAxes> axes;
};

FoundPlanes planes_in(const std::vector<PlaneView>& views, const std::vector<PreparedView>& prepared,
                      const std::vector<PlaneClass>& classes, const PlaneDepthSettings& settings) {
  std::vector<PlanePoint> points;
  for (size_t i = 0; i < views.size(); ++i)
    collect_points(views[i], prepared[i], classes, static_cast<int>(i), settings.stride, points);
  FoundPlanes found{find_planes(points, settings.planes, kPlaneSeed), std::nullopt};
  if (settings.square) found.axes = estimate_room_axes(found.planes);
  if (found.axes) found.planes = squared_planes(std::move(found.planes), *found.axes);
  return found;
}

}  // namespace

Image<uint8_t> interior(const Image<uint8_t>& kinds, int edge) {
  Image<uint8_t> out(kinds.width, kinds.height, 1);
  for (int y = 0; y < kinds.height; ++y) {
    for (int x = 0; x < kinds.width; ++x) {
      const uint8_t own = kinds.at(x, y);
      bool inside = own != 0;
      for (int dy = -edge; inside && dy <= edge; ++dy) {
        for (int dx = -edge; inside && dx <= edge; ++dx) {
          inside = kinds.at(std::clamp(x + dx, 0, kinds.width - 1), std::clamp(y + dy, 0, kinds.height - 1)) == own;
        }
      }
      out.at(x, y) = inside ? own : uint8_t{0};
    }
  }
  return out;
}

std::vector<CameraPlane> in_frame_of(const Camera& camera, const std::vector<ScenePlane>& planes) {
  std::vector<CameraPlane> out;
  const Vec3d centre = camera.centre();
  constexpr size_t kMost = std::numeric_limits<uint8_t>::max();
  for (size_t i = 0; i < planes.size() && i < kMost; ++i) {
    const double distance = planes[i].distance(centre);
    if (!(distance > 0)) continue;  // seen from behind
    out.push_back({camera.world_to_camera.rotation * planes[i].normal, distance, planes[i].kind,
                   static_cast<uint8_t>(i + 1), planes[i].proud});
  }
  return out;
}

const CameraPlane* first_on_ray(const std::vector<CameraPlane>& planes, PlaneKind kind, const Vec3d& ray) {
  const CameraPlane* first = nullptr;
  double nearest = 0;
  for (const CameraPlane& plane : planes) {
    const double depth = plane.kind == kind ? plane.depth(ray) : 0;
    if (!(depth > 0) || (first && depth >= nearest)) continue;
    first = &plane;
    nearest = depth;
  }
  return first;
}

std::vector<PlaneClass> plane_classes(const LabelSet& labels, PlaneSurfaces surfaces) {
  std::vector<PlaneClass> out(labels.classes.size());
  for (const NamedPlaneClass& named : kNamedPlaneClasses) {
    const int index = labels.find(named.name);
    if (named.what.kind == PlaneKind::kTable && surfaces == PlaneSurfaces::kLayout) continue;
    if (index >= 0) out[static_cast<size_t>(index)] = named.what;
  }
  return out;
}

std::vector<ScenePlane> find_planes(const std::vector<PlaneView>& views, const std::vector<PlaneClass>& classes,
                                    const PlaneDepthSettings& settings, ThreadPool& pool) {
  return planes_in(views, prepare_all(views, classes, settings, pool), classes, settings).planes;
}

std::vector<PlaneMeasurement> measure_on_planes(const std::vector<ScenePlane>& planes,
                                                const std::vector<PlaneView>& views,
                                                const std::vector<PlaneClass>& classes,
                                                const PlaneDepthSettings& settings, ThreadPool& pool) {
  std::vector<PlaneMeasurement> out(views.size());
  for_each_view(views, pool, [&](size_t i) {
    out[i] = measure(views[i], prepare(views[i], classes, settings), classes, planes, settings);
  });
  return out;
}

PlaneDepthResult measure_planes(const std::vector<PlaneView>& views, const std::vector<PlaneClass>& classes,
                                const PlaneDepthSettings& settings, ThreadPool& pool) {
  PlaneDepthResult result;
  result.views.resize(views.size());
  const std::vector<PreparedView> prepared = prepare_all(views, classes, settings, pool);
  FoundPlanes found = planes_in(views, prepared, classes, settings);
  result.planes = std::move(found.planes);
  result.axes = std::move(found.axes);
  for_each_view(views, pool,
                [&](size_t i) { result.views[i] = measure(views[i], prepared[i], classes, result.planes, settings); });
  size_t with_depth = 0, on_plane = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    for (size_t p = 0; p < result.views[i].weight.data.size() && p < views[i].depth.data.size(); ++p) {
      with_depth += views[i].depth.data[p] > 0;
      on_plane += result.views[i].weight.data[p] > 0;
    }
  }
  result.share = with_depth == 0 ? 0 : static_cast<double>(on_plane) / static_cast<double>(with_depth);
  return result;
}

}  // namespace aligngs
