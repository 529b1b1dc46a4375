#include "gaussians/object_labels.h"

#include "core/error.h"
#include "gaussians/instances.h"
#include "gaussians/label_smoothing.h"

namespace aligngs {
SoftLabels smoothed_labels(const GaussianModel& model, double extent, ThreadPool& pool, const PlacedNeighbours& known) {
  return LabelSmoother(model, extent, pool, {}, known).smoothed(model, pool);
}

ObjectLabels object_labels(const GaussianModel& model, const LabelSet& labels, double extent, ThreadPool& pool) {
  if (model.semantic_channels == 0) {
    throw_bad_input({}, "semantics", "this scene was trained without semantics, so that no object has a name",
                    "train a scene that has segmentation_logits/");
  }
  const double measured = extent > 0 ? extent : extent_of(model);
  ObjectLabels out;
  out.soft = smoothed_labels(model, measured, pool);
  out.labels = best_labels(out.soft, labels);
  find_instances(model, out.labels, measured, {}, pool);
  return out;
}

}  // namespace aligngs
