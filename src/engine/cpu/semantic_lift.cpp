// The closed-form start of the semantic rows, and what a run needs in memory.
#include "engine/cpu/cpu_engine.h"
#include "engine/cpu/tile_products.h"
#include "engine/formulas/semantic_start.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kLiftedRowsPerTask = 512;

}  // namespace

void CpuEngine::lift_semantics(const RasterSettings& raster) {
  const size_t channels = static_cast<size_t>(model_.semantic_channels), n = model_.size();
  if (channels == 0) return;
  const size_t padded = padded_channels(model_.semantic_channels);
  AlignedArray<float> sums(n * padded);
  std::vector<uint8_t> written(n, 0);
  for (const TrainingView& view : views_) {
    if (view.data.semantics.channels != model_.semantic_channels || view.data.semantics.empty()) continue;
    if (map_.remainder() != active_.remainder()) continue;  // a model of another number of classes
    SemanticStep step;
    step.view = &view;
    step.channels = model_.semantic_channels;
    step.padded = padded;
    prepare_frame(view.data.camera, raster, model_.sh_degree);
    lift_pass({frame_.view, frame_.lists, raster}, step, *pool_, scratch_, batches_, sums.data(), written);
  }
  pool_->parallel_for(n, kLiftedRowsPerTask, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      if (written[i] == 0) continue;
      semantic_start(sums.data() + i * padded, model_.semantic_channels, map_.remainder(),
                     model_.semantics.data() + i * channels);
    }
  });
  rounded_for_.reset();
  if (!has_moments()) return;
  moments_.m.semantics.assign(model_.semantics.size(), 0.0f);
  moments_.v.semantics.assign(model_.semantics.size(), 0.0f);
  moments_.semantic_updates.assign(model_.size(), 0.0f);
}

uint64_t CpuEngine::predicted_bytes(size_t gaussians, int channels, size_t pixels_per_view) const {
  constexpr uint64_t kFloat = sizeof(float);
  // (Gaussian, tile) pairs per Gaussian: 4 to 5 in rooms trained at 320x240 to 640x480, rectangles included.
  constexpr uint64_t kInstances = 6;
  // Numbers per pixel of one view at work: maps 10, their gradients 8, scratch of the losses, residual, BlendRecord.
  constexpr uint64_t kMapsPerPixel = 49;
  const uint64_t numbers = 3 + 3 + 4 + 1 + 3 * kShCoefficients, padded = padded_channels(channels);
  uint64_t per_gaussian = 3 * (numbers + static_cast<uint64_t>(channels)) * kFloat;  // parameters and two moments
  per_gaussian *= 2;                                                                 // and their copy in a checkpoint
  // Gradients; blended rows, their gradients, and as much again for the rounded rows and sums between tiles.
  per_gaussian += numbers * kFloat + 3 * padded * kFloat + static_cast<uint64_t>(pool_->size()) * sizeof(uint32_t);
  per_gaussian += 8 * kFloat;  // density statistics, updates of the semantic row
  per_gaussian += sizeof(Splat) + sizeof(TileRect) + kFloat + 8 + 6 * kFloat;  // projection and its order
  per_gaussian += kInstances * (sizeof(CoupledSplatGradient) + sizeof(uint32_t) + sizeof(uint16_t) + 1);  // BlendRecord
  per_gaussian += sizeof(DensitySums);
  const uint64_t threads = static_cast<uint64_t>(pool_->size());
  // Per thread: weights of four blocks of up to a thousand Gaussians, once more rounded, and the maps of a block.
  const uint64_t per_thread = 6 * 1024 * (4 * kBlockPixels * kFloat) + 8 * kBlockPixels * padded * kFloat;
  uint64_t views = 0;
  for (const TrainingView& view : views_) {
    const ViewData& d = view.data;
    views += (d.color.data.size() + d.mask.data.size() + d.prior_depth.data.size() + view.depth_weight.data.size() +
              view.prior_normal.data.size() + view.semantic_weight.data.size() + d.semantics.confidence.size() +
              d.semantics.scale.size() + d.semantics.score_sum.size()) *
             kFloat;
    views += (d.semantics.probabilities.size() + d.labels.data.size()) * sizeof(uint16_t) + view.label_edge.data.size();
    if (!d.semantics.empty()) views += pixels_per_view * (kFloat + sizeof(uint16_t));
  }
  return per_gaussian * gaussians + per_thread * threads + kMapsPerPixel * kFloat * pixels_per_view + views;
}

GaussianModel CpuEngine::last_gradients() const {
  GaussianModel g;
  g.semantic_channels = model_.semantic_channels;
  g.resize(model_.size());
  const auto copy = [](const AlignedArray<float>& from, std::vector<float>& to) {
    if (from.size() == to.size()) std::copy(from.data(), from.data() + from.size(), to.begin());
  };
  copy(gradients_.positions, g.positions);
  copy(gradients_.log_scales, g.log_scales);
  copy(gradients_.rotations, g.rotations);
  copy(gradients_.opacity_logits, g.opacity_logits);
  const size_t channels = static_cast<size_t>(model_.semantic_channels),
               padded = padded_channels(model_.semantic_channels);
  constexpr size_t kShRow = 3 * kShCoefficients;
  for (size_t i = 0; i < model_.size(); ++i) {
    if (gradients_.touched.size() != model_.size() || gradients_.touched[i] == 0) continue;
    std::copy(gradients_.sh.data() + kShRow * i, gradients_.sh.data() + kShRow * (i + 1), g.sh.begin() + kShRow * i);
    const size_t rank = frame_.lists.rank[i];
    if (!last_semantics_ || feature_written_[rank] == 0) continue;
    const float* from = feature_gradients_.data() + rank * padded;
    float* to = g.semantics.data() + channels * i;
    if (last_probabilities_) {
      softmax_backward(frame_.features.data() + rank * padded, from, model_.semantic_channels, to);
    } else {
      std::copy(from, from + channels, to);
    }
  }
  return g;
}

}  // namespace aligngs::cpu
