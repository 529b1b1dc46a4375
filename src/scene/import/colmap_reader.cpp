// A COLMAP reconstruction beside its own images: images/ and sparse/[N/] (bin or txt), or the model in the folder itself.
#include <algorithm>
#include <map>

#include "core/error.h"
#include "scene/import/capture.h"
#include "scene/import/capture_text.h"

namespace aligngs {

namespace fs = std::filesystem;

std::vector<CapturedFrame> frames_of_model(const ColmapModel& model) {
  std::map<uint32_t, const ColmapCamera*> cameras;
  for (const ColmapCamera& camera : model.cameras) cameras[camera.id] = &camera;
  std::vector<CapturedFrame> frames;
  for (const ColmapImage& image : model.images) {
    CapturedFrame frame;
    frame.name = fs::path(image.name).stem().string();
    frame.camera = *cameras.at(image.camera_id);
    frame.world_to_camera = {rotation_matrix(normalized(image.rotation)), image.translation};
    frames.push_back(std::move(frame));
  }
  return frames;
}

Capture read_colmap_capture(const fs::path& folder) {
  Capture capture;
  capture.layout = layout_name(CaptureLayout::kColmap);
  capture.folder = folder;
  const ColmapModel model = read_colmap_model(find_colmap_folder(folder));
  capture.frames = frames_of_model(model);
  for (size_t i = 0; i < model.images.size(); ++i) {
    const ColmapImage& image = model.images[i];
    CapturedFrame& frame = capture.frames[i];
    frame.image = first_existing({folder / "images" / image.name, folder / image.name});
    if (frame.image.empty()) throw_bad_input(folder / "images" / image.name, "", "the model's image is missing", "put the images that COLMAP used into images/");
  }
  std::sort(capture.frames.begin(), capture.frames.end(),
            [](const CapturedFrame& a, const CapturedFrame& b) { return natural_less(a.name, b.name); });
  for (const ColmapPoint& point : model.points) {
    capture.cloud.positions.push_back(point.position.cast<float>());
    capture.cloud.colors.push_back({point.color[0] / 255.f, point.color[1] / 255.f, point.color[2] / 255.f});
  }
  return capture;
}

}  // namespace aligngs
