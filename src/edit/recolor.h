// Colour changes that follow the spherical harmonics, so that they are right from every side.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "gaussians/gaussian_model.h"
#include "scene/triangle_mesh.h"

namespace aligngs {

/// Each selected colour c(d) becomes colour * Y(c(d)) / mean Y, with Y the luma (Rec. 709 weights): linear in the
/// coefficients, so every viewing direction keeps its shade and texture keeps its contrast. The mean is taken over the
/// selection, weighted by opacity, and is at least kDarkestMean: black things become dark, not white.
void recolor_gaussians(GaussianModel& model, const std::vector<uint8_t>& selected, const std::array<uint8_t, 3>& color);
/// The mean that it takes; empty when nothing of the selection is to be seen.
std::optional<float> mean_luma(const GaussianModel& model, const std::vector<uint8_t>& selected);
/// The same with a mean that is known.
void recolor_gaussians(GaussianModel& model, const std::vector<uint8_t>& selected, const std::array<uint8_t, 3>& color,
                       float mean);
/// The same for vertex colours.
void recolor_vertices(TriangleMesh& mesh, const std::vector<uint8_t>& selected, const std::array<uint8_t, 3>& color);

/// c becomes (1 - kHighlightShare) c + kHighlightShare * colour.
void highlight_gaussians(GaussianModel& model, const std::vector<uint8_t>& selected,
                         const std::array<uint8_t, 3>& color);
void highlight_vertices(TriangleMesh& mesh, const std::vector<uint8_t>& selected, const std::array<uint8_t, 3>& color);

inline constexpr float kHighlightShare = 0.6f;  ///< strong enough to find, weak enough to see what it is
inline constexpr double kDarkestMean = 0.05;    ///< luma, sRGB scale

}  // namespace aligngs
