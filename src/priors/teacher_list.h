// The networks that commands know by a word, as one list each for cameras, depth and classes. Words, the order of "auto",
// the help, `aligngs doctor` and the messages follow from it.
#pragma once

#include <string>
#include <vector>

#include "priors/model_registry.h"
#include "priors/model_store.h"

namespace aligngs {

struct TeacherWord {
  std::string word;   ///< as a person says it
  std::string model;  ///< of the registry
  bool automatic;     ///< "auto" tries it, and the help names it; the others are short forms and large networks
};

/// A network that finds cameras; its word is the name of its weights.
struct CameraTeacher : TeacherWord {
  std::string method;           ///< "--method" that runs it
  std::string reason;           ///< for its place in the order, one line
  bool method_default = false;  ///< the method takes it where no weights are named
};

/// In the order in which "auto" prefers them: whole networks first, then heads from large to small backbones. The head
/// that reads more layers of one backbone is first. Networks for non-commercial use come last.
const std::vector<TeacherWord>& semantic_teachers();
const std::vector<TeacherWord>& depth_teachers();
/// Accuracy of the poses decides among those that anyone may use. Those with terms that not everyone can accept come
/// after them.
const std::vector<CameraTeacher>& camera_teachers();

/// Null without one of that model.
const CameraTeacher* find_camera_teacher(const std::string& model);
/// The methods that are networks, each once, in the order of their first networks.
const std::vector<std::string>& camera_network_methods();
/// Whether "--method" is that of a network in the list.
bool is_camera_network_method(const std::string& method);
/// The weights that a method takes where none are named. Error{kUsage} for another method.
const CameraTeacher& default_camera_teacher(const std::string& method);

/// The first that is installed; null: none. One that is not free to use in every way is taken only where no other is
/// installed.
const CameraTeacher* installed_camera_teacher(const ModelStore& store);

}  // namespace aligngs
