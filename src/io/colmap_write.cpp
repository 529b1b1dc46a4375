#include "core/error.h"
#include "io/atomic_file.h"
#include "io/byte_reader.h"
#include "io/colmap.h"
#include "io/colmap_camera_models.h"
#include "io/colmap_validity.h"

namespace aligngs {

void write_colmap_binary(const std::filesystem::path& folder, const ColmapModel& model) {
  require_valid_colmap(model, folder / "cameras.bin", folder / "images.bin", folder / "points3D.bin");
  std::string out;
  append_little(out, uint64_t(model.cameras.size()));
  for (const ColmapCamera& camera : model.cameras) {
    const ColmapCameraModel* known = find_colmap_camera_model(camera.model);
    if (!known || known->parameters != camera.params.size()) {
      throw Error({ErrorKind::kFailed,
                   "the camera model " + camera.model + " does not have " + std::to_string(camera.params.size()) +
                       " parameters",
                   folder / "cameras.bin", "camera " + std::to_string(camera.id), ""});
    }
    append_little(out, camera.id);
    append_little(out, int32_t(known->id));
    append_little(out, camera.width);
    append_little(out, camera.height);
    for (const double value : camera.params) append_little(out, value);
  }
  write_file_atomically(folder / "cameras.bin", out);

  out.clear();
  append_little(out, uint64_t(model.images.size()));
  for (const ColmapImage& image : model.images) {
    append_little(out, image.id);
    const Quaterniond& q = image.rotation;
    const Vec3d& t = image.translation;
    for (const double value : {q.w, q.x, q.y, q.z, t.x, t.y, t.z}) append_little(out, value);
    append_little(out, image.camera_id);
    out.append(image.name.c_str(), image.name.size() + 1);
    append_little(out, uint64_t(image.points.size()));
    for (size_t i = 0; i < image.points.size(); ++i) {
      append_little(out, image.points[i].x);
      append_little(out, image.points[i].y);
      append_little(out, i < image.point_ids.size() ? image.point_ids[i] : int64_t(-1));
    }
  }
  write_file_atomically(folder / "images.bin", out);

  out.clear();
  append_little(out, uint64_t(model.points.size()));
  for (const ColmapPoint& point : model.points) {
    append_little(out, point.id);
    for (const double value : {point.position.x, point.position.y, point.position.z}) append_little(out, value);
    for (const uint8_t channel : point.color) append_little(out, channel);
    append_little(out, point.error);
    append_little(out, uint64_t(point.track.size()));
    for (const auto& [image, keypoint] : point.track) {
      append_little(out, image);
      append_little(out, keypoint);
    }
  }
  write_file_atomically(folder / "points3D.bin", out);
}

}  // namespace aligngs
