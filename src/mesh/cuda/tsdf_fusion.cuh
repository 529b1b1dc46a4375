// Kernels of tsdf_fusion.h.
#pragma once

#include "device/block_reduce.cuh"
#include "device/device_span.h"
#include "mesh/tsdf_voxel.h"

namespace aligngs::cuda {

/// Threads of the kernel that has one per block of voxels. A part of a volume has some ten thousand blocks. The number
/// is small, so that they spread over all multiprocessors.
inline constexpr unsigned kPlaceThreads = 128;

struct PlacedBlock {
  Vec3f origin;  ///< of the first voxel, in the camera frame
  int seen = 0;
};

__global__ void place_blocks(VoxelView view, DeviceSpan<const BlockCoordinate> coordinates,
                             DeviceSpan<PlacedBlock> placed) {
  const size_t b = item_index();
  if (b >= coordinates.size) return;
  PlacedBlock& out = placed[b];
  out.seen = view.sees(coordinates[b]);
  out.origin = view.origin(coordinates[b]);
}

/// One thread per voxel, one block of threads per block of voxels.
__global__ void __launch_bounds__(kBlockVoxels)
    fuse_blocks(VoxelView view, DeviceSpan<const PlacedBlock> placed, DeviceSpan<Voxel> voxels) {
  const PlacedBlock block = placed[blockIdx.x];
  if (block.seen == 0) return;
  const int t = static_cast<int>(threadIdx.x);
  const int i = t % kBlockSide, j = t / kBlockSide % kBlockSide, k = t / (kBlockSide * kBlockSide);
  const Vec3f p = view.row(block.origin, j, k) + view.along_x * static_cast<float>(i);
  Voxel& at = voxels[size_t(blockIdx.x) * kBlockVoxels + threadIdx.x];
  Voxel voxel = at;
  fuse_voxel(view, p, voxel);
  at = voxel;
}

}  // namespace aligngs::cuda
