// Classes that people take for each other, so that a message can name what is there instead.
#pragma once

#include "scene/label_set.h"

namespace aligngs {

/// "Chair" and "armchair", "lamp" and "light": another name of the same kind of thing. A class is no kin of itself.
bool are_kin(const LabelSet& labels, int label, int other);

}  // namespace aligngs
