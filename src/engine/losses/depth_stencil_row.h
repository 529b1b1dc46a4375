// Rows of the depth stencils of normal_terms.h, laid out so that several pixels are computed at a time. They name the
// neighbours that the depth normal of a pixel uses, their depths, and the way of gradients back to them.
#pragma once

#include <cstdint>

namespace aligngs {

template <class T>
struct StencilMap {
  const T* depth = nullptr;           ///< [height][width]
  const uint8_t* validity = nullptr;  ///< DepthValidity [height][width]
  int width = 0, height = 0;
};

/// stencil [width] gets depth_stencil of every pixel of row y, packed. It is 0 if not valid, or if inverse_length
/// [width] of the pixel's blended normal is 0.
void depth_stencil_row(const StencilMap<float>& map, int y, const float* inverse_length, bool as_printed,
                       uint8_t* stencil);
void depth_stencil_row(const StencilMap<double>& map, int y, const double* inverse_length, bool as_printed,
                       uint8_t* stencil);

/// Fills the inputs [kNormalRowInputs][width] of compute_normal_row for row y.
void gather_stencil_row(const StencilMap<float>& map, int y, const uint8_t* stencil, float* in);
void gather_stencil_row(const StencilMap<double>& map, int y, const uint8_t* stencil, double* in);

/// Adds outputs kOutRight to kOutBottom [width] each, the first at `out`, to the gradients [height][width] of the
/// depths that the stencils of row y name. Those of the rows above and below are included.
void scatter_stencil_row(const float* out, int y, const uint8_t* stencil, int width, int height, float* gradient);
void scatter_stencil_row(const double* out, int y, const uint8_t* stencil, int width, int height, double* gradient);

}  // namespace aligngs
