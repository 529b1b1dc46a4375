// COLMAP sparse models, binary and text. Raw content; src/scene turns it into cameras and views.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/quaternion.h"

namespace aligngs {

struct ColmapCamera {
  uint32_t id = 0;
  std::string model;           ///< "PINHOLE", "SIMPLE_RADIAL", ... (ids 0 to 10)
  uint64_t width = 0, height = 0;
  std::vector<double> params;  ///< in COLMAP's order for the model
};

struct ColmapImage {
  uint32_t id = 0;
  Quaterniond rotation;  ///< world to camera, w x y z
  Vec3d translation;     ///< world to camera
  uint32_t camera_id = 0;
  std::string name;
  std::vector<Vec2d> points;          ///< observed keypoints, pixels
  std::vector<int64_t> point_ids;     ///< 3-D point of each keypoint or -1
};

struct ColmapPoint {
  uint64_t id = 0;
  Vec3d position;
  std::array<uint8_t, 3> color{};
  double error = 0;  ///< reprojection error, pixels
  std::vector<std::pair<uint32_t, uint32_t>> track;  ///< (image id, keypoint index)
};

struct ColmapModel {
  std::vector<ColmapCamera> cameras;
  std::vector<ColmapImage> images;
  std::vector<ColmapPoint> points;
};

/// Reads cameras, images, points3D from a folder; .bin is preferred over .txt, each file by itself.
/// points3D may be absent. Non-finite poses, unknown models, missing cameras and truncated files are
/// Error{kBadInput} with file and field.
ColmapModel read_colmap_model(const std::filesystem::path& folder);
ColmapModel decode_colmap_binary(const std::string& cameras, const std::string& images, const std::string& points,
                                 const std::filesystem::path& folder_for_errors);
/// Finds sparse/0, sparse or the folder itself; of several numbered models the one with most images.
std::filesystem::path find_colmap_folder(const std::filesystem::path& scene_folder);
/// Whether find_colmap_folder() is worth trying: sparse/ or a file of cameras is there.
bool may_hold_colmap_model(const std::filesystem::path& scene_folder);
void write_colmap_binary(const std::filesystem::path& folder, const ColmapModel& model);

}  // namespace aligngs
