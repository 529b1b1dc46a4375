// Device other than the CPU that fuses the views of a volume.
#pragma once

#include <string>
#include <vector>

#include "mesh/tsdf_voxel.h"

namespace aligngs {

class TsdfDevice {
 public:
  virtual ~TsdfDevice() = default;
  virtual std::string name() const = 0;
  /// Fuses the views, in their order, into blocks[i] (kBlockVoxels voxels of the block at coordinates[i]). Blocks and
  /// the maps of the views are in host memory. The same arithmetic as on the CPU: the same field, bit for bit.
  /// Error{kResources} when the maps of one view and a block do not fit the device.
  virtual void fuse(const std::vector<VoxelView>& views, const std::vector<BlockCoordinate>& coordinates,
                    const std::vector<Voxel*>& blocks) = 0;
};

}  // namespace aligngs
