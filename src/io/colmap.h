// COLMAP sparse models, binary and text. Raw content; src/scene turns it into cameras and views.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/quaternion.h"
#include "io/left_out.h"

namespace aligngs {

struct ColmapCamera {
  uint32_t id = 0;
  std::string model;  ///< "PINHOLE", "SIMPLE_RADIAL", ... (ids 0 to 17)
  uint64_t width = 0, height = 0;
  std::vector<double> params;  ///< in COLMAP's order for the model
};

struct ColmapImage {
  uint32_t id = 0;
  Quaterniond rotation;  ///< world to camera, w x y z
  Vec3d translation;     ///< world to camera
  uint32_t camera_id = 0;
  std::string name;
  std::vector<Vec2d> points;       ///< observed keypoints, pixels
  std::vector<int64_t> point_ids;  ///< 3-D point of each keypoint or -1
};

struct ColmapPoint {
  uint64_t id = 0;
  Vec3d position;
  std::array<uint8_t, 3> color{};
  double error = 0;                                  ///< reprojection error, pixels
  std::vector<std::pair<uint32_t, uint32_t>> track;  ///< (image id, keypoint index)
};

struct ColmapModel {
  std::vector<ColmapCamera> cameras;
  std::vector<ColmapImage> images;
  std::vector<ColmapPoint> points;
  std::vector<LeftOut> left_out;  ///< images of the files that cannot be used: no finite pose, no camera, listed twice
  size_t points_left_out = 0;     ///< without a finite position, beyond 1e18, or far_outliers()
};

/// Reads cameras, images, points3D from a folder. A whole model of .bin is preferred over one of .txt, and a points3D.ply
/// counts where there is neither. Points may be absent. Entries that cannot be used go to `left_out`; unknown camera
/// models, missing and truncated files are Error{kBadInput} with file and field.
ColmapModel read_colmap_model(const std::filesystem::path& folder);
ColmapModel decode_colmap_binary(const std::string& cameras, const std::string& images, const std::string& points,
                                 const std::filesystem::path& folder_for_errors);
/// Finds sparse/, the folder itself or colmap/sparse/ (nerfstudio's place), each with or without numbered models (0, 1,
/// ...) below it. Takes the one with most images. Else the only model in a folder of another name beside images/.
std::filesystem::path find_colmap_folder(const std::filesystem::path& scene_folder);
/// A sentence that says which of several numbered models was taken and why; empty when there is one.
std::string choice_of_model(const std::filesystem::path& scene_folder);
/// Whether find_colmap_folder() is worth trying: sparse/, colmap/sparse/ or a file of cameras is there.
bool may_hold_colmap_model(const std::filesystem::path& scene_folder);
void write_colmap_binary(const std::filesystem::path& folder, const ColmapModel& model);

}  // namespace aligngs
