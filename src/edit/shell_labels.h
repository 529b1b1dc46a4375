// Labels of walls, floor and ceiling, corrected by their planes.
#pragma once

#include <optional>

#include "core/thread_pool.h"
#include "edit/crumbs.h"
#include "edit/selection.h"
#include "scene/camera.h"
#include "scene/label_set.h"

namespace aligngs {

/// Lengths are shares of the extent, which is about 3 m in a room.
struct ShellLabelOptions {
  /// a Gaussian this far in front of its plane is not of the wall, floor or ceiling (5 cm): trained surfaces are thick
  double proud = 0.015;
  /// the same for one that is parallel to it (10 cm): walls bend a little, and lie before their plane in places
  double parallel = 0.03;
  double on_plane = 0.0075;  ///< one this near to another plane than its own is of that one (2.5 cm)
  double facing = 0.7;       ///< when its shortest axis and the plane's normal have this cosine
  double beyond = 0.1;       ///< planes end this far from their last Gaussian (30 cm)
  /// share of the Gaussians of walls in front of all walls, above which the planes do not describe the walls
  double most_proud = 0.4;
  double color_sigma = 0.2;  ///< sRGB (norm over 3 channels): the things that proud ones join have a like colour
  int reach = 16;            ///< neighbours from a thing inwards: 30 cm of a lamp's foot
};

/// A wall ends at its plane. Gaussians labelled wall in front of it join the thing that they touch, as the foot of a lamp
/// or the legs of a stool. The same for floor and ceiling. Gaussians of one plane with the
/// class of another one get the class of theirs. Crumbs (crumbs.h) join a thing, and walls only where they lie on one.
/// Other crumbs are left to join_crumbs(). Gaussians that touch no thing keep their labels, and numbers of objects do
/// not change.
///
/// `cameras` tell which side of a plane is inside; without them the middle of the Gaussians does. Without labels, or
/// without planes, nothing changes. Returns how many Gaussians have another label or object. The same for any number
/// of threads. `tree` is that of the room.
size_t correct_shell_labels(LabelledGaussians& room, const LabelSet& labels, const std::vector<Camera>& cameras,
                            ThreadPool& pool, RoomTree& tree, const ShellLabelOptions& options = {});

}  // namespace aligngs
