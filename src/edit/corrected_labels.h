// All corrections of a trained room's labels, in their order.
#pragma once

#include <optional>
#include <vector>

#include "core/thread_pool.h"
#include "edit/selection.h"
#include "scene/camera.h"
#include "scene/label_set.h"

namespace aligngs {

struct LabelCorrections {
  std::vector<Camera> cameras;  ///< tell which side of a plane is inside the room
  std::optional<Vec3d> up;      ///< without it no pieces join
  bool part_things = true;      ///< cut things of one class that touch; false where segments have told them apart
};

/// Labels that leak are corrected by the room's planes (shell_labels.h), and rugs are completed (whole_rugs.h). Pieces
/// of one object join (object_pieces.h), and things that touch are parted (touching_objects.h). Crumbs join at last
/// (crumbs.h): before, they would bridge the waists of things that touch. Without labels nothing changes. The same for
/// any number of threads.
void correct_labels(LabelledGaussians& room, const LabelSet& labels, const LabelCorrections& corrections,
                    ThreadPool& pool);

}  // namespace aligngs
