// Objects of one class that touch, such as pillows side by side or books on the boards of a bookcase, become several.
#pragma once

#include <cstddef>
#include <optional>

#include "core/thread_pool.h"
#include "edit/selection.h"
#include "scene/label_set.h"

namespace aligngs {

struct TouchingObjectSettings {
  /// links of Gaussians that a plane cuts, relative to the most that a parallel plane cuts on either side
  double waist = 0.15;
  double share = 0.15;         ///< of an object's Gaussians, that each part has at least
  size_t fewest = 25;          ///< Gaussians of a part: fewer say nothing about a waist
  int neighbours = 12;         ///< that a Gaussian is linked to
  int spacing_neighbour = 6;   ///< links fade with the median distance to this neighbour
  int directions = 48;         ///< of planes, evenly over all directions; the upright one comes on top
  double least_opacity = 0.1;  ///< fainter Gaussians link nothing; they go with the part on their side of the plane
  size_t most_parts = 32;      ///< of one object
};

/// An object is cut by the plane where it has its narrowest waist, and its parts are cut again, until nothing has a
/// waist. Only things are cut that lie together in heaps and rows, and are compact themselves: pillows, cushions, books, boxes,
/// bottles and vases. Furniture has waists of its own. The larger part keeps the number; the other one gets the next
/// free number of the class. `up`: planes across it are tried, too. Returns how many objects are new. The same for any
/// number of threads.
size_t split_touching_objects(LabelledGaussians& room, const LabelSet& labels, const std::optional<Vec3d>& up,
                              ThreadPool& pool, const TouchingObjectSettings& settings = {});

}  // namespace aligngs
