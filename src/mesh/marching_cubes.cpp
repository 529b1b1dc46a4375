#include "mesh/marching_cubes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/progress.h"
#include "mesh/marching_cubes_table.h"

namespace aligngs {
namespace {

constexpr size_t kCubeBlockGrain = 32;         // blocks per chunk
constexpr int kWords = 3 * kBlockVoxels / 64;  // one bit per lattice edge that a block owns
constexpr uint8_t kGrey = 128;                 // vertices without colour

int index_in_block(int x, int y, int z) { return (z * kBlockSide + y) * kBlockSide + x; }

/// The vertices on the lattice edges that start in a block, numbered in the order of their bits.
struct BlockVertices {
  std::array<uint64_t, kWords> crossed{};
  std::array<uint16_t, kWords> before{};  // bits set in the words before this one
  uint32_t first = 0;                     // number of the block's first vertex in the mesh

  void mark(int edge) { crossed[edge / 64] |= uint64_t(1) << (edge % 64); }
  uint32_t count() const {
    return before[kWords - 1] + static_cast<uint32_t>(__builtin_popcountll(crossed[kWords - 1]));
  }
  void finish() {
    for (int w = 1; w < kWords; ++w) {
      before[w] = static_cast<uint16_t>(before[w - 1] + __builtin_popcountll(crossed[w - 1]));
    }
  }
  uint32_t number(int edge) const {
    const uint64_t below = crossed[edge / 64] & ((uint64_t(1) << (edge % 64)) - 1);
    return first + before[edge / 64] + static_cast<uint32_t>(__builtin_popcountll(below));
  }
};

/// A block with its 26 neighbours: lattice coordinates may run one block over on either side.
class Neighbourhood {
 public:
  Neighbourhood(const TsdfVolume& volume, size_t block) : volume_(volume) {
    const BlockCoordinate at = volume.coordinate(block);
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const bool self = dx == 0 && dy == 0 && dz == 0;
          blocks_[slot(dx, dy, dz)] =
              self ? static_cast<int64_t>(block) : volume.find({at.x + dx, at.y + dy, at.z + dz});
        }
  }
  /// Number of the block that holds a lattice point, or -1.
  int64_t block_of(int x, int y, int z) const {
    return blocks_[slot(x >> 3, y >> 3, z >> 3)];  // -8..15 -> -1, 0, 1
  }
  /// The voxel at a lattice point, or nullptr when it was never observed.
  const Voxel* voxel(int x, int y, int z) const {
    const int64_t b = block_of(x, y, z);
    if (b < 0) return nullptr;
    const Voxel* v = volume_.voxels(static_cast<size_t>(b)) + index_in_block(x & 7, y & 7, z & 7);
    return v->weight > 0 ? v : nullptr;
  }

 private:
  static_assert(kBlockSide == 8, "shifts and masks above");
  static int slot(int dx, int dy, int dz) { return (dz + 1) * 9 + (dy + 1) * 3 + dx + 1; }
  const TsdfVolume& volume_;
  std::array<int64_t, 27> blocks_;
};

class Extraction {
 public:
  Extraction(const TsdfVolume& volume, ThreadPool& pool, const MarchingCubesOptions& options)
      : volume_(volume), pool_(pool), min_weight_(static_cast<float>(options.min_weight)) {}

  TriangleMesh run() {
    // Triangles first: they say which vertices are needed. Until vertices are numbered, a triangle's corner is the
    // pair of the block that owns its edge and the edge's number there.
    for_chunks([this](size_t block, Chunk& chunk) { find_triangles(block, chunk); });
    number_vertices();
    for_chunks([this](size_t block, Chunk& chunk) { make_vertices(block, chunk); });
    make_triangles();
    return std::move(mesh_);
  }

 private:
  struct Corner {
    uint32_t block;
    uint16_t edge;
  };
  struct Chunk {
    std::vector<Corner> corners;  // three per triangle
  };

  template <class Body>
  void for_chunks(const Body& body) {
    chunks_.resize((volume_.blocks() + kCubeBlockGrain - 1) / kCubeBlockGrain);
    pool_.parallel_for(volume_.blocks(), kCubeBlockGrain, [&](size_t begin, size_t end, int) {
      for (size_t b = begin; b < end; ++b) body(b, chunks_[begin / kCubeBlockGrain]);
    });
  }

  void find_triangles(size_t block, Chunk& chunk) const {
    const Voxel* own = volume_.voxels(block);
    if (std::none_of(own, own + kBlockVoxels, [](const Voxel& v) { return v.weight > 0; })) return;
    const Neighbourhood near(volume_, block);
    const auto& table = marching_cubes_table();
    for (int z = 0; z < kBlockSide; ++z)
      for (int y = 0; y < kBlockSide; ++y)
        for (int x = 0; x < kBlockSide; ++x) {
          int inside = 0, corner = 0;
          for (; corner < 8; ++corner) {
            const Voxel* v = near.voxel(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2 & 1));
            if (!v || v->weight < min_weight_) break;
            inside |= (v->tsdf < 0) << corner;
          }
          if (corner < 8 || inside == 0 || inside == 255) continue;
          const CubeCase& cube = table[inside];
          for (int i = 0; i < 3 * cube.triangles; ++i) {
            const int edge = cube.edges[i], from = cube_edge_corner(edge);
            const int ex = x + (from & 1), ey = y + (from >> 1 & 1), ez = z + (from >> 2 & 1);
            const auto owner = static_cast<uint32_t>(near.block_of(ex, ey, ez));
            chunk.corners.push_back(
                {owner, static_cast<uint16_t>(3 * index_in_block(ex & 7, ey & 7, ez & 7) + edge / 4)});
          }
        }
  }

