// Buffers that the map losses reuse from step to step.
#pragma once

#include <cstdint>
#include <vector>

namespace aligngs {

/// Owned by whoever calls map_losses; used by one call at a time. Sizes itself to the maps, carries nothing
/// from one call to the next but neighbour_depth.
template <class T>
struct MapLossWorkspace {
  std::vector<T> truth;           ///< 3 planes: the photo
  std::vector<T> masked_render;   ///< 3 planes: the render with truth under the mask; only with a mask
  std::vector<T> ssim_gradients;  ///< 9 planes: derivatives of SSIM by its local moments, per channel
  std::vector<T> depth;           ///< plane depth z, 0 = none
  std::vector<T> depth_gradient;  ///< dL / dz
  std::vector<T> direction;       ///< 3 planes: N / |N|, zero where a pixel has no direction
  std::vector<T> inverse_length;  ///< 1 / |N|, 0 = none
  std::vector<uint8_t> validity;  ///< DepthValidity per pixel
  std::vector<uint8_t> stencil;   ///< which neighbours the depth normal of a pixel uses
  std::vector<double> row_sums;

  // Arrays of the multi-view terms.
  std::vector<T> neighbour_depth;             ///< of the neighbour's camera; kept until the next keep_neighbour_depth
  std::vector<T> agreement, agreement_slope;  ///< w = exp(-phi), 0 = none; w dphi/dz
  std::vector<T> grey, neighbour_grey;
  std::vector<T> patch_gradient;  ///< [H * W][4] by normal and distance; only where patch_used is 1
  std::vector<uint8_t> patch_used;
};

}  // namespace aligngs
