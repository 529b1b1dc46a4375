// Seeded smooth noise: the raw material of procedural textures and of the simulated teachers' errors.
#pragma once

#include <cstdint>

#include "core/image.h"
#include "core/random.h"
#include "core/vec.h"

namespace aligngs {

/// A well-mixed 32-bit hash of up to three lattice coordinates and a seed (PCG output function).
uint32_t lattice_hash(int32_t x, int32_t y, int32_t z, uint32_t seed);
/// The same as a number in [0, 1).
float lattice_random(int32_t x, int32_t y, int32_t z, uint32_t seed);

/// Value noise on the unit lattice with a quintic fade: smooth, in [-1, 1], zero mean.
float value_noise(float x, float y, uint32_t seed);
/// Sum of `octaves` value noises, each at twice the frequency and half the amplitude; about [-1, 1].
float fractal_noise(float x, float y, int octaves, uint32_t seed);

/// A smooth random map: normal values on a lattice of columns x rows control points that spans the image. It is
/// interpolated with a cubic B-spline, and rescaled to a root mean square of exactly `rms`. columns, rows >= 1. This is
/// the "low-frequency warp" of the simulated teachers.
ImageF smooth_random_map(int width, int height, int columns, int rows, double rms, Random& random);

}  // namespace aligngs
