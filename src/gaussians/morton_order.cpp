#include "gaussians/morton_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gaussians/restructure.h"

namespace aligngs {
namespace {

constexpr uint64_t kLast = std::numeric_limits<uint64_t>::max();  ///< behind every code

/// Two zero bits behind each of the lower 21 bits: halves move apart, then their halves.
uint64_t spread_bits(uint32_t value) {
  uint64_t x = value & ((1u << kMortonBits) - 1u);
  x = (x | x << 32) & 0x001f00000000ffffull;
  x = (x | x << 16) & 0x001f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  x = (x | x << 2) & 0x1249249249249249ull;
  return x;
}

Vec3f position_of(const GaussianModel& model, const RowOrigin& row) {
  const float* p = &model.positions[3 * size_t(row.source)];
  return {p[0] + row.offset[0], p[1] + row.offset[1], p[2] + row.offset[2]};
}

bool finite(const Vec3f& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

}  // namespace

uint64_t morton_code(uint32_t x, uint32_t y, uint32_t z) {
  return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

void sort_by_morton(const GaussianModel& model, RestructurePlan& plan) {
  constexpr float kMost = std::numeric_limits<float>::max();
  Vec3f low{kMost, kMost, kMost}, high{-kMost, -kMost, -kMost};
  for (const RowOrigin& row : plan.rows) {
    const Vec3f p = position_of(model, row);
    if (!finite(p)) continue;
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  // A cube, so that a cell is as long along every axis. In double: the difference of two floats may be none.
  double edge = 0;
  for (int k = 0; k < 3; ++k) edge = std::max(edge, double(high[k]) - double(low[k]));
  const double cells = double(1u << kMortonBits) - 1;
  const double scale = edge > 0 ? cells / edge : 0;
  const auto cell = [&](float x, float first) {
    return static_cast<uint32_t>(std::min(cells, (double(x) - double(first)) * scale));
  };

  struct Key {
    uint64_t code;
    size_t place;
  };
  std::vector<Key> keys(plan.rows.size());
  for (size_t i = 0; i < keys.size(); ++i) {
    const Vec3f p = position_of(model, plan.rows[i]);
    keys[i] = {finite(p) ? morton_code(cell(p.x, low.x), cell(p.y, low.y), cell(p.z, low.z)) : kLast, i};
  }
  std::sort(keys.begin(), keys.end(),
            [](const Key& a, const Key& b) { return a.code != b.code ? a.code < b.code : a.place < b.place; });
  std::vector<RowOrigin> rows;
  rows.reserve(keys.size());
  for (const Key& key : keys) rows.push_back(plan.rows[key.place]);
  plan.rows = std::move(rows);
}

void sort_by_morton(GaussianModel& model) {
  RestructurePlan plan = plan_keep(std::vector<uint8_t>(model.size(), 1));
  sort_by_morton(model, plan);
  restructure_model(plan, model);
}

}  // namespace aligngs
