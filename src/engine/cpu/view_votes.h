// Votes of one photo's teacher for each Gaussian, by the weight with which the photo shows it.
#pragma once

#include <vector>

#include "core/thread_pool.h"
#include "engine/cpu/tile_passes.h"
#include "engine/settings.h"
#include "engine/training_view.h"
#include "gaussians/gaussian_model.h"

namespace aligngs::cpu {

/// Keeps what the views share. The model must outlive it and stay as it is.
class ViewVotes {
 public:
  /// `channels`: of the views' teachers.
  ViewVotes(const GaussianModel& model, int channels, ThreadPool& pool);

  /// Votes [N][channels] of one view, seen from its camera: the sum over its valid pixels (teacher_taps) of blending
  /// weight times the teacher's numbers. SemanticTarget::scale is included, so it may weigh a view's numbers. Hidden
  /// Gaussians get what the light that reaches them is worth. The same bits for any number of threads. Valid until the
  /// next call.
  const std::vector<float>& of(const TrainingView& view, const RasterSettings& raster);

 private:
  const GaussianModel& model_;
  int channels_;
  size_t padded_;
  ThreadPool& pool_;
  ProjectedView projected_;
  TileLists lists_;
  std::vector<TileScratch> scratch_;
  RowBatches batches_;
  AlignedArray<float> sums_;      // [N][padded]
  std::vector<uint8_t> written_;  // [N]
  std::vector<float> votes_;      // [N][channels]
};

}  // namespace aligngs::cpu
