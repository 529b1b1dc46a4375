#include "priors/teacher_list.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "priors/camera_teacher.h"
#include "priors/depth_teacher.h"
#include "priors/model_sets.h"
#include "priors/semantic_teacher.h"

namespace aligngs {
namespace {

constexpr const char* kIsLight = "is light";

/// A network for cameras that brings depth as well.
Teacher whole(const char* model, const char* word, const DepthFamily& depth, const CameraRole& cameras,
              const char* short_form = "", bool automatic = true) {
  return {.model = model,
          .word = word,
          .short_form = short_form,
          .automatic = automatic,
          .depth = &depth,
          .cameras = cameras};
}

Teacher depth_head(const char* model, const char* word, const char* short_form = "") {
  return {.model = model, .word = word, .short_form = short_form, .depth = &kDepthHeads};
}

Teacher classes(const char* model, const char* word, const SemanticFamily& family, const char* note = "",
                const char* short_form = "") {
  return {.model = model, .word = word, .short_form = short_form, .note = note, .classes = &family};
}

// AUC at 30 degrees: mean over 19 data sets, by the publishers of the benchmark. The commercial weights are of the same
// network as VGGT-1B; their own figure is not published.
std::vector<Teacher> make_teachers() {
  std::vector<Teacher> rows = {
      whole("vggt-1b-commercial", "vggt-commercial", kVggtDepth,
            {&kVggtCameras, "the most accurate cameras (pose AUC 0.70) with commercial use allowed"}),
      whole("da3-base", "da3-base", kDa3Depth,
            {&kDa3Cameras, "free to use, pose AUC 0.57 with a ninth of the arithmetic", true}, "da3"),
      whole("da3-small", "da3-small", kDa3Depth, {&kDa3Cameras, "free to use, pose AUC 0.48, the smallest"}),
      depth_head("nyu-dpt-g", "dpt-g"),
      depth_head("nyu-linear4-g", "linear-g"),
      depth_head("nyu-dpt-l", "dpt-l"),
      depth_head("nyu-linear4-l", "linear-l"),
      depth_head("nyu-dpt-b", "dpt-b"),
      depth_head("nyu-linear4-b", "linear-b"),
      depth_head("nyu-dpt-s", "dpt-s", "dpt"),
      depth_head("nyu-linear4-s", "linear-s", "linear"),
      whole("lingbot-map", "", kVggtDepth,
            {&kVggtCameras, "no published accuracy, and its provenance is an open question", false, true}),
      whole("vggt-1b", "vggt", kVggtDepth, {&kVggtCameras, "pose AUC 0.70, non-commercial use only", true}),
      whole("da3-giant", "da3-giant", kDa3Depth, {&kDa3Cameras, "non-commercial use only"}, "", false),
      whole("da3-large", "da3-large", kDa3Depth, {&kDa3Cameras, "non-commercial use only"}, "", false),
      classes("ade20k-m2f", "m2f", kMask2FormerClasses, "is the method's"),
      classes("eomt-l", "eomt-l", kEomtClasses),
      classes("eomt-l-panoptic", "eomt-panoptic", kPanopticClasses, "also makes segments", "eomt-l-panoptic"),
      classes("ade20k-ms-g", "ms-g", kMultiScaleClasses),
      classes("ade20k-linear-g", "linear-g", kLinearClasses),
      classes("ade20k-ms-l", "ms-l", kMultiScaleClasses),
      classes("ade20k-linear-l", "linear-l", kLinearClasses),
      classes("ade20k-ms-b", "ms-b", kMultiScaleClasses),
      classes("ade20k-linear-b", "linear-b", kLinearClasses, kIsLight),
      classes("lingbot-s", "lingbot-s", kLingbotClasses, kIsLight),
      classes("ade20k-ms-s", "ms-s", kMultiScaleClasses, "", "ms"),
      classes("ade20k-linear-s", "linear-s", kLinearClasses, kIsLight, "linear"),
  };
  rows.back().lighter = "give it more memory with --memory, or leave classes out: --semantics none";
  return rows;
}

template <class Wanted>
Teachers rows_where(Wanted wanted) {
  Teachers rows;
  for (const Teacher& teacher : teachers()) {
    if (wanted(teacher)) rows.push_back(&teacher);
  }
  return rows;
}

const Teacher& row_of_word(const Teachers& rows, const std::string& word) {
  for (const Teacher* teacher : rows) {
    if (!word.empty() && (word == teacher->word || word == teacher->short_form)) return *teacher;
  }
  throw_usage("\"" + word + "\" is no network that aligngs knows", "see `aligngs priors --help` for the names");
}

std::vector<std::string> automatic_words(const Teachers& rows) {
  std::vector<std::string> words;
  for (const Teacher* teacher : rows) {
    if (teacher->automatic) words.emplace_back(teacher->word);
  }
  return words;
}

const PublishedModel* first_installed(const Teachers& rows, const ModelStore& store) {
  for (const Teacher* teacher : rows) {
    if (!teacher->automatic) continue;
    if (const PublishedModel& model = published_model(teacher->model); store.installed(model)) return &model;
  }
  return nullptr;
}

PriorChoice prior_choice(const Teachers& rows, const std::string& word) {
  if (word == "auto") return {};
  if (word == "none") return {PriorChoice::Kind::kNone, nullptr};
  return {PriorChoice::Kind::kNetwork, &row_of_word(rows, word)};
}

}  // namespace

const std::vector<Teacher>& teachers() {
  static const std::vector<Teacher> rows = make_teachers();
  return rows;
}

const Teacher* find_teacher(const std::string& model) {
  const auto& rows = teachers();
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Teacher& row) { return row.model == model; });
  return found == rows.end() ? nullptr : &*found;
}

