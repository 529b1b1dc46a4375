#include "edit/corrected_labels.h"

#include "edit/crumbs.h"
#include "edit/object_pieces.h"
#include "edit/shell_labels.h"
#include "edit/touching_objects.h"
#include "edit/whole_rugs.h"

namespace aligngs {

void correct_labels(LabelledGaussians& room, const LabelSet& labels, const LabelCorrections& corrections,
                    ThreadPool& pool) {
  RoomTree tree(room.model);
  correct_shell_labels(room, labels, corrections.cameras, pool, tree);
  complete_rugs(room, labels, corrections.cameras);
  join_object_pieces(room, labels, corrections.up);
  if (corrections.part_things) split_touching_objects(room, labels, corrections.up, pool);
  join_crumbs(room, {}, pool, &tree);
}

}  // namespace aligngs
