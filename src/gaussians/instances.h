// Objects: connected groups of Gaussians of one class.
#pragma once

#include <cstdint>
#include <vector>

#include "core/thread_pool.h"
#include "gaussians/gaussian_model.h"
#include "gaussians/gaussian_ply.h"

namespace aligngs {

struct Instance {
  int label = 0;   ///< class number
  int number = 0;  ///< within its class: 1 is the largest
  size_t gaussians = 0;
  Vec3f centre;     ///< mean position, world
  Vec3f low, high;  ///< box of the positions, world
};

/// DBSCAN (Ester et al. 1996) over the Gaussians of each class. The link distance follows the spacing of the class's
/// own Gaussians. A coarse floor is hence one object, and two pillows side by side are two.
struct InstanceOptions {
  int core_neighbours = 6;                   ///< of the same class within the link distance: inside of an object
  double link_spacings = 2.5;                ///< link distance / median distance of the core_neighbours-th neighbour
  double link_min = 0.005, link_max = 0.03;  ///< limits of the link distance / extent: 1.5 to 10 cm in a room
  double min_share = 0.03;  ///< smaller groups than this share of the class's largest are crumbs, not objects
  size_t min_gaussians = 8;
  double min_opacity = 0.1;  ///< fainter Gaussians connect nothing
};

/// Fills labels.instance: 1, 2, ... per class, most Gaussians first (then the smaller first row); 0 = no label or
/// a crumb. Returned by class, then by number. The same for any number of threads.
std::vector<Instance> find_instances(const GaussianModel& model, GaussianLabels& labels, double extent,
                                     const InstanceOptions& options, ThreadPool& pool);

/// The table of instances of labels that have been filled before.
std::vector<Instance> list_instances(const GaussianModel& model, const GaussianLabels& labels);

}  // namespace aligngs
