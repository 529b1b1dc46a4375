// COLMAP's camera models by number, name and parameters (colmap/src/colmap/sensor/models.h of COLMAP 4.2, ids 0 to 17).
#pragma once

#include <cstddef>
#include <string_view>

namespace aligngs {

struct ColmapCameraModel {
  int id;
  std::string_view name;
  size_t parameters;
  size_t focal_lengths;  ///< the first parameters; the principal point follows, then what the lens does. 0: a panorama
};

inline constexpr ColmapCameraModel kColmapCameraModels[] = {{0, "SIMPLE_PINHOLE", 3, 1},
                                                            {1, "PINHOLE", 4, 2},
                                                            {2, "SIMPLE_RADIAL", 4, 1},
                                                            {3, "RADIAL", 5, 1},
                                                            {4, "OPENCV", 8, 2},
                                                            {5, "OPENCV_FISHEYE", 8, 2},
                                                            {6, "FULL_OPENCV", 12, 2},
                                                            {7, "FOV", 5, 2},
                                                            {8, "SIMPLE_RADIAL_FISHEYE", 4, 1},
                                                            {9, "RADIAL_FISHEYE", 5, 1},
                                                            {10, "THIN_PRISM_FISHEYE", 12, 2},
                                                            {11, "RAD_TAN_THIN_PRISM_FISHEYE", 16, 2},
                                                            {12, "SIMPLE_DIVISION", 4, 1},
                                                            {13, "DIVISION", 5, 2},
                                                            {14, "SIMPLE_FISHEYE", 3, 1},
                                                            {15, "FISHEYE", 4, 2},
                                                            {16, "EUCM", 6, 2},
                                                            {17, "EQUIRECTANGULAR", 2, 0}};
inline constexpr int kLastColmapCameraModel = 17;

/// The way out for models that are unknown here: COLMAP itself undoes those that it knows.
inline constexpr const char* kUnknownCameraModelRemedy =
    "undistort the images with the COLMAP that made the model (colmap image_undistorter), which gives PINHOLE cameras";

inline const ColmapCameraModel* find_colmap_camera_model(int id) {
  return id >= 0 && id <= kLastColmapCameraModel ? &kColmapCameraModels[id] : nullptr;
}
inline const ColmapCameraModel* find_colmap_camera_model(std::string_view name) {
  for (const ColmapCameraModel& model : kColmapCameraModels) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

}  // namespace aligngs
