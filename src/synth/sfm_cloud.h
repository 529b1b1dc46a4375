// A sparse cloud as structure from motion leaves it: corners of the photos, triangulated with the given cameras.
#pragma once

#include <vector>

#include "core/random.h"
#include "scene/camera.h"
#include "scene/corners.h"
#include "scene/point_cloud.h"
#include "synth/shading.h"

namespace aligngs {

/// One training photo: what a feature detector sees, and the camera that the triangulation believes.
struct SfmView {
  const RenderedView* truth = nullptr;    ///< decides which corners of different photos are the same point
  const Image<uint8_t>* photo = nullptr;  ///< H x W x 3
  Camera camera;                          ///< with its errors
};

struct SfmSettings {
  CornerSettings corners{900, 4, 0.01};  ///< of a photo of 320 x 240; as many per pixel in others
  double same_depth = 0.02;              ///< a corner is seen by a photo whose depth there agrees within this share
  double found = 0.6;                    ///< chance that a photo that sees the point also matches it
  double pixel_noise = 0.5;              ///< pixels, standard deviation of an observation
  double largest_residual = 4;           ///< pixels; points that fit the cameras worse are dropped, as mappers do
  double smallest_parallax = 1.5;        ///< degrees between two rays of the track
};

/// Points with tracks of two or more photos; bare walls have none. Positions carry the cameras' errors, as they would.
PointCloud simulate_sfm_cloud(const std::vector<SfmView>& views, const SfmSettings& settings, Random random);

}  // namespace aligngs
