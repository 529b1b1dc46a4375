#include "engine/cpu/view_votes.h"

#include <algorithm>

#include "engine/cpu/project.h"
#include "engine/cpu/tile_products.h"

namespace aligngs::cpu {
namespace {

constexpr size_t kVotedRowsPerTask = 2048;

}  // namespace

ViewVotes::ViewVotes(const GaussianModel& model, int channels, ThreadPool& pool)
    : model_(model),
      channels_(channels),
      padded_(padded_channels(channels)),
      pool_(pool),
      scratch_(static_cast<size_t>(pool.size())) {
  sums_.resize(model.size() * padded_);
  votes_.resize(model.size() * static_cast<size_t>(channels));
}

const std::vector<float>& ViewVotes::of(const TrainingView& view, const RasterSettings& raster) {
  const size_t channels = static_cast<size_t>(channels_);
  written_.assign(model_.size(), 0);
  if (view.data.semantics.channels == channels_ && !view.data.semantics.empty()) {
    SemanticStep step;
    step.view = &view;
    step.channels = channels_;
    step.padded = padded_;
    project_view(model_, view.data.camera, raster, 0, pool_, projected_);
    build_tile_lists(projected_, pool_, lists_);
    lift_pass({projected_, lists_, raster}, step, pool_, scratch_, batches_, sums_.data(), written_);
  }
  pool_.parallel_for(model_.size(), kVotedRowsPerTask, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      float* to = &votes_[i * channels];
      if (written_[i] == 0) {
        std::fill_n(to, channels, 0.0f);
      } else {
        std::copy_n(sums_.data() + i * padded_, channels, to);
      }
    }
  });
  return votes_;
}

}  // namespace aligngs::cpu
