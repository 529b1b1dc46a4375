// Sizes of blocks and pieces of work on the device, to be tuned by measurement. Sizes that follow from a formula or
// from another one are defined where they are used. Shared memory is named per block; a multiprocessor has 100 KB
// (GeForce) to 228 KB (sm_90) for all its blocks.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aligngs::cuda {

// ---- rows: one Gaussian or one (Gaussian, tile) pair per thread or warp

/// Threads of a block with one Gaussian or instance per thread: enough warps to hide memory latency, few enough
/// registers for several blocks per multiprocessor.
inline constexpr unsigned kRowThreads = 256;

/// The same where a row needs about 100 registers, as in the way back through projection and colour.
inline constexpr unsigned kGradientThreads = 128;

/// Slots that a thread adds up itself; its warp adds up any further ones. One Gaussian close to the camera has a slot
/// in every tile and would keep 31 rows waiting.
inline constexpr uint32_t kOwnSlots = 16;

/// Rows per block of the semantic kernels, one warp each: 256 threads.
inline constexpr int kRowWarps = 8;

/// Slots of a semantic row that its warp adds up alone; beyond, the whole block does. A slot is read in one go by a
/// warp, so the bound is higher than kOwnSlots.
inline constexpr uint32_t kWarpSlots = 64;

/// Rectangles of more tiles than this are written by a whole warp instead of one thread.
inline constexpr unsigned kWideRectangle = 32;

// ---- tiles of 16 x 16 pixels

/// Gaussians that a tile's block takes from its list at a time: one per thread, 20 KB of shared memory.
inline constexpr int kBlendBatch = 256;

/// Gaussians between two barriers of the backward pass: each of a tile's eight warps adds up one. The weights and
/// gradients of their pixels take 24 KB of shared memory.
inline constexpr int kBackwardChunk = 8;

/// Most blocks per tile of the backward pass per Gaussian. Each loads the pixels of the tile again (20 KB); checkpoints
/// take 4 to 8 KB per 32 Gaussians.
inline constexpr size_t kMostBackwardBlocks = 8;

/// Classes that labels take per sweep over a tile's list: their sums stay in registers.
inline constexpr int kChannelSweep = 16;

/// Gaussians whose weights the semantic start keeps at a time (x 256 pixels: 32 KB of shared memory), and channels per
/// sweep. Their product is one sum per thread of the tile.
inline constexpr int kLiftBatch = 32;
inline constexpr int kLiftChannels = 8;

// ---- the semantic visit (semantic_tile.cuh has its layout)

/// Threads of the block that visits a tile: four per pixel of a block of 8 x 8, eight warps for the products.
inline constexpr int kVisitThreads = 256;

/// Gaussians at a time: two steps of 16 of a product over Gaussians. Rows take kVisitEntries x channels x 2 bytes of
/// shared memory; blocks of 150 classes leave no more on GeForce.
inline constexpr int kVisitEntries = 32;

/// Places of a tile's list looked at at a time (4 bytes each): more than almost every tile has.
inline constexpr int kVisitBatch = 1024;

/// Rows of dS that pass through shared memory at a time, in float32: one step of a product. They reuse the memory of
/// the rows of kVisitEntries in bfloat16, so they may not be larger.
inline constexpr int kSumRows = 16;

// ---- maps

/// Edge of the square of pixels of a block of the SSIM kernels. With its windows (26 x 26) both pictures and five
/// moments of their rows take 14 KB of shared memory.
inline constexpr int kSsimTile = 16;

/// Threads of a block with one pixel per thread.
inline constexpr unsigned kPixelThreads = 256;

/// Threads of the block that adds up what the blocks of a grid left: a picture of 640 x 480 leaves 1200 sums, five
/// rounds.
inline constexpr unsigned kSumThreads = 256;

// ---- networks

/// Threads of a block with one value of a tensor per thread, or one row per warp.
inline constexpr unsigned kElementThreads = 256;

/// Outputs from which on a product takes large blocks (128 x 128), which load each operand less often. 64 of them
/// occupy half of the multiprocessors of a large device. Below, blocks of 32 x 64 keep more of a device busy.
inline constexpr int64_t kLargeProduct = int64_t(128) * 128 * 64;

/// The product in float32: a block forms kFloatTile x kFloatTile outputs, a thread a square of kFloatPerThread.
/// kFloatStep inputs at a time take 9 KB of shared memory.
inline constexpr int kFloatTile = 64, kFloatStep = 16, kFloatPerThread = 4;

/// Warps of a block of attention, with 16 queries each, and keys per step. Each warp has four tiles of scores in
/// registers. Keys and values of 128 channels take 35 KB of shared memory.
inline constexpr int kAttentionWarps = 4, kAttentionKeys = 64;

// ---- (Gaussian, tile) pairs

/// (Gaussian, tile) pairs per Gaussian in forecasts of memory; rooms at 320x240 to 640x480 have 4 to 5.
inline constexpr size_t kPairsPerGaussian = 8;

/// Room for (Gaussian, tile) pairs beyond those of the last visit to a view: a share of them, and a few. A view that
/// outgrows it costs one repeated step.
inline constexpr double kPairGrowth = 1.25;
inline constexpr size_t kPairSlack = 4096;

}  // namespace aligngs::cuda
