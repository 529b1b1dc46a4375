#include "mesh/tsdf_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/progress.h"
#include "mesh/fusion_frame.h"

namespace aligngs {
namespace {

constexpr double kMaxTruncationVoxels = 64;  // bounds the blocks that one pixel can ask for
// Blocks from the origin: three coordinates share one 64-bit key; the margin holds the band around the surface.
constexpr int kMaxCoordinate = (1 << 20) - 64;
constexpr size_t kRowGrain = 8;       // image rows per chunk
constexpr size_t kBlockGrain = 32;    // blocks per chunk
constexpr size_t kRecentKeys = 4096;  // slots of the filter for blocks that were noted a moment ago
// Hash node, coordinate and pointer of a block. Vertices and triangles of the blocks that the surface crosses (about
// 100 and 200 in two of five blocks), with the doubling of growing arrays.
constexpr uint64_t kBookkeepingBytes = 80;
constexpr uint64_t kExtractionBytes = 4096;

uint64_t key_of(const BlockCoordinate& b) {
  const auto part = [](int v) { return static_cast<uint64_t>(v + (1 << 20)) & 0x1fffff; };
  return part(b.x) << 42 | part(b.y) << 21 | part(b.z);
}

BlockCoordinate coordinate_of(uint64_t key) {
  const auto part = [&](int shift) { return static_cast<int>(key >> shift & 0x1fffff) - (1 << 20); };
  return {part(42), part(21), part(0)};
}

/// Calls visit(block) for the blocks that the segment from a to b (in units of blocks) passes, in order
/// (Amanatides and Woo 1987).
template <class Visit>
void walk_blocks(const Vec3d& a, const Vec3d& b, const Visit& visit) {
  const Vec3d direction = b - a;
  BlockCoordinate cell{static_cast<int>(std::floor(a.x)), static_cast<int>(std::floor(a.y)),
                       static_cast<int>(std::floor(a.z))};
  const BlockCoordinate last{static_cast<int>(std::floor(b.x)), static_cast<int>(std::floor(b.y)),
                             static_cast<int>(std::floor(b.z))};
  int* at[3] = {&cell.x, &cell.y, &cell.z};
  Vec3d next, delta;
  int step[3];
  for (int i = 0; i < 3; ++i) {
    const double d = direction[i];
    step[i] = d > 0 ? 1 : -1;
    const double border = d > 0 ? *at[i] + 1.0 : *at[i];
    next[i] = d != 0 ? (border - a[i]) / d : std::numeric_limits<double>::infinity();
    delta[i] = d != 0 ? std::abs(1 / d) : std::numeric_limits<double>::infinity();
  }
  // Each step crosses one border; the count bounds the walk whatever rounding does.
  const int steps = std::abs(last.x - cell.x) + std::abs(last.y - cell.y) + std::abs(last.z - cell.z);
  visit(cell);
  for (int s = 0; s < steps; ++s) {
    const int i = next.x <= next.y ? (next.x <= next.z ? 0 : 2) : (next.y <= next.z ? 1 : 2);
    *at[i] += step[i];
    next[i] += delta[i];
    visit(cell);
  }
}

}  // namespace

TsdfVolume::TsdfVolume(const TsdfOptions& options) : options_(options) {
  if (!(options.voxel > 0) || !(options.truncation > 0) || !std::isfinite(options.voxel + options.truncation)) {
    throw_usage(fmt::format("a voxel of {} with a truncation of {} is not possible", options.voxel, options.truncation),
                "both must be positive lengths in scene units");
  }
  if (options.truncation < options.voxel || options.truncation > kMaxTruncationVoxels * options.voxel) {
    throw_usage(fmt::format("a truncation of {} does not suit a voxel of {}", options.truncation, options.voxel),
                fmt::format("choose a truncation of 1 to {} voxels", kMaxTruncationVoxels));
  }
  if (options_.max_bytes == 0) options_.max_bytes = MemoryBudget().limit();
}

int64_t TsdfVolume::find(const BlockCoordinate& block) const {
  const auto it = numbers_.find(key_of(block));
  return it == numbers_.end() ? -1 : static_cast<int64_t>(it->second);
}

uint64_t TsdfVolume::predicted_bytes() const {
  return blocks() * (sizeof(Block) + kBookkeepingBytes + kExtractionBytes);
}

void TsdfVolume::require_budget(size_t count) const {
  const uint64_t needed = count * (sizeof(Block) + kBookkeepingBytes + kExtractionBytes);
  if (needed <= options_.max_bytes) return;
  // The number of blocks near a surface falls with the square of the voxel.
  throw_resources({},
                  fmt::format("fusing at a voxel of {:.4g} needs more than the budget of {}", options_.voxel,
                              format_bytes(options_.max_bytes)),
                  fmt::format("use a larger voxel, twice as large ({:.4g}) needs about a quarter", 2 * options_.voxel));
}

void TsdfVolume::reserve(const TsdfView& view, ThreadPool& pool) {
  const Camera& camera = *view.camera;
  const double block = options_.voxel * kBlockSide;
  const Rigidd to_world = camera.world_to_camera.inverse();
  const size_t chunks = (camera.height + kRowGrain - 1) / kRowGrain;
  std::vector<std::vector<uint64_t>> found(chunks);
  pool.parallel_for(camera.height, kRowGrain, [&](size_t begin, size_t end, int) {
    std::vector<uint64_t>& keys = found[begin / kRowGrain];
    std::vector<uint64_t> recent(kRecentKeys, ~uint64_t(0));
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const float d = valid_depth(*view.depth, x, y);
        if (d == 0 || !(view.weight->at(x, y) > 0)) continue;
        const Vec3d ray = camera.ray(x + 0.5, y + 0.5);
        // Never behind the camera, where no pixel looks.
        const Vec3d front = to_world * (ray * std::max(d - options_.truncation, 0.0));
        const Vec3d back = to_world * (ray * (d + options_.truncation));
        const double reach = block * kMaxCoordinate;
        if (!(std::abs(back.x) < reach && std::abs(back.y) < reach && std::abs(back.z) < reach)) {
          throw_bad_input(
              {}, "positions",
              fmt::format("a surface lies {:.4g} from the origin (at depth {:.4g}), a voxel of {:.4g} reaches {:.4g}",
                          norm(back), d, options_.voxel, reach),
              d < reach ? "`aligngs import` moves a scene to its origin; or use a larger voxel"
                        : "use a larger voxel or cut the depth");
        }
        walk_blocks(front * (1 / block), back * (1 / block), [&](const BlockCoordinate& b) {
          const uint64_t key = key_of(b);
          uint64_t& slot = recent[(key ^ key >> 17 ^ key >> 37) % kRecentKeys];
          if (slot == key) return;
          slot = key;
          keys.push_back(key);
        });
      }
    }
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  });
  std::vector<uint64_t> keys;
  for (const auto& part : found) keys.insert(keys.end(), part.begin(), part.end());
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  for (const uint64_t key : keys) {
    if (!numbers_.emplace(key, static_cast<uint32_t>(coordinates_.size())).second) continue;
    coordinates_.push_back(coordinate_of(key));
    require_budget(coordinates_.size());
  }
}

