#include "engine/losses/depth_stencil_row.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/random.h"
#include "engine/formulas/depth_terms.h"
#include "engine/formulas/normal_terms.h"
#include "engine/losses/normal_row.h"

namespace aligngs {
namespace {

/// Depths with jumps, every validity, and normals that are missing here and there.
struct RandomMap {
  int width, height;
  std::vector<float> depth, inverse_length;
  std::vector<uint8_t> validity, stencil;
  RandomMap(int w, int h, bool as_printed) : width(w), height(h) {
    Random random(static_cast<uint64_t>(100 * w + h));
    for (int i = 0; i < w * h; ++i) {
      const bool valid = random.chance(0.85);
      depth.push_back(valid ? static_cast<float>(random.uniform(0.95, 1.05) * (random.chance(0.2) ? 2 : 1)) : 0.0f);
      validity.push_back(valid ? (random.chance(0.8) ? kDepthTight : kDepthLoose) : kDepthInvalid);
      inverse_length.push_back(random.chance(0.9) ? 1.0f : 0.0f);
    }
    stencil.resize(depth.size());
    for (int y = 0; y < h; ++y) {
      depth_stencil_row(map(), y, inverse_length.data() + y * w, as_printed, stencil.data() + y * w);
    }
  }
  StencilMap<float> map() const { return {depth.data(), validity.data(), width, height}; }
};

constexpr int kSizes[][2] = {{1, 1}, {1, 5}, {5, 1}, {2, 2}, {33, 7}, {70, 20}};

TEST(DepthStencilRow, IsTheStencilOfEveryPixel) {
  for (const auto& size : kSizes) {
    for (const bool as_printed : {false, true}) {
      const RandomMap m(size[0], size[1], as_printed);
      for (int y = 0; y < m.height; ++y) {
        for (int x = 0; x < m.width; ++x) {
          const int i = y * m.width + x;
          DepthStencil want;
          if (m.inverse_length[i] > 0) {
            want = depth_stencil(m.depth.data(), m.validity.data(), x, y, m.width, m.height, as_printed);
          }
          EXPECT_EQ(m.stencil[i], want.valid() ? want.packed() : 0) << x << ' ' << y << " of " << m.width;
        }
      }
    }
  }
}

TEST(DepthStencilRow, GathersWhatTheStencilNames) {
  for (const auto& size : kSizes) {
    const RandomMap m(size[0], size[1], false);
    const int w = m.width;
    std::vector<float> in(static_cast<size_t>(kNormalRowInputs) * w);
    for (int y = 0; y < m.height; ++y) {
      gather_stencil_row(m.map(), y, m.stencil.data() + y * w, in.data());
      for (int x = 0; x < w; ++x) {
        const int i = y * w + x;
        const DepthStencil s = DepthStencil::unpack(m.stencil[i]);
        const Reach h = reach_of(s.horizontal), v = reach_of(s.vertical);
        EXPECT_EQ(in[kInRight * w + x], m.depth[i + h.after]);
        EXPECT_EQ(in[kInLeft * w + x], m.depth[i - h.before]);
        EXPECT_EQ(in[kInTop * w + x], m.depth[i - v.before * w]);
        EXPECT_EQ(in[kInBottom * w + x], m.depth[i + v.after * w]);
        EXPECT_EQ(in[kInRightOffset * w + x], h.after);
        EXPECT_EQ(in[kInLeftOffset * w + x], -h.before);
        EXPECT_EQ(in[kInTopOffset * w + x], -v.before);
        EXPECT_EQ(in[kInBottomOffset * w + x], v.after);
        EXPECT_EQ(in[kInUsed * w + x], m.stencil[i] != 0 ? 1 : 0);
      }
    }
  }
}

TEST(DepthStencilRow, ScattersToThoseItGatheredFrom) {
  for (const auto& size : kSizes) {
    const RandomMap m(size[0], size[1], false);
    const int w = m.width;
    Random random(3);
    std::vector<float> out(static_cast<size_t>(4) * w), got(m.depth.size(), 1.0f);
    std::vector<double> want(m.depth.size(), 1.0);
    for (int y = 0; y < m.height; ++y) {
      for (float& value : out) value = static_cast<float>(random.uniform(-1, 1));
      scatter_stencil_row(out.data(), y, m.stencil.data() + y * w, w, m.height, got.data());
      for (int x = 0; x < w; ++x) {
        const int i = y * w + x;
        if (m.stencil[i] == 0) continue;
        const DepthStencil s = DepthStencil::unpack(m.stencil[i]);
        const Reach h = reach_of(s.horizontal), v = reach_of(s.vertical);
        want[i + h.after] += out[x];
        want[i - h.before] += out[w + x];
        want[i - v.before * w] += out[2 * w + x];
        want[i + v.after * w] += out[3 * w + x];
      }
    }
    for (size_t i = 0; i < want.size(); ++i) EXPECT_NEAR(got[i], want[i], 2e-6) << i;
  }
}

}  // namespace
}  // namespace aligngs
