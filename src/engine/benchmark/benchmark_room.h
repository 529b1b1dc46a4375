// The fixed scene of the benchmarks: a made-up room with the tile statistics of a real one.
#pragma once

#include <cstddef>

#include "engine/settings.h"
#include "engine/training_view.h"
#include "gaussians/gaussian_model.h"

namespace aligngs {

/// Flat splats on walls, floor, ceiling and furniture, opacity 0.5 to 0.9. At 640 x 480 and 200 000 Gaussians about 60
/// % are in view. Some 400 meet in a tile of 16 x 16 pixels, and 55 reach a pixel. Measured on a kitchen captured with
/// a depth camera: 122 k visible, 415 per tile, 54 per pixel.
struct BenchmarkRoom {
  int width = 640, height = 480;  ///< pixels
  size_t gaussians = 200000;
  int channels = 150;  ///< classes, 0 = without semantics
  /// rows as training orders them (densify.morton_order); false: neighbours anywhere in memory
  bool morton_order = true;
};

/// Positions from which the room is seen.
inline constexpr int kBenchmarkViews = 4;

/// Throws Error{kUsage} for sizes, counts or channels that are not positive or beyond what an engine takes.
void check_benchmark_room(const BenchmarkRoom& room);

/// Spherical harmonics of degree 3; the same numbers on every machine.
GaussianModel benchmark_model(const BenchmarkRoom& room);

/// The room as seen from one position, 0 <= index < kBenchmarkViews: exact colour, depth and labels, prepared as for
/// training. Its teacher has half the resolution, and the winner has about nine tenths of the mass.
TrainingView benchmark_view(const BenchmarkRoom& room, int index);

/// A step with every loss on, rates so small that the scene stays as it is.
StepRequest benchmark_request();

}  // namespace aligngs
