// One view as fusion and labelling take it: a camera and maps, whoever made them (renders, priors, sensors, truth).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image.h"
#include "scene/camera.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Every map is empty or has the size of the camera.
struct FusionFrame {
  std::string name;  ///< for messages
  Camera camera;
  ImageF depth;               ///< H x W, camera z in scene units; 0, negative or non-finite: no value
  ImageF color;               ///< H x W x 3, sRGB in [0, 1]; empty: the mesh stays grey where only such views look
  ImageF normal;              ///< H x W x 3, camera frame, unit, turned to the camera; empty: fitted to the depth
  ImageF alpha;               ///< H x W, opacity; empty: opaque
  Image<uint16_t> label;      ///< H x W, kNoLabel = none; empty: this view has no vote
  ImageF label_probability;   ///< H x W in [0, 1]; empty: 1
  bool interpolated = false;  ///< between training views: may refine surface that training views saw, nothing else
};

/// Error{kBadInput} naming view and map when a map does not fit its camera, or the camera is not usable.
void check_fusion_frames(const std::vector<FusionFrame>& frames);

/// Depth at a pixel, or 0 where it has no value.
inline float valid_depth(const ImageF& depth, int x, int y) {
  const float d = depth.at(x, y);
  return d > 0 && d < 1e30f ? d : 0.0f;  // NaN compares false, infinity is excluded
}

}  // namespace aligngs