const Teachers& semantic_teachers() {
  static const Teachers rows = rows_where([](const Teacher& row) { return row.classes != nullptr; });
  return rows;
}
const Teachers& depth_teachers() {
  static const Teachers rows = rows_where([](const Teacher& row) { return row.depth && *row.word != '\0'; });
  return rows;
}
const Teachers& camera_teachers() {
  static const Teachers rows = rows_where([](const Teacher& row) { return row.cameras.family != nullptr; });
  return rows;
}

const Teacher& semantic_teacher(const std::string& word) { return row_of_word(semantic_teachers(), word); }
const Teacher& depth_teacher(const std::string& word) { return row_of_word(depth_teachers(), word); }
const PublishedModel& semantic_model(const std::string& word) { return published_model(semantic_teacher(word).model); }
const PublishedModel& depth_model(const std::string& word) { return published_model(depth_teacher(word).model); }

const std::vector<std::string>& semantic_choices() {
  static const std::vector<std::string> words = automatic_words(semantic_teachers());
  return words;
}
const std::vector<std::string>& depth_choices() {
  static const std::vector<std::string> words = automatic_words(depth_teachers());
  return words;
}

std::string notes_in_help(const Teachers& rows) {
  std::string notes;
  for (const Teacher* teacher : rows) {
    if (*teacher->note == '\0') continue;
    notes += fmt::format("{}{} {}", notes.empty() ? "" : ", ", teacher->word, teacher->note);
  }
  return notes;
}

const PublishedModel* installed_semantic_model(const ModelStore& store) {
  return first_installed(semantic_teachers(), store);
}
const PublishedModel* installed_depth_model(const ModelStore& store) {
  return first_installed(depth_teachers(), store);
}
const Teacher* installed_camera_teacher(const ModelStore& store) {
  for (const Teacher* teacher : camera_teachers()) {
    if (store.installed(published_model(teacher->model))) return teacher;
  }
  return nullptr;
}

std::vector<const PublishedModel*> suggested_semantic_models() {
  std::vector<const PublishedModel*> found;
  for (const char* set : {"recommended", "light"}) {
    for (const std::string& model : find_model_set(set)->models) {
      const Teacher* const row = find_teacher(model);
      if (row && row->classes) found.push_back(&published_model(model));
    }
  }
  return found;
}

PriorChoice semantic_choice(const std::string& word) { return prior_choice(semantic_teachers(), word); }
PriorChoice depth_choice(const std::string& word) { return prior_choice(depth_teachers(), word); }

const Teacher* find_camera_teacher(const std::string& model) {
  const Teacher* const row = find_teacher(model);
  return row && row->cameras.family ? row : nullptr;
}

PosesMethod method_of(const Teacher& camera_teacher) { return camera_teacher.cameras.family->method; }

const std::vector<PosesMethod>& camera_network_methods() {
  static const std::vector<PosesMethod> methods = [] {
    std::vector<PosesMethod> found;
    for (const Teacher* teacher : camera_teachers()) {
      if (std::find(found.begin(), found.end(), method_of(*teacher)) == found.end())
        found.push_back(method_of(*teacher));
    }
    return found;
  }();
  return methods;
}

std::string camera_method_words(const char* between) {
  std::string words;
  for (const PosesMethod method : camera_network_methods())
    words += (words.empty() ? "" : between) + std::string(word_of(method));
  return words;
}

bool is_camera_network_method(PosesMethod method) {
  const std::vector<PosesMethod>& methods = camera_network_methods();
  return std::find(methods.begin(), methods.end(), method) != methods.end();
}

const Teacher& default_camera_teacher(PosesMethod method) {
  for (const Teacher* teacher : camera_teachers()) {
    if (method_of(*teacher) == method && teacher->cameras.method_default) return *teacher;
  }
  throw_usage("--method " + std::string(word_of(method)) + " is no network",
              "see `aligngs poses --help` for the methods");
}

}  // namespace aligngs
