#include "priors/teacher_list.h"

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
                                                    {"eomt-l-panoptic", "eomt-l-panoptic", true},
                                                    {"ms-g", "ade20k-ms-g", true},
                                                    {"linear-g", "ade20k-linear-g", true},
                                                    {"ms-l", "ade20k-ms-l", true},
                                                    {"linear-l", "ade20k-linear-l", true},
                                                    {"ms-b", "ade20k-ms-b", true},
                                                    {"linear-b", "ade20k-linear-b", true},
                                                    {"lingbot-s", "lingbot-s", true},
                                                    {"ms-s", "ade20k-ms-s", true},
                                                    {"linear-s", "ade20k-linear-s", true},
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
