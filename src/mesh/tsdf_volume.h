// A truncated signed distance field (Curless and Levoy 1996) in blocks of 8^3 voxels near the surface.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/image.h"
#include "core/thread_pool.h"
#include "mesh/tsdf_device.h"
#include "mesh/tsdf_voxel.h"
#include "scene/camera.h"

namespace aligngs {

struct TsdfOptions {
  double voxel = 0.01;       ///< scene units
  double truncation = 0.04;  ///< scene units, at most 64 voxels
  /// Truncations along the ray that a surface reaches behind itself. Distances from tangent planes of surface seen at an
  /// angle would reach ten times as far, into what lies behind its edge.
  double behind = 2;
  uint64_t max_bytes = 0;  ///< 0: 80 % of the memory that is free now
  bool carve = true;       ///< views also push voxels of other views towards free space in front of their surface
};

/// One depth map to be fused.
struct TsdfView {
  const Camera* camera = nullptr;
  const ImageF* depth = nullptr;   ///< H x W, scene units, <= 0 or non-finite: no value
  const ImageF* color = nullptr;   ///< H x W x 3 or nullptr
  const ImageF* weight = nullptr;  ///< H x W, >= 0; 0: the pixel is not used at all; never null
  /// H x W, > 0: -n . r of the surface's unit normal and the ray with z = 1; nullptr: 1
  const ImageF* slope = nullptr;
  bool observed_only = false;  ///< touch only voxels that have been observed before (interpolated views)
};

/// Use: reserve() every view, look at predicted_bytes(), allocate(), integrate() every view, extract the surface.
/// Blocks are numbered in an order that depends on the input alone. Views are fused in the order of the calls, and one
/// thread writes each voxel. The field is the same for any number of threads.
class TsdfVolume {
 public:
  explicit TsdfVolume(const TsdfOptions& options);

  /// Notes the blocks within the truncation of the view's surface. Error{kResources} as soon as the blocks noted so
  /// far would not fit the budget; nothing has been allocated then.
  void reserve(const TsdfView& view, ThreadPool& pool);
  /// Bytes of all blocks noted so far, with what the extraction of the surface will need.
  uint64_t predicted_bytes() const;
  uint64_t max_bytes() const { return options_.max_bytes; }
  void allocate();
  /// Fuses a view into the allocated blocks.
  void integrate(const TsdfView& view, ThreadPool& pool);
  /// The same for many views in their order, on a device.
  void integrate(const std::vector<TsdfView>& views, TsdfDevice& device);

  const TsdfOptions& options() const { return options_; }
  size_t blocks() const { return coordinates_.size(); }
  BlockCoordinate coordinate(size_t block) const { return coordinates_[block]; }
  /// Voxel (x, y, z) of a block is at [(z * kBlockSide + y) * kBlockSide + x].
  const Voxel* voxels(size_t block) const { return blocks_[block]->data(); }
  /// Number of a block, or -1 when it does not exist.
  int64_t find(const BlockCoordinate& block) const;
  /// World position of the lattice point with global voxel coordinates (the centre of that voxel).
  Vec3d position(int x, int y, int z) const {
    return {(x + 0.5) * options_.voxel, (y + 0.5) * options_.voxel, (z + 0.5) * options_.voxel};
  }

 private:
  using Block = std::array<Voxel, kBlockVoxels>;
  /// Nothing is seen of the view when its `farthest` is 0.
  VoxelView voxel_view(const TsdfView& view) const;
  void require_budget(size_t blocks) const;

  TsdfOptions options_;
  std::unordered_map<uint64_t, uint32_t> numbers_;
  std::vector<BlockCoordinate> coordinates_;
  std::vector<std::unique_ptr<Block>> blocks_;
};

}  // namespace aligngs
