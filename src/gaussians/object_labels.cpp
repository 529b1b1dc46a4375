#include "gaussians/object_labels.h"

#include "core/error.h"
#include "gaussians/instances.h"

namespace aligngs {
namespace {

constexpr size_t kSmoothingNeighbours = 16;  ///< the ring around a Gaussian on a surface, and the next one

}  // namespace

SoftLabels smoothed_labels(const GaussianModel& model, double extent, ThreadPool& pool) {
  SoftLabels soft = soft_labels(model, pool);
  const NeighbourGraph graph = neighbour_graph(positions_of(model), kSmoothingNeighbours, pool);
  smooth_labels(soft, model, graph, extent > 0 ? extent : extent_of(model), {}, pool);
  return soft;
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
