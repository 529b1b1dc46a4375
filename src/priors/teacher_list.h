// The networks that teach, a row for each: the words that a person says, its place in the order of "auto", its design.
// Choices, help, `aligngs doctor` and messages follow from the rows.
#pragma once

#include <string>
#include <vector>

#include "priors/model_registry.h"
#include "priors/model_store.h"
#include "priors/poses_method.h"

namespace aligngs {

struct SemanticFamily;  // semantic_teacher.h: memory and maps of classes
struct DepthFamily;     // depth_teacher.h: scale, memory and maps of depth
struct CameraFamily;    // camera_teacher.h: method, memory and views with cameras

/// Facts of a network for cameras beside its design.
struct CameraRole {
  const CameraFamily* family = nullptr;  ///< null: it finds no cameras
  const char* reason = "";               ///< for its place in the order, one line
  bool method_default = false;           ///< "--method" takes it where no weights are named
  bool camera_to_world = false;          ///< its poses are camera to world, not world to camera
};

struct Teacher {
  const char* model;            ///< of the registry; also the word for cameras
  const char* word = "";        ///< of --depth or --semantics; empty: of neither
  const char* short_form = "";  ///< another such word
  bool automatic = true;        ///< "auto" tries that word, and the help names it
  const char* note = "";        ///< for the help: the end of a sentence that the word begins
  const char* lighter = "";     ///< remedy where memory is too small; empty: that of the design
  const SemanticFamily* classes = nullptr;
  const DepthFamily* depth = nullptr;
  CameraRole cameras = {};
};
using Teachers = std::vector<const Teacher*>;

/// In the order in which "auto" prefers them. Those that see all photos at once come first, then heads from large to
/// small backbones. The head that reads more layers of one backbone is first. Networks with terms that not everyone
/// can accept come after those that anyone may use. Among networks for cameras, accuracy of the poses decides.
const std::vector<Teacher>& teachers();

/// The row of a network of the registry; null: it has none.
const Teacher* find_teacher(const std::string& model);

/// The rows that "--semantics", "--depth" and "--poses-model" choose from.
const Teachers& semantic_teachers();
const Teachers& depth_teachers();
const Teachers& camera_teachers();

/// The row of a word, or of its short form. Error{kUsage} for another word.
const Teacher& semantic_teacher(const std::string& word);
const Teacher& depth_teacher(const std::string& word);
/// Their networks.
const PublishedModel& semantic_model(const std::string& word);
const PublishedModel& depth_model(const std::string& word);

/// The words that "auto" tries, in its order.
const std::vector<std::string>& semantic_choices();
const std::vector<std::string>& depth_choices();
/// Notes of such words, for the help: "m2f is ..., linear-s is ...".
std::string notes_in_help(const Teachers& rows);

/// The first of those that are installed; null: none.
const PublishedModel* installed_semantic_model(const ModelStore& store);
const PublishedModel* installed_depth_model(const ModelStore& store);
const Teacher* installed_camera_teacher(const ModelStore& store);

/// The networks for classes of the sets that most people download, best first.
std::vector<const PublishedModel*> suggested_semantic_models();

/// A prior that is asked for: a network by name, the first that is installed, or none.
struct PriorChoice {
  enum class Kind { kAuto, kNone, kNetwork };
  Kind kind = Kind::kAuto;
  const Teacher* network = nullptr;  ///< of kNetwork

  bool automatic() const { return kind == Kind::kAuto; }
  bool none() const { return kind == Kind::kNone; }
};
/// "auto", "none" or a word of the rows. Error{kUsage} for another word.
PriorChoice semantic_choice(const std::string& word);
PriorChoice depth_choice(const std::string& word);

/// Null without a network for cameras of that model.
const Teacher* find_camera_teacher(const std::string& model);
PosesMethod method_of(const Teacher& camera_teacher);
/// The methods that are networks, each once, in the order of their first networks.
const std::vector<PosesMethod>& camera_network_methods();
/// Their words with `between`: "vggt or da3".
std::string camera_method_words(const char* between);
/// Whether "--method" is that of a network in the list.
bool is_camera_network_method(PosesMethod method);
/// The weights that a method takes where none are named. Error{kUsage} for another method.
const Teacher& default_camera_teacher(PosesMethod method);

}  // namespace aligngs
