#include "synth/raytracer.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"

namespace aligngs {

struct RoomRays::Handles {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Handles() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RoomRays::RoomRays(const RoomModel& room) : room_(room), handles_(std::make_unique<Handles>()) {
  // One build thread: the tree, and with it the choice among touching triangles, is the same everywhere.
  handles_->device = rtcNewDevice("threads=1,set_affinity=0");
  const auto fail = [] { throw_resources({}, "Embree could not build the room", "free some memory"); };
  if (handles_->device == nullptr) fail();
  handles_->scene = rtcNewScene(handles_->device);
  rtcSetSceneFlags(handles_->scene, RTC_SCENE_FLAG_ROBUST);  // no light through the cracks between triangles
  rtcSetSceneBuildQuality(handles_->scene, RTC_BUILD_QUALITY_MEDIUM);
  RTCGeometry geometry = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                                           room.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t),
                                          room.triangles.size());
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    fail();
  }
  std::memcpy(vertices, room.positions.data(), room.positions.size() * sizeof(Vec3f));
  std::memcpy(indices, room.triangles.data(), room.triangles.size() * 3 * sizeof(uint32_t));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(handles_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(handles_->scene);
  if (rtcGetDeviceError(handles_->device) != RTC_ERROR_NONE) fail();
}

RoomRays::~RoomRays() = default;

RayHit RoomRays::intersect(const Vec3d& origin, const Vec3d& direction, double near) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(origin.x);
  query.ray.org_y = static_cast<float>(origin.y);
  query.ray.org_z = static_cast<float>(origin.z);
  query.ray.dir_x = static_cast<float>(direction.x);
  query.ray.dir_y = static_cast<float>(direction.y);
  query.ray.dir_z = static_cast<float>(direction.z);
  query.ray.tnear = static_cast<float>(near);
  query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(handles_->scene, &context, &query);
  RayHit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.hit = true;
  hit.triangle = query.hit.primID;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  hit.distance = query.ray.tfar;
  const auto& t = room_.triangles[hit.triangle];
  const Vec3d a = room_.positions[t[0]].cast<double>(), b = room_.positions[t[1]].cast<double>(),
              c = room_.positions[t[2]].cast<double>();
  const Vec3d n = cross(b - a, c - a);
  const double slope = dot(n, direction);
  // Seen edge-on the plane gives no distance; Embree's own is kept.
  if (std::fabs(slope) > 1e-4 * norm(n) * norm(direction)) hit.distance = dot(n, a - origin) / slope;
  return hit;
}

bool RoomRays::occluded(const Vec3f& origin, const Vec3f& direction, float near, float far) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray{};
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tnear = near;
  ray.tfar = far;
  ray.mask = 0xffffffffu;
  rtcOccluded1(handles_->scene, &context, &ray);
  return ray.tfar < 0;
}

bool RoomRays::visible(const Vec3d& from, const Vec3d& to, double slack) const {
  const Vec3d d = to - from;
  const double length = norm(d);
  if (length <= slack) return true;
  return !occluded(from.cast<float>(), (d * (1 / length)).cast<float>(), 1e-4f, static_cast<float>(length - slack));
}

}  // namespace aligngs
