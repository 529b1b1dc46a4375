// Semantic teachers that cannot inform, and one that knows: the controls of any claim that labels help geometry.
#pragma once

#include <string>
#include <vector>

#include "core/random.h"
#include "synth/teacher_semantic.h"

namespace aligngs {

enum class LabelTeacher {
  kTeacher,   ///< the teacher that goes with the geometry teacher: exact or simulated
  kTrue,      ///< oracle: the true labels
  kConstant,  ///< placebo: one class everywhere, as sure as the teacher is of its first class
  kShuffled   ///< placebo: the teacher's maps with the classes renamed at random, differently in every view
};
const char* label_teacher_name(LabelTeacher teacher);  ///< "teacher", "true", "constant", "shuffled"

/// Replaces the scores by those of a placebo, in place. kTeacher and kTrue change nothing.
void apply_label_control(LabelTeacher teacher, std::vector<ScoreMap>& scores, Random random);

}  // namespace aligngs
