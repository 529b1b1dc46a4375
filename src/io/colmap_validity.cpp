#include "io/colmap_validity.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/erase_marked.h"
#include "core/error.h"
#include "core/far_outliers.h"
#include "core/rigid.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxColmapSide = 1'000'000;  // pixels: beyond it the file is not what it seems
const char* const kColmapRemedy = "run the reconstruction again, or remove the entry";

bool finite(const Vec3d& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void require_valid_camera(const ColmapCamera& camera, const fs::path& name) {
  const std::string field = "camera " + std::to_string(camera.id);
  if (camera.width == 0 || camera.height == 0 || camera.width > kMaxColmapSide || camera.height > kMaxColmapSide) {
    throw_bad_input(name, field,
                    "the size " + std::to_string(camera.width) + "x" + std::to_string(camera.height) + " is not valid",
                    kColmapRemedy);
  }
  for (const double value : camera.params) {
    if (!std::isfinite(value)) throw_bad_input(name, field, "a parameter is not finite", kColmapRemedy);
  }
}

void require_valid_image(const ColmapImage& image, const fs::path& name) {
  const std::string field = "image " + std::to_string(image.id) + " (" + image.name.substr(0, 200) + ")";
  const double length = norm(image.rotation);
  if (image.name.empty()) throw_bad_input(name, field, "the name is missing", kColmapRemedy);
  if (!std::isfinite(length) || !finite(image.translation)) {
    throw_bad_input(name, field, "the pose is not finite", kColmapRemedy);
  }
  constexpr double kLeastLength = 1e-6;  // a rotation's quaternion has length 1; shorter ones tell no direction
  if (length < kLeastLength) throw_bad_input(name, field, "the quaternion is zero", kColmapRemedy);
}

void leave_out_far_cameras(ColmapModel& model) {
  std::vector<Vec3d> centres;
  for (const ColmapImage& image : model.images)
    centres.push_back(Rigidd{rotation_matrix(normalized(image.rotation)), image.translation}.inverse().translation);
  const std::vector<bool> far = far_outliers(centres);
  for (size_t i = 0; i < far.size(); ++i) {
    if (far[i]) model.left_out.push_back({model.images[i].name, kFarFromOthers, kFarFromOthersRemedy});
  }
  erase_marked(model.images, far);
}

}  // namespace

void require_valid_colmap(const ColmapModel& model, const fs::path& cameras, const fs::path& images,
                          const fs::path& points) {
  std::set<uint32_t> camera_ids, image_ids;
  for (const ColmapCamera& camera : model.cameras) {
    require_valid_camera(camera, cameras);
    if (!camera_ids.insert(camera.id).second) {
      throw_bad_input(cameras, "camera " + std::to_string(camera.id), "the id occurs twice", kColmapRemedy);
    }
  }
  for (const ColmapImage& image : model.images) {
    require_valid_image(image, images);
    if (!image_ids.insert(image.id).second) {
      throw_bad_input(images, "image " + std::to_string(image.id), "the id occurs twice", kColmapRemedy);
    }
    if (!camera_ids.count(image.camera_id)) {
      throw_bad_input(images, "image " + std::to_string(image.id) + " (" + image.name.substr(0, 200) + ")",
                      "its camera " + std::to_string(image.camera_id) + " is not in " + cameras.filename().string(),
                      kColmapRemedy);
    }
  }
  for (const ColmapPoint& point : model.points) {
    if (!finite(point.position)) {
      throw_bad_input(points, "point " + std::to_string(point.id), "the position is not finite", kColmapRemedy);
    }
  }
}

void leave_out_invalid(ColmapModel& model, const fs::path& cameras, const fs::path& images) {
  std::map<uint32_t, const ColmapCamera*> by_id;
  for (const ColmapCamera& camera : model.cameras) {
    if (!by_id.emplace(camera.id, &camera).second) {
      throw_bad_input(cameras, "camera " + std::to_string(camera.id), "the id occurs twice", kColmapRemedy);
    }
  }
  std::set<uint32_t> ids;
  std::set<std::string> names;
  std::vector<ColmapImage> good;
  for (ColmapImage& image : model.images) {
    const std::string name = image.name.empty() ? "image " + std::to_string(image.id) : image.name.substr(0, 200);
    use_or_leave_out(name, model.left_out, [&] {
      require_valid_image(image, images);
      const std::string field = "image " + std::to_string(image.id);
      const auto camera = by_id.find(image.camera_id);
      if (camera == by_id.end())
        throw_bad_input(images, field,
                        "its camera " + std::to_string(image.camera_id) + " is not in " + cameras.filename().string(),
                        kColmapRemedy);
      require_valid_camera(*camera->second, cameras);
      if (!ids.insert(image.id).second || !names.insert(image.name).second)
        throw_bad_input(images, field, "it is listed twice", kColmapRemedy);
      good.push_back(std::move(image));
    });
  }
  model.images = std::move(good);
  leave_out_far_cameras(model);
  // Beyond it, lengths overflow in single precision.
  constexpr double kFarthest = 1e18;
  model.points_left_out = std::erase_if(model.points, [](const ColmapPoint& point) {
    const Vec3d& p = point.position;
    return !(std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest);
  });
  std::vector<Vec3d> places;
  for (const ColmapPoint& point : model.points) places.push_back(point.position);
  model.points_left_out += erase_marked(model.points, far_outliers(places));
}

}  // namespace aligngs
