// SfM points as a start: an arbitrary world becomes the capture's by the similarity of the cameras they share.
#include "core/error.h"
#include "scene/import/capture_frames.h"
#include "scene/import/import_capture.h"

namespace aligngs {

AlignedSfm align_sfm(const Capture& capture, const std::filesystem::path& model_folder) {
  constexpr double kMaxReprojectionError = 2;  // pixels; what 3DGS' readers keep
  constexpr size_t kMinTrack = 2;              // a point needs two rays
  const ColmapModel model = read_colmap_model(find_colmap_folder(model_folder));
  const FrameNames frames(capture.frames);
  std::vector<Rigidd> from, to;
  for (const ColmapImage& image : model.images) {
    const int found = frames.find(image.name);
    if (found < 0) continue;
    from.push_back({rotation_matrix(normalized(image.rotation)), image.translation});
    to.push_back(capture.frames[static_cast<size_t>(found)].world_to_camera);
  }
  const SimilarityFit fit = fit_similarity_of_cameras(from, to);
  if (!fit.well_posed) {
    throw_bad_input(
        model_folder, "images",
        "only " + std::to_string(from.size()) + " of its cameras are in this capture, or they share one place",
        "the model's image names must be those of the capture, at least two of them apart");
  }
  AlignedSfm result;
  result.rmse = fit.rmse;
  result.cameras = from.size();
  for (const ColmapPoint& point : model.points) {
    if (point.error > kMaxReprojectionError || (!point.track.empty() && point.track.size() < kMinTrack)) continue;
    result.cloud.positions.push_back((fit.similarity * point.position).cast<float>());
    result.cloud.colors.push_back({point.color[0] / 255.f, point.color[1] / 255.f, point.color[2] / 255.f});
  }
  if (result.cloud.size() == 0)
    throw_bad_input(model_folder, "points3D", "no usable points", "give a model with triangulated points");
  return result;
}

}  // namespace aligngs
