// COLMAP's camera models by number, name and parameter count (colmap/src/colmap/sensor/models.h,
// ids 0 to 10).
#pragma once

#include <cstddef>
#include <string_view>

namespace aligngs {

struct ColmapCameraModel {
  int id;
  std::string_view name;
  size_t parameters;
};

inline constexpr ColmapCameraModel kColmapCameraModels[] = {{0, "SIMPLE_PINHOLE", 3},
                                                            {1, "PINHOLE", 4},
                                                            {2, "SIMPLE_RADIAL", 4},
                                                            {3, "RADIAL", 5},
                                                            {4, "OPENCV", 8},
                                                            {5, "OPENCV_FISHEYE", 8},
                                                            {6, "FULL_OPENCV", 12},
                                                            {7, "FOV", 5},
                                                            {8, "SIMPLE_RADIAL_FISHEYE", 4},
                                                            {9, "RADIAL_FISHEYE", 5},
                                                            {10, "THIN_PRISM_FISHEYE", 12}};

inline const ColmapCameraModel* find_colmap_camera_model(int id) {
  return id >= 0 && id <= 10 ? &kColmapCameraModels[id] : nullptr;
}
inline const ColmapCameraModel* find_colmap_camera_model(std::string_view name) {
  for (const ColmapCameraModel& model : kColmapCameraModels) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

}  // namespace aligngs
