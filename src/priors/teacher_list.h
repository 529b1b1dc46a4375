// The networks that `aligngs priors` knows by a word, as one list each for depth and classes. Words, the order of
// "auto",
// the help and the messages follow from it.
#pragma once

#include <string>
#include <vector>

#include "priors/model_registry.h"

namespace aligngs {

struct TeacherWord {
  std::string word;   ///< as a person says it
  std::string model;  ///< of the registry
  bool automatic;     ///< "auto" tries it, and the help names it; the others are short forms and large networks
};

/// In the order in which "auto" prefers them: whole networks first, then heads from large to small backbones. The head
/// that reads more layers of one backbone is first. Networks for non-commercial use come last.
const std::vector<TeacherWord>& semantic_teachers();
const std::vector<TeacherWord>& depth_teachers();

}  // namespace aligngs
