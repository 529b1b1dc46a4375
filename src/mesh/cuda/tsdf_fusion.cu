// Kernels of tsdf_fusion.h.
#include "mesh/cuda/tsdf_fusion.h"

#include <algorithm>

#include "core/error.h"
#include "device/block_reduce.cuh"
#include "device/device_span.h"
#include "device/launch.h"
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

namespace aligngs {
namespace cuda {
namespace {

constexpr size_t kStagedBlocks = 4096;  // 32 MB: host memory through which voxels travel

class CudaTsdfDevice : public TsdfDevice {
 public:
  CudaTsdfDevice(int device, uint64_t budget_bytes)
      : context_(device, budget_bytes, "use larger voxels (--voxel) or smaller images, or --device cpu") {}

  std::string name() const override { return context_.facts().name; }

  void fuse(const std::vector<VoxelView>& views, const std::vector<BlockCoordinate>& coordinates,
            const std::vector<Voxel*>& blocks) override {
    if (views.empty() || blocks.empty()) return;
    size_t pixels = 0;
    for (const VoxelView& v : views) pixels = std::max(pixels, size_t(v.width) * size_t(v.height));
    DeviceArray<float> maps(context_, kFloatsPerPixel * pixels, "maps of a view to fuse");
    const uint64_t per_block = kBlockVoxels * sizeof(Voxel) + sizeof(BlockCoordinate) + sizeof(PlacedBlock);
    const uint64_t left = context_.budget() - std::min(context_.budget(), context_.used());
    // Blocks that do not fit at once are fused part after part. One block too many for the device is its error.
    const size_t part = std::clamp<uint64_t>(left / per_block, 1, blocks.size());
    for (size_t first = 0; first < blocks.size(); first += part) {
      fuse_part(views, coordinates, blocks, first, std::min(part, blocks.size() - first), maps.span());
    }
  }

 private:
  static constexpr size_t kFloatsPerPixel = 6;  ///< depth, weight, colour, slope

  void fuse_part(const std::vector<VoxelView>& views, const std::vector<BlockCoordinate>& coordinates,
                 const std::vector<Voxel*>& blocks, size_t first, size_t count, DeviceSpan<float> maps) {
    DeviceArray<BlockCoordinate> places(context_, count, "coordinates of voxel blocks");
    DeviceArray<PlacedBlock> placed(context_, count, "places of voxel blocks");
    DeviceArray<Voxel> voxels(context_, count * kBlockVoxels, "voxels to fuse");
    upload(context_, places.span(), coordinates.data() + first);
    std::vector<Voxel> staged(std::min(count, kStagedBlocks) * kBlockVoxels);
    const auto in_stages = [&](const auto& body) {
      for (size_t b = 0; b < count; b += kStagedBlocks) body(b, std::min(kStagedBlocks, count - b));
    };
    in_stages([&](size_t b, size_t n) {
      for (size_t i = 0; i < n; ++i) {
        std::copy_n(blocks[first + b + i], kBlockVoxels, staged.begin() + std::ptrdiff_t(i * kBlockVoxels));
      }
      upload(context_, voxels.span().part(b * kBlockVoxels, n * kBlockVoxels), staged.data());
      context_.synchronise();  // before the staging memory is written again
    });
    for (const VoxelView& view : views) {
      const VoxelView there = on_device(view, maps);
      launch(context_, "place_blocks", place_blocks, one_per_item(count, kPlaceThreads), there, places.span(),
             placed.span());
      launch(context_, "fuse_blocks", fuse_blocks, {dim3(static_cast<unsigned>(count)), dim3(kBlockVoxels)}, there,
             placed.span(), voxels.span());
    }
    in_stages([&](size_t b, size_t n) {
      download(context_, staged.data(), voxels.span().part(b * kBlockVoxels, n * kBlockVoxels));
      for (size_t i = 0; i < n; ++i)
        std::copy_n(staged.begin() + std::ptrdiff_t(i * kBlockVoxels), kBlockVoxels, blocks[first + b + i]);
    });
  }

  /// The view with its maps on the device. The copies of the next view wait for the kernels of this one.
  VoxelView on_device(const VoxelView& view, DeviceSpan<float> maps) {
    const size_t pixels = size_t(view.width) * size_t(view.height);
    VoxelView there = view;
    upload(context_, maps.part(0, pixels), view.depth);
    upload(context_, maps.part(pixels, pixels), view.weight);
    there.depth = maps.data;
    there.weight = maps.data + pixels;
    if (view.color != nullptr) {
      upload(context_, maps.part(2 * pixels, 3 * pixels), view.color);
      there.color = maps.data + 2 * pixels;
    }
    if (view.slope != nullptr) {
      upload(context_, maps.part(5 * pixels, pixels), view.slope);
      there.slope = maps.data + 5 * pixels;
    }
    return there;
  }

  DeviceContext context_;
};

}  // namespace
}  // namespace cuda

std::unique_ptr<TsdfDevice> make_cuda_tsdf_device(int device, uint64_t budget_bytes) {
  return std::make_unique<cuda::CudaTsdfDevice>(device, budget_bytes);
}

}  // namespace aligngs
