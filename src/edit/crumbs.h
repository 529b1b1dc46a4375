// Crumbs: groups of Gaussians too small to be a thing that a person would name.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/thread_pool.h"
#include "edit/selection.h"
#include "gaussians/point_tree.h"

namespace aligngs {

struct CrumbOptions {
  size_t fewest = 12;    ///< Gaussians: a smaller object is a crumb
  size_t few = 30;       ///< Gaussians: a smaller object is a crumb when its box is small, too
  double small = 0.03;   ///< / extent: diagonal of a small box (9 cm in a room)
  int neighbours = 16;   ///< that vote on the object a crumb joins
  double own_class = 2;  ///< weight of the votes of its own class
  /// share of all its neighbours' votes that an object of another class needs. Crumbs of a wall lie among their like.
  double majority = 0.5;
  /// sRGB difference (norm over 3 channels) beyond which a neighbour hardly counts; 0: colours say nothing
  double color_sigma = 0;
  int rounds = 0;  ///< most steps from the outside of a group inwards; 0: until nothing changes
};

/// A tree over the Gaussians of a room, made when it is first asked for. Several calls may share it.
class RoomTree {
 public:
  /// `model` outlives this, and its Gaussians stay in place.
  explicit RoomTree(const GaussianModel& model) : model_(model) {}
  const PointTree& tree();

 private:
  const GaussianModel& model_;
  std::optional<PointTree> tree_;
};

/// Whether a row may get a class.
using MayJoin = std::function<bool(uint32_t row, uint16_t label)>;

/// Crumbs are objects that are too small, and Gaussians with a class and no object. They get the class and the object
/// of most of their neighbours, by opacity. Crumbs stay that have no neighbour with an object, or no majority for
/// another class. Numbers of other objects do not change. Returns how many Gaussians have joined another object.
size_t join_crumbs(LabelledGaussians& room, const CrumbOptions& options, ThreadPool& pool, RoomTree* tree = nullptr);

/// 1 for the rows of crumbs.
std::vector<uint8_t> crumb_rows(const LabelledGaussians& room, const CrumbOptions& options);

/// The same for given Gaussians, e.g. what is left of a deleted object: `rows` marks them.
size_t join_neighbours(LabelledGaussians& room, const std::vector<uint8_t>& rows, const CrumbOptions& options,
                       ThreadPool& pool, const MayJoin& may_join = {}, RoomTree* tree = nullptr);

}  // namespace aligngs
