// Class probabilities smoothed over neighbouring Gaussians.
#pragma once

#include <memory>
#include <vector>

#include "core/thread_pool.h"
#include "gaussians/gaussian_model.h"
#include "gaussians/placed_neighbours.h"
#include "gaussians/soft_labels.h"

namespace aligngs {

struct SmoothingOptions {
  size_t neighbours = 16;  ///< the ring around a Gaussian on a surface, and the next one
  int rounds = 3;
  double color_sigma = 0.12;       ///< sRGB difference (norm over 3 channels) of unlike things
  double distance_quantile = 0.5;  ///< the bandwidth is the distance of this share of the neighbours
  double own_weight = 1;           ///< of the Gaussian's own probabilities, next to about k of the neighbours
  double reach = 0.02;             ///< neighbours farther than this share of the extent say nothing
};

/// Neighbouring Gaussians of similar colour are parts of one object. Each takes the mean of its neighbours'
/// probabilities, weighted by opacity, distance and similarity of colour (bilateral filter; Tomasi and Manduchi 1998).
/// This settles Gaussians at object borders and inside of objects, which few pixels taught.
///
/// Neighbours and weights follow from shapes and colours alone: one smoother serves all labels of the same Gaussians.
class LabelSmoother {
 public:
  /// `extent` is that of the scene, scene units; 0: measured on the model. The same for any number of threads. `known`
  /// saves the search for neighbours where it has those of the model.
  LabelSmoother(const GaussianModel& model, double extent, ThreadPool& pool, const SmoothingOptions& options = {},
                const PlacedNeighbours& known = {});

  /// soft_labels() of the model's semantic rows, smoothed. Positions, colours and opacities are those of the
  /// constructor's model.
  SoftLabels smoothed(const GaussianModel& model, ThreadPool& pool) const;

  const NeighbourGraph& graph() const { return *graph_; }
  const std::shared_ptr<const NeighbourGraph>& shared_graph() const { return graph_; }

 private:
  void smooth_once(SoftLabels& soft, ThreadPool& pool) const;

  SmoothingOptions options_;
  std::shared_ptr<const NeighbourGraph> graph_;
  std::vector<float> opacity_;
  std::vector<double> weight_;  ///< [N][k]; negative from the first neighbour that is out of reach
};

}  // namespace aligngs
