#include "nn/da3/cameras.h"

#include <algorithm>
#include <cmath>

#include "core/rigid.h"

namespace aligngs::nn {
namespace {

constexpr double kPi = 3.141592653589793;

Rigidd pose_of(const NetworkCamera& camera) {
  Rigidd pose;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.rotation(i, j) = camera.rotation[size_t(3 * i + j)];
  }
  pose.translation = {camera.translation[0], camera.translation[1], camera.translation[2]};
  return pose;
}

void set_pose(NetworkCamera& camera, const Rigidd& pose) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) camera.rotation[size_t(3 * i + j)] = pose.rotation(i, j);
  }
  camera.translation = {pose.translation.x, pose.translation.y, pose.translation.z};
}

double length_of(const Vec3d& v) { return std::sqrt(dot(v, v)); }

double focal_of(int64_t side, double angle) {
  constexpr double kLeastTangent = 1e-6;  // keeps the focal length finite
  return double(side) / 2 / std::max(std::tan(angle / 2), kLeastTangent);
}

double angle_of(int64_t side, double focal) { return 2 * std::atan(double(side) / 2 / focal); }

}  // namespace

PoseEncoding encode_da3_camera(const NetworkCamera& camera, int64_t width, int64_t height) {
  NetworkCamera inverse;
  set_pose(inverse, pose_of(camera).inverse());
  const std::array<double, 4> q = xyzw_from_rotation(inverse.rotation);
  PoseEncoding e{};
  for (size_t i = 0; i < 3; ++i) e[i] = float(inverse.translation[i]);
  for (size_t i = 0; i < 4; ++i) e[3 + i] = float(q[i]);
  e[7] = float(angle_of(height, camera.fy));
  e[8] = float(angle_of(width, camera.fx));
  return e;
}

NetworkCamera decode_da3_camera(const PoseEncoding& e, int64_t width, int64_t height) {
  NetworkCamera camera;
  camera.rotation = rotation_from_xyzw({double(e[3]), double(e[4]), double(e[5]), double(e[6])});
  camera.translation = {double(e[0]), double(e[1]), double(e[2])};
  set_pose(camera, pose_of(camera).inverse());
  camera.fy = focal_of(height, double(e[7]));
  camera.fx = focal_of(width, double(e[8]));
  camera.cx = double(width) / 2;
  camera.cy = double(height) / 2;
  return camera;
}

bool da3_camera_is_plausible(const NetworkCamera& camera, int64_t width, int64_t height) {
  for (const double v : camera.rotation) {
    if (!std::isfinite(v)) return false;
  }
  for (const double v : camera.translation) {
    if (!std::isfinite(v)) return false;
  }
  constexpr double kLeast = kPi / 180, kMost = 179 * kPi / 180;
  const auto seen = [&](int64_t side, double focal) {
    const double angle = angle_of(side, focal);
    return focal > 0 && angle >= kLeast && angle <= kMost;
  };
  return seen(width, camera.fx) && seen(height, camera.fy);
}

std::vector<NetworkCamera> normalised_cameras(std::vector<NetworkCamera> cameras) {
  constexpr double kLeastDistance = 0.1;
  const Rigidd to_world = pose_of(cameras.front()).inverse();
  std::vector<double> distances;
  for (NetworkCamera& camera : cameras) {
    set_pose(camera, pose_of(camera) * to_world);
    distances.push_back(length_of(pose_of(camera).inverse().translation));
  }
  std::sort(distances.begin(), distances.end());
  const double unit = std::max(distances[(distances.size() - 1) / 2], kLeastDistance);
  for (NetworkCamera& camera : cameras) {
    for (double& v : camera.translation) v /= unit;
  }
  return cameras;
}

CameraAlignment align_given_cameras(const std::vector<NetworkCamera>& given,
                                    const std::vector<NetworkCamera>& predicted) {
  std::vector<Rigidd> from, to;
  std::vector<Vec3d> from_centres, to_centres;
  for (size_t i = 0; i < given.size(); ++i) {
    from.push_back(pose_of(given[i]));
    to.push_back(pose_of(predicted[i]));
    from_centres.push_back(from.back().inverse().translation);
    to_centres.push_back(to.back().inverse().translation);
  }
  SimilarityFit fit = fit_similarity(from_centres, to_centres);
  CameraAlignment out;
  out.well_posed = fit.well_posed;
  if (!fit.well_posed) fit = fit_similarity_of_cameras(from, to);
  out.scale = fit.similarity.scale;
  out.residual = fit.rmse;
  out.cameras = given;
  for (size_t i = 0; i < given.size(); ++i) set_pose(out.cameras[i], fit.similarity.transform_world_to_camera(from[i]));
  return out;
}

}  // namespace aligngs::nn
