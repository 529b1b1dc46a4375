#include "metrics/visibility.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/kept_rows.h"
#include "metrics/triangle_distance.h"

namespace aligngs {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr size_t kRowGrain = 8;  // image rows per chunk of work

RTCRay make_ray(const Vec3d& origin, const Vec3d& direction, float end) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x);
  ray.org_y = static_cast<float>(origin.y);
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(direction.x);
  ray.dir_y = static_cast<float>(direction.y);
  ray.dir_z = static_cast<float>(direction.z);
  ray.tnear = 0;
  ray.tfar = end;
  ray.mask = ~0u;
  return ray;
}

}  // namespace

struct RayScene::Handle {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  const float* vertices = nullptr;  // Embree's own buffers: three numbers a row
  const uint32_t* indices = nullptr;

  Handle() {
    // One thread builds: the tree, and so the winner among coincident triangles, is always the same.
    device = rtcNewDevice("threads=1");
    if (!device) throw_resources({}, "Embree could not be started", "check the installation of libembree3");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);  // no ray slips between two triangles
  }
  ~Handle() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
};

RayScene::RayScene(const TriangleMesh& mesh) : handle_(std::make_unique<Handle>()) {
  if (!mesh.triangles.empty()) {
    RTCGeometry geometry = rtcNewGeometry(handle_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices.size()));
    auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(uint32_t), mesh.triangles.size()));
    if (!vertices || !indices) {
      rtcReleaseGeometry(geometry);
      throw_resources({}, "not enough memory to cast rays at this mesh", "use a larger voxel for a smaller mesh");
    }
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      for (int a = 0; a < 3; ++a) vertices[3 * i + a] = mesh.vertices[i][a];
    }
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (int a = 0; a < 3; ++a) indices[3 * i + a] = mesh.triangles[i][a];
    }
    handle_->vertices = vertices;
    handle_->indices = indices;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(handle_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(handle_->scene);
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

FirstHits RayScene::cast(const Camera& camera, ThreadPool& pool, const std::vector<uint8_t>* there) const {
  FirstHits hits{Image<uint32_t>(camera.width, camera.height, 1, kNoTriangle), ImageF(camera.width, camera.height, 1)};
  const Vec3d eye = camera.centre();
  pool.parallel_for(camera.height, kRowGrain, [&](size_t begin, size_t end, int) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (size_t y = begin; y < end; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        // The direction has camera z = 1, so the ray parameter is the depth.
        const Vec3d direction =
            transpose_times(camera.world_to_camera.rotation, camera.ray(x + 0.5, static_cast<double>(y) + 0.5));
        RTCRayHit hit{};
        hit.ray = make_ray(eye, direction, kInfinity);
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(handle_->scene, &context, &hit);
        while (there && hit.hit.geomID != RTC_INVALID_GEOMETRY_ID && !(*there)[hit.hit.primID]) {  // go on behind it
          hit.ray.tnear = std::nextafter(hit.ray.tfar, kInfinity);
          hit.ray.tfar = kInfinity;
          hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
          rtcIntersect1(handle_->scene, &context, &hit);
        }
        if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
        hits.triangle.at(x, static_cast<int>(y)) = hit.hit.primID;
        hits.depth.at(x, static_cast<int>(y)) = hit.ray.tfar;
      }
    }
  });
  return hits;
}

bool RayScene::sees(const Vec3d& eye, const Vec3d& point, double tolerance) const {
  const Vec3d direction = point - eye;
  const double length = norm(direction);
  if (!(length > tolerance)) return std::isfinite(length);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = make_ray(eye, direction * (1 / length), static_cast<float>(length - tolerance));
  rtcOccluded1(handle_->scene, &context, &ray);
  return ray.tfar >= 0;  // Embree sets -infinity when something was met
}