  void number_vertices() {
    vertices_.assign(volume_.blocks(), {});
    size_t corners = 0, vertices = 0;
    for (const Chunk& chunk : chunks_) {
      corners += chunk.corners.size();
      for (const Corner& c : chunk.corners) vertices_[c.block].mark(c.edge);
    }
    for (BlockVertices& b : vertices_) {
      b.finish();
      b.first = static_cast<uint32_t>(vertices);
      vertices += b.count();
    }
    const uint64_t bytes = volume_.blocks() * (sizeof(Voxel) * kBlockVoxels + sizeof(BlockVertices)) +
                           corners * (sizeof(Corner) + sizeof(uint32_t)) +
                           vertices * (2 * sizeof(Vec3f) + sizeof(std::array<uint8_t, 3>));
    if (bytes > volume_.max_bytes() || vertices > 0xfffffff0u) {
      throw_resources({},
                      fmt::format("a mesh of {} vertices and {} triangles needs {}, the budget is {}", vertices,
                                  corners / 3, format_bytes(bytes), format_bytes(volume_.max_bytes())),
                      fmt::format("use a larger voxel than {:.4g}", volume_.options().voxel));
    }
    mesh_.vertices.resize(vertices);
    mesh_.normals.resize(vertices);
    mesh_.colors.resize(vertices);
    mesh_.triangles.reserve(corners / 3);
  }

  void make_vertices(size_t block, Chunk&) {
    const BlockVertices& own = vertices_[block];
    if (own.count() == 0) return;
    const Neighbourhood near(volume_, block);
    uint32_t number = own.first;
    for (int word = 0; word < kWords; ++word) {
      for (uint64_t bits = own.crossed[word]; bits; bits &= bits - 1) {
        make_vertex(block, near, 64 * word + __builtin_ctzll(bits), number++);
      }
    }
  }

  void make_vertex(size_t block, const Neighbourhood& near, int edge, uint32_t number) {
    const int axis = edge % 3, voxel = edge / 3;
    const int a[3] = {voxel & 7, voxel >> 3 & 7, voxel >> 6};
    int b[3] = {a[0], a[1], a[2]};
    ++b[axis];
    const Voxel& from = *near.voxel(a[0], a[1], a[2]);
    const Voxel& to = *near.voxel(b[0], b[1], b[2]);
    const float share = from.tsdf / (from.tsdf - to.tsdf);  // one is negative, the other is not
    const BlockCoordinate at = volume_.coordinate(block);
    const int origin[3] = {at.x * kBlockSide, at.y * kBlockSide, at.z * kBlockSide};
    Vec3d position = volume_.position(origin[0] + a[0], origin[1] + a[1], origin[2] + a[2]);
    position[axis] += share * volume_.options().voxel;
    mesh_.vertices[number] = position.cast<float>();

    Vec3f normal = normalized(gradient(near, a) * (1 - share) + gradient(near, b) * share);
    if (!(dot(normal, normal) > 0.5f)) {  // the two gradients cancelled
      normal = {};
      normal[axis] = to.tsdf > from.tsdf ? 1.0f : -1.0f;
    }
    mesh_.normals[number] = normal;
    mesh_.colors[number] = color(from, to, share);
  }

  /// Central differences where both neighbours are known, one-sided or zero otherwise; per two voxels.
  static Vec3f gradient(const Neighbourhood& near, const int* at) {
    const Voxel* centre = near.voxel(at[0], at[1], at[2]);
    Vec3f g;
    for (int axis = 0; axis < 3; ++axis) {
      int low[3] = {at[0], at[1], at[2]}, high[3] = {at[0], at[1], at[2]};
      --low[axis];
      ++high[axis];
      const Voxel* before = near.voxel(low[0], low[1], low[2]);
      const Voxel* after = near.voxel(high[0], high[1], high[2]);
      if (before && after) {
        g[axis] = after->tsdf - before->tsdf;
      } else if (after) {
        g[axis] = 2 * (after->tsdf - centre->tsdf);
      } else if (before) {
        g[axis] = 2 * (centre->tsdf - before->tsdf);
      }
    }
    return g;
  }

  static std::array<uint8_t, 3> color(const Voxel& from, const Voxel& to, float share) {
    if (!from.color_weight && !to.color_weight) return {kGrey, kGrey, kGrey};
    if (!from.color_weight) share = 1;
    if (!to.color_weight) share = 0;
    std::array<uint8_t, 3> rgb;
    for (int c = 0; c < 3; ++c) {
      const float value = static_cast<float>(from.color[c]) * (1 - share) + static_cast<float>(to.color[c]) * share;
      rgb[c] = static_cast<uint8_t>(std::lround(value / 257.0f));  // 65535 = 255 * 257
    }
    return rgb;
  }

  void make_triangles() {
    for (Chunk& chunk : chunks_) {
      for (size_t i = 0; i < chunk.corners.size(); i += 3) {
        std::array<uint32_t, 3> t;
        for (int k = 0; k < 3; ++k) {
          const Corner& c = chunk.corners[i + k];
          t[k] = vertices_[c.block].number(c.edge);
        }
        mesh_.triangles.push_back(t);
      }
      chunk.corners = {};
    }
  }

  const TsdfVolume& volume_;
  ThreadPool& pool_;
  float min_weight_;
  std::vector<Chunk> chunks_;
  std::vector<BlockVertices> vertices_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh extract_surface(const TsdfVolume& volume, ThreadPool& pool, const MarchingCubesOptions& options) {
  return Extraction(volume, pool, options).run();
}

}  // namespace aligngs
