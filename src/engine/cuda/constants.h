// Sizes of blocks and pieces of work on the device.
#pragma once

#include <cstddef>

namespace aligngs::cuda {

/// Threads of a block that works on one Gaussian or one instance per thread: enough warps to hide memory, few enough
/// registers' worth that several blocks share a multiprocessor.
inline constexpr unsigned kRowThreads = 256;

/// Gaussians that a tile's block takes from its list at a time: one per thread, 20 KB of shared memory.
inline constexpr int kBlendBatch = 256;

/// Rectangles of more tiles than this are written by a whole warp instead of one thread.
inline constexpr unsigned kWideRectangle = 32;

/// Classes that labels and the semantic start take per sweep over a tile's list: their sums stay in registers.
inline constexpr int kChannelSweep = 16;

/// Gaussians whose weights the semantic start keeps at a time: x 256 pixels, 32 KB of shared memory.
inline constexpr int kLiftBatch = 32;

/// (Gaussian, tile) pairs per Gaussian in forecasts of memory; rooms at 320x240 to 640x480 have 4 to 5.
inline constexpr size_t kPairsPerGaussian = 8;

/// Room for (Gaussian, tile) pairs beyond those of the last visit to a view: a share of them, and a few. A view that
/// outgrows it costs one repeated step.
inline constexpr double kPairGrowth = 1.25;
inline constexpr size_t kPairSlack = 4096;

}  // namespace aligngs::cuda
