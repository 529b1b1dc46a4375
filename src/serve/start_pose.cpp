#include "serve/start_pose.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace aligngs {
namespace {

using Json = nlohmann::json;

constexpr double kLeastSpread = 0.05;  // determinant: with less all photos look in one direction
constexpr double kLeastSight = 1e-3;   // of the farthest photo's distance from the origin, between eye and target
constexpr double kLeastUp = 1e-6;      // length of the mean up: with less the ups cancel each other

struct Photo {
  Vec3d place, forward, up;
};

std::optional<Vec3d> three_numbers(const Json& value) {
  if (!value.is_array() || value.size() != 3) return {};
  Vec3d out;
  for (int k = 0; k < 3; ++k) {
    if (!value[static_cast<size_t>(k)].is_number()) return {};
    out[k] = value[static_cast<size_t>(k)].get<double>();
    if (!std::isfinite(out[k])) return {};
  }
  return out;
}

/// "position", and "rotation": rows of the camera-to-world matrix.
std::optional<Photo> photo_of(const Json& camera) {
  if (!camera.is_object() || !camera.contains("position") || !camera.contains("rotation")) return {};
  const auto place = three_numbers(camera["position"]);
  const Json& rows = camera["rotation"];
  if (!place || !rows.is_array() || rows.size() != 3) return {};
  Photo photo{*place, {}, {}};
  for (int r = 0; r < 3; ++r) {
    const auto row = three_numbers(rows[static_cast<size_t>(r)]);
    if (!row) return {};
    photo.forward[r] = row->z;
    photo.up[r] = -row->y;
  }
  return photo;
}

/// The point nearest to the axes of all photos: the mean of (I - d d^T) (p - place) is 0.
std::optional<Vec3d> looked_at(const std::vector<Photo>& photos) {
  Mat3d a;
  Vec3d b;
  for (const Photo& photo : photos) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        const double across = (r == c ? 1.0 : 0.0) - photo.forward[r] * photo.forward[c];
        a(r, c) += across / static_cast<double>(photos.size());
        b[r] += across * photo.place[c] / static_cast<double>(photos.size());
      }
    }
  }
  const double all = determinant(a);
  if (photos.size() < 2 || !(std::abs(all) >= kLeastSpread)) return {};
  Vec3d point;
  for (int k = 0; k < 3; ++k) {  // Cramer's rule
    Mat3d with = a;
    for (int r = 0; r < 3; ++r) with(r, k) = b[r];
    point[k] = determinant(with) / all;
  }
  return point;
}

Json coordinates(const Vec3d& v) { return {v.x, v.y, v.z}; }

}  // namespace

std::optional<StartPose> start_pose(const Json& cameras, const Json& up) {
  if (!cameras.is_array()) return {};
  std::vector<Photo> photos;
  for (const Json& camera : cameras) {
    const auto photo = photo_of(camera);
    if (!photo) return {};
    photos.push_back(*photo);
  }
  const auto target = looked_at(photos);
  if (!target) return {};
  StartPose pose{*target, *target, {}};
  double farthest = 0, reach = 0;
  for (const Photo& photo : photos) {
    const double distance = norm(photo.place - *target);
    reach = std::max(reach, norm(photo.place));
    if (distance > farthest) farthest = distance, pose.eye = photo.place;
    pose.up = pose.up + photo.up;
  }
  if (const auto stated = three_numbers(up)) pose.up = *stated;
  if (farthest <= kLeastSight * reach || norm(pose.up) < kLeastUp) return {};
  pose.up = normalized(pose.up);
  return pose;
}

Json start_pose_json(const std::optional<StartPose>& pose) {
  if (!pose) return nullptr;
  return {{"eye", coordinates(pose->eye)}, {"target", coordinates(pose->target)}};
}

}  // namespace aligngs
