// Semantic rows as labels are drawn with them: what a Gaussian is, not how sure its photos were.
#pragma once

#include "core/thread_pool.h"
#include "gaussians/gaussian_model.h"
#include "gaussians/soft_labels.h"

namespace aligngs {

/// Replaces each row by the logarithms of its probabilities, smoothed over its neighbours (soft_labels.h) and raised to
/// `sharpness` > 0. Several Gaussians decide a pixel's label. Without this, the many uncertain ones around a lamp or a
/// plant outvote the few that are the lamp. Rows that no pixel taught stay without class. For rows whose softmax is
/// blended (SemanticBlend::kProbabilities). `extent` as for object_labels(). The same for any number of threads.
void sharpen_label_rows(GaussianModel& model, double extent, double sharpness, ThreadPool& pool);
/// The same with smoothed_labels() of the model, for whoever has them.
void sharpen_label_rows(GaussianModel& model, const SoftLabels& soft, double sharpness, ThreadPool& pool);

}  // namespace aligngs
