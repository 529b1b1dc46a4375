#include "priors/teacher_list.h"

#include <algorithm>

#include "core/error.h"
#include "priors/scene_priors.h"

namespace aligngs {
namespace {

const PublishedModel& model_of_word(const std::vector<TeacherWord>& teachers, const std::string& word) {
  for (const TeacherWord& teacher : teachers) {
    if (teacher.word == word) return published_model(teacher.model);
  }
  throw_usage("\"" + word + "\" is no network that aligngs knows", "see `aligngs priors --help` for the names");
}

std::vector<std::string> automatic_words(const std::vector<TeacherWord>& teachers) {
  std::vector<std::string> words;
  for (const TeacherWord& teacher : teachers) {
    if (teacher.automatic) words.push_back(teacher.word);
  }
  return words;
}

const PublishedModel* first_installed(const std::vector<TeacherWord>& teachers, const ModelStore& store) {
  for (const TeacherWord& teacher : teachers) {
    if (!teacher.automatic) continue;
    if (const PublishedModel& model = published_model(teacher.model); store.installed(model)) return &model;
  }
  return nullptr;
}

}  // namespace

const std::vector<TeacherWord>& semantic_teachers() {
  static const std::vector<TeacherWord> teachers = {{"m2f", "ade20k-m2f", true},
                                                    {"eomt-l", "eomt-l", true},
                                                    {"eomt-panoptic", "eomt-l-panoptic", true},
                                                    {"ms-g", "ade20k-ms-g", true},
                                                    {"linear-g", "ade20k-linear-g", true},
                                                    {"ms-l", "ade20k-ms-l", true},
                                                    {"linear-l", "ade20k-linear-l", true},
                                                    {"ms-b", "ade20k-ms-b", true},
                                                    {"linear-b", "ade20k-linear-b", true},
                                                    {"lingbot-s", "lingbot-s", true},
                                                    {"ms-s", "ade20k-ms-s", true},
                                                    {"linear-s", "ade20k-linear-s", true},
                                                    {"eomt-l-panoptic", "eomt-l-panoptic", false},
                                                    {"ms", "ade20k-ms-s", false},
                                                    {"linear", "ade20k-linear-s", false}};
  return teachers;
}

const std::vector<TeacherWord>& depth_teachers() {
  static const std::vector<TeacherWord> teachers = {{"vggt-commercial", "vggt-1b-commercial", true},
                                                    {"da3-base", "da3-base", true},
                                                    {"da3-small", "da3-small", true},
                                                    {"dpt-g", "nyu-dpt-g", true},
                                                    {"linear-g", "nyu-linear4-g", true},
                                                    {"dpt-l", "nyu-dpt-l", true},
                                                    {"linear-l", "nyu-linear4-l", true},
                                                    {"dpt-b", "nyu-dpt-b", true},
                                                    {"linear-b", "nyu-linear4-b", true},
                                                    {"dpt-s", "nyu-dpt-s", true},
                                                    {"linear-s", "nyu-linear4-s", true},
                                                    {"vggt", "vggt-1b", true},
                                                    {"da3", "da3-base", false},
                                                    {"da3-large", "da3-large", false},
                                                    {"da3-giant", "da3-giant", false},
                                                    {"dpt", "nyu-dpt-s", false},
                                                    {"linear", "nyu-linear4-s", false}};
  return teachers;
}

// AUC at 30 degrees: mean over 19 data sets, by the publishers of the benchmark. The commercial weights are of the same
// network as VGGT-1B; their own figure is not published.
const std::vector<CameraTeacher>& camera_teachers() {
  const auto row = [](const char* model, const char* method, const char* reason, bool method_default = false) {
    return CameraTeacher{{model, model, true}, method, reason, method_default};
  };
  static const std::vector<CameraTeacher> teachers = {
      row("vggt-1b-commercial", "vggt", "the most accurate cameras (pose AUC 0.70) with commercial use allowed"),
      row("da3-base", "da3", "free to use, pose AUC 0.57 with a ninth of the arithmetic", true),
      row("da3-small", "da3", "free to use, pose AUC 0.48, the smallest"),
      row("lingbot-map", "vggt", "no published accuracy, and its provenance is an open question"),
      row("vggt-1b", "vggt", "pose AUC 0.70, non-commercial use only", true),
      row("da3-giant", "da3", "non-commercial use only"),
      row("da3-large", "da3", "non-commercial use only"),
  };
  return teachers;
}

const CameraTeacher* find_camera_teacher(const std::string& model) {
  const auto& teachers = camera_teachers();
  const auto found = std::find_if(teachers.begin(), teachers.end(), [&](const auto& t) { return t.model == model; });
  return found == teachers.end() ? nullptr : &*found;
}

const std::vector<std::string>& camera_network_methods() {
  static const std::vector<std::string> methods = [] {
    std::vector<std::string> found;
    for (const CameraTeacher& teacher : camera_teachers()) {
      if (std::find(found.begin(), found.end(), teacher.method) == found.end()) found.push_back(teacher.method);
    }
    return found;
  }();
  return methods;
}

bool is_camera_network_method(const std::string& method) {
  const std::vector<std::string>& methods = camera_network_methods();
  return std::find(methods.begin(), methods.end(), method) != methods.end();
}

const CameraTeacher& default_camera_teacher(const std::string& method) {
  for (const CameraTeacher& teacher : camera_teachers()) {
    if (teacher.method == method && teacher.method_default) return teacher;
  }
  throw_usage("--method " + method + " is no network", "see `aligngs poses --help` for the methods");
}

const CameraTeacher* installed_camera_teacher(const ModelStore& store) {
  for (const CameraTeacher& teacher : camera_teachers()) {
    if (store.installed(published_model(teacher.model))) return &teacher;
  }
  return nullptr;
}

const PublishedModel& semantic_model(const std::string& choice) { return model_of_word(semantic_teachers(), choice); }
const PublishedModel& depth_model(const std::string& choice) { return model_of_word(depth_teachers(), choice); }

const std::vector<std::string>& semantic_choices() {
  static const std::vector<std::string> words = automatic_words(semantic_teachers());
  return words;
}
const std::vector<std::string>& depth_choices() {
  static const std::vector<std::string> words = automatic_words(depth_teachers());
  return words;
}

const PublishedModel* installed_semantic_model(const ModelStore& store) {
  return first_installed(semantic_teachers(), store);
}
const PublishedModel* installed_depth_model(const ModelStore& store) {
  return first_installed(depth_teachers(), store);
}

}  // namespace aligngs
