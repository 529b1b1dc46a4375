// Rendering any camera, labels included; the counterpart of reference::render.
#include <cmath>

#include "engine/cpu/cpu_engine.h"
#include "engine/cpu/tile_products.h"
#include "engine/formulas/plane_depth.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kImageRowsPerTask = 8;  ///< image rows per task
constexpr float kLabelAlphaMin = 0.5f;   ///< "nothing here" below (engine.h)

/// Arg-max class of one pixel and its probability.
void label_pixel(float* blended, const ClassCounts& counts, const ActiveClasses& map, float alpha, bool probabilities,
                 uint16_t& label, float& probability) {
  const int best = arg_max(blended, counts.classes());
  if (probabilities) {
    probability = blended[best] + (1.0f - alpha) / static_cast<float>(counts.all_classes());
  } else {
    const float top = blended[best];
    float sum = 0;
    for (int c = 0; c < counts.channels; ++c) sum += counts.count[static_cast<size_t>(c)] * std::exp(blended[c] - top);
    probability = 1.0f / sum;
  }
  const uint16_t index = map.has_remainder() ? map.active[static_cast<size_t>(best)] : static_cast<uint16_t>(best);
  label = alpha >= kLabelAlphaMin ? index : kNoLabel;
}

void interleave(const std::vector<float>& planes, size_t pixels, size_t begin, size_t end, ImageF& out) {
  for (size_t u = begin; u < end; ++u) {
    for (size_t k = 0; k < 3; ++k) out.data[3 * u + k] = planes[k * pixels + u];
  }
}

}  // namespace

Rendering CpuEngine::render(const Camera& camera, const RenderOptions& options) const {
  prepare_frame(camera, options.raster, options.median_only ? 0 : model_.sh_degree);  // degree 0: without the view
  const ProjectedView& view = frame_.view;
  const ViewTiles tiles{view, frame_.lists, options.raster};
  const BlendedMaps colored = options.geometry ? BlendedMaps::kAll : BlendedMaps::kColor;
  const bool labels = options.labels && model_.semantic_channels > 0 && !options.median_only;
  forward_pass(tiles, options.median_only ? BlendedMaps::kMedian : colored, *pool_, scratch_, frame_.maps,
               labels ? &frame_.record : nullptr);
  const RenderMaps<float>& m = frame_.maps;
  const int w = m.width, h = m.height;
  const size_t n = m.pixels();
  Rendering r;
  if (options.median_only) {
    r.depth_median = ImageF(w, h, 1);
    r.depth_median.data = m.median;
    return r;
  }
  r.color = ImageF(w, h, 3);
  r.alpha = ImageF(w, h, 1);
  r.alpha.data = m.alpha;
  if (options.geometry) {
    r.normal = ImageF(w, h, 3);
    r.depth_plane = r.depth_expected = ImageF(w, h, 1);
    r.depth_median = ImageF(w, h, 1);
    r.depth_median.data = m.median;
  }
  pool_->parallel_for(static_cast<size_t>(h), kImageRowsPerTask, [&](size_t begin, size_t end, int) {
    interleave(m.color, n, begin * w, end * w, r.color);
    if (!options.geometry) return;
    for (size_t y = begin; y < end; ++y) {
      for (int x = 0; x < w; ++x) {
        const size_t u = y * w + x;
        const Vec3<float> sum{m.normal[u], m.normal[n + u], m.normal[2 * n + u]};
        const Vec3<float> unit = normalized(sum);
        for (int k = 0; k < 3; ++k) r.normal.data[3 * u + k] = unit[k];
        const float z = plane_depth(sum, m.distance[u], m.alpha[u], view.camera.ray(x, static_cast<int>(y))).z;
        const bool valid = plane_depth_valid(z, m.alpha[u], m.expected[u], static_cast<float>(kPlaneAlphaLoss));
        r.depth_plane.data[u] = valid ? z : 0.0f;
        r.depth_expected.data[u] = m.alpha[u] > 0 ? m.expected[u] / m.alpha[u] : 0.0f;
      }
    }
  });
  if (!labels) return r;

  std::vector<uint8_t> touched;  // the rest of the rows in view has no part in any pixel
  mark_touched(frame_.lists, frame_.record, *pool_, touched);
  prepare_features(options.semantic_blend, touched.data());
  const int channels = model_.semantic_channels;
  r.label = Image<uint16_t>(w, h, 1, kNoLabel);
  r.label_probability = ImageF(w, h, 1);
  const size_t padded = padded_channels(channels);
  const bool probabilities = options.semantic_blend == SemanticBlend::kProbabilities;
  pool_->parallel_for(view.tiles(), 1, [&](size_t begin, size_t end, int worker) {
    TileScratch& s = scratch_[static_cast<size_t>(worker)];
    s.semantic.block.blended.resize(kBlockPixels * padded);
    for (size_t tile = begin; tile < end; ++tile) {
      recompute_tile_weights(view, frame_.lists, static_cast<int>(tile) % view.tiles_x,
                             static_cast<int>(tile) / view.tiles_x, options.raster, frame_.record, s.weights);
      for (const BlockWeights& block : s.weights.blocks) {
        s.semantic.rows.resize(block.count);
        for (size_t e = 0; e < block.count; ++e) {
          s.semantic.rows[e] =
              frame_.features.data() + size_t(frame_.lists.rank[s.weights.rows[block.entry[e]]]) * padded;
        }
        order_by_strips(block, s.semantic.strips);
        block_blend_rows(block, s.semantic.strips, s.semantic.rows.data(), padded, s.semantic.block.blended.data());
        for (int i = 0; i < kBlockPixels; ++i) {
          const int x = block.x + i % kBlockSize, y = block.y + i / kBlockSize;
          if (x >= w || y >= h) continue;
          const size_t u = size_t(y) * w + x;
          label_pixel(s.semantic.block.blended.data() + i * padded, counts_, map_, m.alpha[u], probabilities,
                      r.label.data[u], r.label_probability.data[u]);
        }
      }
    }
  });
  return r;
}

}  // namespace aligngs::cpu