std::optional<SurfacePoint> RayScene::nearest(const Vec3d& point, double reach) const {
  struct Search {
    const Handle* handle;
    Vec3d from;
    SurfacePoint best;
  } search{handle_.get(), point, {}};
  search.best.distance = reach;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  RTCPointQuery query;
  query.x = static_cast<float>(point.x);
  query.y = static_cast<float>(point.y);
  query.z = static_cast<float>(point.z);
  query.time = 0;
  query.radius = static_cast<float>(reach);
  if (!(reach > 0) || !std::isfinite(query.x + query.y + query.z)) return std::nullopt;
  const auto look = [](RTCPointQueryFunctionArguments* arguments) {
    auto& s = *static_cast<Search*>(arguments->userPtr);
    Vec3d corner[3];
    for (int i = 0; i < 3; ++i) {
      const float* v = s.handle->vertices + 3 * size_t(s.handle->indices[3 * size_t(arguments->primID) + size_t(i)]);
      corner[i] = {v[0], v[1], v[2]};
    }
    const Vec3d found = nearest_on_triangle(s.from, corner[0], corner[1], corner[2]);
    const double distance = norm(found - s.from);
    // The first of equally near triangles in the list, so that the answer does not depend on the tree.
    if (distance > s.best.distance || (distance == s.best.distance && arguments->primID >= s.best.triangle))
      return false;
    s.best = {found, arguments->primID, distance};
    arguments->query->radius = std::nextafter(static_cast<float>(distance), kInfinity);
    return true;
  };
  rtcPointQuery(handle_->scene, &query, &context, look, &search);
  if (search.best.triangle == kNoTriangle) return std::nullopt;
  return search.best;
}

std::optional<Vec2d> project_into_image(const Camera& camera, const Vec3d& point) {
  const Vec3d p = camera.world_to_camera * point;
  if (!(p.z > 0)) return std::nullopt;
  const Vec2d uv = camera.project(p);
  if (!camera.contains(uv)) return std::nullopt;
  return uv;
}

std::vector<uint8_t> seen_points(const RayScene& scene, const std::vector<Camera>& cameras,
                                 const std::vector<Vec3f>& points, double tolerance, ThreadPool& pool) {
  constexpr size_t kPointGrain = 256;  // some milliseconds of rays
  std::vector<uint8_t> seen(points.size(), 0);
  pool.parallel_for(points.size(), kPointGrain, [&](size_t begin, size_t end, int) {
    size_t likely = 0;  // the camera that saw the point before
    for (size_t i = begin; i < end; ++i) {
      const Vec3d p = points[i].cast<double>();
      seen[i] = any_camera_sees(cameras.size(), likely, [&](size_t c) {
        return project_into_image(cameras[c], p) && scene.sees(cameras[c].centre(), p, tolerance);
      });
    }
  });
  return seen;
}

TriangleMesh keep_triangles(const TriangleMesh& mesh, const std::vector<uint8_t>& keep) {
  constexpr uint32_t kUnused = 0xffffffffu;
  std::vector<uint32_t> number(mesh.vertices.size(), kUnused);
  size_t triangles = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!keep[t]) continue;
    ++triangles;
    for (const uint32_t v : mesh.triangles[t]) number[v] = 0;
  }
  std::vector<uint8_t> used(mesh.vertices.size());
  uint32_t vertices = 0;
  for (size_t v = 0; v < used.size(); ++v) {
    used[v] = number[v] != kUnused;
    if (used[v]) number[v] = vertices++;
  }
  TriangleMesh kept;
  kept.vertices = kept_rows(mesh.vertices, used, 1);
  if (!mesh.normals.empty()) kept.normals = kept_rows(mesh.normals, used, 1);
  if (!mesh.colors.empty()) kept.colors = kept_rows(mesh.colors, used, 1);
  if (!mesh.labels.empty()) kept.labels = kept_rows(mesh.labels, used, 1);
  kept.triangles.reserve(triangles);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!keep[t]) continue;
    const auto& corner = mesh.triangles[t];
    kept.triangles.push_back({number[corner[0]], number[corner[1]], number[corner[2]]});
  }
  return kept;
}

}  // namespace aligngs
