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

constexpr double kMaxTruncationVoxels = 64;   // bounds the blocks that one pixel can ask for
// Blocks from the origin: three coordinates share one 64-bit key; the margin holds the band around the surface.
constexpr int kMaxCoordinate = (1 << 20) - 64;
constexpr size_t kRowGrain = 8;               // image rows per chunk
constexpr size_t kBlockGrain = 32;            // blocks per chunk
constexpr size_t kRecentKeys = 4096;          // slots of the filter for blocks that were noted a moment ago
// Hash node, coordinate and pointer of a block; and the vertices and triangles of the blocks that the surface
// crosses (about 100 and 200 in two of five blocks), with the doubling of growing arrays.
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

/// Depth at image point (u, v): bilinear where the four pixels around it belong to one surface, else the nearest
/// pixel's. `jump` is the largest difference within one surface.
float sample_depth(const ImageF& depth, float u, float v, int x, int y, float jump) {
  const float nearest = valid_depth(depth, x, y);
  if (nearest == 0) return 0;
  const float gx = u - 0.5f, gy = v - 0.5f;
  const int x0 = static_cast<int>(std::floor(gx)), y0 = static_cast<int>(std::floor(gy));
  if (x0 < 0 || y0 < 0 || x0 + 1 >= depth.width || y0 + 1 >= depth.height) return nearest;
  const float a = valid_depth(depth, x0, y0), b = valid_depth(depth, x0 + 1, y0);
  const float c = valid_depth(depth, x0, y0 + 1), d = valid_depth(depth, x0 + 1, y0 + 1);
  const float low = std::min(std::min(a, b), std::min(c, d)), high = std::max(std::max(a, b), std::max(c, d));
  if (low == 0 || high - low > jump) return nearest;
  const float s = gx - static_cast<float>(x0), t = gy - static_cast<float>(y0);
  return (a * (1 - s) + b * s) * (1 - t) + (c * (1 - s) + d * s) * t;
}

void add_color(Voxel& voxel, const float* rgb, float weight) {
  const float units = std::clamp(weight / kColorWeightUnit, 1.0f, 65535.0f);
  const float total = std::min(static_cast<float>(voxel.color_weight) + units, 65535.0f);
  const float share = units / total;
  for (int c = 0; c < 3; ++c) {
    const float value = rgb[c] > 0 ? std::min(rgb[c], 1.0f) * 65535.0f : 0.0f;
    const float mean = static_cast<float>(voxel.color[c]);
    voxel.color[c] = static_cast<uint16_t>(std::lround(std::clamp(mean + (value - mean) * share, 0.0f, 65535.0f)));
  }
  voxel.color_weight = static_cast<uint16_t>(total);
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
  throw_resources({}, fmt::format("fusing at a voxel of {:.4g} needs more than the budget of {}", options_.voxel,
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
          throw_bad_input({}, "depth", fmt::format("a surface at depth {:.4g} is too far away for a voxel of {:.4g}", d,
                                                   options_.voxel),
                          "use a larger voxel or cut the depth");
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

void TsdfVolume::integrate(const TsdfView& view, ThreadPool& pool) {
  const Camera& camera = *view.camera;
  float farthest = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const float d = valid_depth(*view.depth, x, y);
      if (d == 0 || !(view.weight->at(x, y) > 0)) continue;
      farthest = std::max(farthest, d);
    }
  }
  if (farthest == 0) return;
  const double block = options_.voxel * kBlockSide, radius = 0.5 * std::sqrt(3.0) * block;
  // Planes through the camera centre and the image borders, normals pointing inwards.
  const Vec3d planes[4] = {normalized(Vec3d{camera.fx, 0, camera.cx}),
                           normalized(Vec3d{-camera.fx, 0, camera.width - camera.cx}),
                           normalized(Vec3d{0, camera.fy, camera.cy}),
                           normalized(Vec3d{0, -camera.fy, camera.height - camera.cy})};
  pool.parallel_for(blocks_.size(), kBlockGrain, [&](size_t begin, size_t end, int) {
    for (size_t b = begin; b < end; ++b) {
      const BlockCoordinate& at = coordinates_[b];
      const Vec3d centre =
          camera.world_to_camera * Vec3d{(at.x + 0.5) * block, (at.y + 0.5) * block, (at.z + 0.5) * block};
      if (centre.z < -radius || centre.z > farthest + options_.truncation + radius) continue;
      bool inside = true;
      for (const Vec3d& plane : planes) inside = inside && dot(plane, centre) > -radius;
      if (inside) integrate_block(b, view);
    }
  });
}

void TsdfVolume::integrate_block(size_t block, const TsdfView& view) {
  const Camera& camera = *view.camera;
  const BlockCoordinate& at = coordinates_[block];
  const Mat3d& rotation = camera.world_to_camera.rotation;
  const Vec3f origin =
      (camera.world_to_camera * position(at.x * kBlockSide, at.y * kBlockSide, at.z * kBlockSide)).cast<float>();
  const Vec3f along_x = (rotation.column(0) * options_.voxel).cast<float>();
  const Vec3f along_y = (rotation.column(1) * options_.voxel).cast<float>();
  const Vec3f along_z = (rotation.column(2) * options_.voxel).cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  const auto truncation = static_cast<float>(options_.truncation);
  Voxel* voxel = blocks_[block]->data();
  for (int k = 0; k < kBlockSide; ++k) {
    for (int j = 0; j < kBlockSide; ++j) {
      const Vec3f row = origin + along_y * static_cast<float>(j) + along_z * static_cast<float>(k);
      for (int i = 0; i < kBlockSide; ++i, ++voxel) {
        const Vec3f p = row + along_x * static_cast<float>(i);
        if (!(p.z > 0)) continue;
        const float inverse = 1 / p.z;
        const float u = fx * p.x * inverse + cx, v = fy * p.y * inverse + cy;
        if (!(u >= 0 && v >= 0 && u < width && v < height)) continue;
        const int x = static_cast<int>(u), y = static_cast<int>(v);
        const float weight = view.weight->at(x, y);
        if (!(weight > 0) || (view.observed_only && voxel->weight == 0)) continue;
        const float depth = sample_depth(*view.depth, u, v, x, y, truncation);
        const float distance = depth - p.z;
        if (depth == 0 || distance < -truncation) continue;
        const bool near = distance <= truncation;
        if (!near && !options_.carve) continue;
        const float total = voxel->weight + weight;
        const float value = near ? distance / truncation : 1.0f;
        voxel->tsdf += (value - voxel->tsdf) * (weight / total);
        voxel->weight = total;
        if (near && view.color) add_color(*voxel, view.color->pixel(x, y), weight);
      }
    }
  }
}

}  // namespace aligngs