void TsdfVolume::allocate() {
  blocks_.reserve(coordinates_.size());
  while (blocks_.size() < coordinates_.size()) blocks_.push_back(std::make_unique<Block>());
}

VoxelView TsdfVolume::voxel_view(const TsdfView& view) const {
  const Camera& camera = *view.camera;
  VoxelView out;
  out.depth = view.depth->data.data();
  out.color = view.color ? view.color->data.data() : nullptr;
  out.weight = view.weight->data.data();
  out.slope = view.slope ? view.slope->data.data() : nullptr;
  out.width = camera.width;
  out.height = camera.height;
  out.fx = static_cast<float>(camera.fx);
  out.fy = static_cast<float>(camera.fy);
  out.cx = static_cast<float>(camera.cx);
  out.cy = static_cast<float>(camera.cy);
  out.truncation = static_cast<float>(options_.truncation);
  out.behind = static_cast<float>(options_.behind * options_.truncation);
  out.observed_only = view.observed_only;
  out.carve = options_.carve;
  out.voxel = options_.voxel;
  out.world_to_camera = camera.world_to_camera;
  out.planes[0] = normalized(Vec3d{camera.fx, 0, camera.cx});
  out.planes[1] = normalized(Vec3d{-camera.fx, 0, camera.width - camera.cx});
  out.planes[2] = normalized(Vec3d{0, camera.fy, camera.cy});
  out.planes[3] = normalized(Vec3d{0, -camera.fy, camera.height - camera.cy});
  const Mat3d& rotation = camera.world_to_camera.rotation;
  out.along_x = (rotation.column(0) * options_.voxel).cast<float>();
  out.along_y = (rotation.column(1) * options_.voxel).cast<float>();
  out.along_z = (rotation.column(2) * options_.voxel).cast<float>();
  out.radius = 0.5 * std::sqrt(3.0) * (options_.voxel * kBlockSide);
  float deepest = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const float d = out.depth_at(x, y);
      if (d > deepest && view.weight->at(x, y) > 0) deepest = d;
    }
  }
  if (deepest > 0) out.farthest = deepest + options_.truncation + out.radius;
  return out;
}

void TsdfVolume::integrate(const TsdfView& view, ThreadPool& pool) {
  const VoxelView seen = voxel_view(view);
  if (seen.farthest == 0) return;
  pool.parallel_for(blocks_.size(), kBlockGrain, [&](size_t begin, size_t end, int) {
    for (size_t b = begin; b < end; ++b) {
      if (!seen.sees(coordinates_[b])) continue;
      const Vec3f origin = seen.origin(coordinates_[b]);
      Voxel* voxel = blocks_[b]->data();
      for (int k = 0; k < kBlockSide; ++k) {
        for (int j = 0; j < kBlockSide; ++j) {
          const Vec3f row = seen.row(origin, j, k);
          for (int i = 0; i < kBlockSide; ++i, ++voxel) {
            fuse_voxel(seen, row + seen.along_x * static_cast<float>(i), *voxel);
          }
        }
      }
    }
  });
}

void TsdfVolume::integrate(const std::vector<TsdfView>& views, TsdfDevice& device) {
  std::vector<VoxelView> seen;
  for (const TsdfView& view : views) {
    seen.push_back(voxel_view(view));
    if (seen.back().farthest == 0) seen.pop_back();
  }
  std::vector<Voxel*> blocks;
  for (const auto& block : blocks_) blocks.push_back(block->data());
  device.fuse(seen, coordinates_, blocks);
}

}  // namespace aligngs
