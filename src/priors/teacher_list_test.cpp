#include "priors/teacher_list.h"

#include <gmock/gmock.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/atomic_file.h"
#include "priors/camera_teacher.h"
#include "priors/depth_teacher.h"
#include "priors/semantic_teacher.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

std::string photos_manual() { return read_file(std::string(ALIGNGS_SOURCE_DIR) + "/docs/photos.md"); }

/// The words in code quotes that begin the rows of a table of the manual, each with the rest of its row.
std::map<std::string, std::string> words_of_table(const std::string& head) {
  const std::string manual = photos_manual();
  std::map<std::string, std::string> words;
  size_t line = manual.find("| `" + head + "` |");
  EXPECT_NE(line, std::string::npos) << head;
  for (int row = 0; line != std::string::npos && manual[line] == '|'; ++row) {
    const size_t end = manual.find('\n', line), cell = manual.find('|', line + 1);
    for (size_t open = manual.find('`', line); row >= 2 && open < cell; open = manual.find('`', open)) {
      const size_t close = manual.find('`', open + 1);
      words[manual.substr(open + 1, close - open - 1)] = manual.substr(cell, end - cell);
      open = close + 1;
    }
    line = end + 1;
  }
  return words;
}

std::set<std::string> words_of(const Teachers& rows) {
  std::set<std::string> words;
  for (const Teacher* teacher : rows) words.insert(teacher->word);
  return words;
}

std::set<std::string> keys_of(const std::map<std::string, std::string>& table) {
  std::set<std::string> keys;
  for (const auto& [word, rest] : table) keys.insert(word);
  return keys;
}

TEST(TeacherList, EveryRowIsOneModelOfTheRegistry) {
  std::set<std::string> models;
  for (const Teacher& teacher : teachers()) {
    EXPECT_TRUE(models.insert(teacher.model).second) << teacher.model << " is there twice";
    EXPECT_EQ(published_model(teacher.model).name, teacher.model);
    EXPECT_TRUE(teacher.classes || teacher.depth || teacher.cameras.family) << teacher.model << " teaches nothing";
  }
}

TEST(TeacherList, EveryWordOfAnOptionIsThereOnce) {
  for (const Teachers* rows : {&semantic_teachers(), &depth_teachers()}) {
    std::set<std::string> words;
    for (const Teacher* teacher : *rows) {
      EXPECT_TRUE(words.insert(teacher->word).second) << teacher->word;
      if (*teacher->short_form != '\0') {
        EXPECT_TRUE(words.insert(teacher->short_form).second) << teacher->short_form;
      }
    }
  }
}

TEST(TeacherList, ShortFormsAreTheSmallNetworks) {
  EXPECT_EQ(semantic_model("ms").name, semantic_model("ms-s").name);
  EXPECT_EQ(semantic_model("linear").name, semantic_model("linear-s").name);
  EXPECT_EQ(depth_model("dpt").name, depth_model("dpt-s").name);
  EXPECT_EQ(depth_model("da3").name, depth_model("da3-base").name);
}

TEST(TeacherList, NetworksForNonCommercialUseComeLast) {
  EXPECT_EQ(depth_choices().back(), "vggt");
  EXPECT_FALSE(depth_model("vggt").licence.commercial);
}

TEST(TeacherList, ADesignTellsWhatItsDepthMeans) {
  EXPECT_EQ(find_teacher("lingbot-map")->depth->scale, DepthScale::kOwn);
  EXPECT_EQ(depth_teacher("da3-small").depth->scale, DepthScale::kScene);
  EXPECT_EQ(depth_teacher("dpt-b").depth->scale, DepthScale::kMetres);
  EXPECT_EQ(depth_teacher("linear-b").depth->scale, DepthScale::kMetres);
}

TEST(TeacherList, AChoiceIsAutoNoneOrARow) {
  EXPECT_TRUE(depth_choice("auto").automatic());
  EXPECT_TRUE(semantic_choice("none").none());
  EXPECT_EQ(semantic_choice("ms").network, &semantic_teacher("ms-s"));
  EXPECT_THROW(depth_choice("m2f"), Error);
}

TEST(TeacherList, TheSuggestedNetworksForClassesAreThoseOfTheSets) {
  std::vector<std::string> names;
  for (const PublishedModel* model : suggested_semantic_models()) names.push_back(model->name);
  EXPECT_THAT(names, testing::ElementsAre("eomt-l", "lingbot-s"));
}

TEST(TeacherList, NetworksThatMakeSegmentsSaySoInTheHelp) {
  for (const Teacher* teacher : semantic_teachers()) {
    EXPECT_EQ(std::string(teacher->note).find("segments") != std::string::npos, teacher->classes->segments)
        << teacher->word;
  }
  EXPECT_THAT(notes_in_help(semantic_teachers()), HasSubstr("eomt-panoptic also makes segments"));
}

TEST(TeacherList, TheManualListsEveryWordForClasses) {
  EXPECT_EQ(keys_of(words_of_table("--semantics")), words_of(semantic_teachers()));
}

TEST(TeacherList, TheManualListsEveryWordForDepthAndWhatItGives) {
  const std::map<std::string, std::string> table = words_of_table("--depth");
  EXPECT_EQ(keys_of(table), words_of(depth_teachers()));
  for (const Teacher* teacher : depth_teachers()) {
    EXPECT_EQ(table.at(teacher->word), std::string("| ") + teacher->depth->gives + " |") << teacher->word;
  }
}

TEST(CameraTeachers, EveryNetworkIsPublishedAndThoseWithTermsComeLast) {
  bool terms = false;
  for (const Teacher* teacher : camera_teachers()) {
    const ModelLicence& licence = published_model(teacher->model).licence;
    const bool free = licence.commercial && licence.question.empty();
    EXPECT_FALSE(terms && free) << teacher->model << " comes after a network with terms";
    terms = terms || !free;
    EXPECT_STRNE(teacher->cameras.reason, "") << teacher->model;
  }
  EXPECT_TRUE(terms);
}

TEST(CameraTeachers, OnlyLingbotMapHasPosesOfCameraToWorld) {
  for (const Teacher* teacher : camera_teachers())
    EXPECT_EQ(teacher->cameras.camera_to_world, std::string(teacher->model) == "lingbot-map") << teacher->model;
}

TEST(CameraTeachers, TheManualNamesEveryMethodAndNetwork) {
  const std::string manual = photos_manual();
  for (const std::string& method : choice_list<PosesMethod>()) {
    const bool named = manual.find("| `" + method + "` |") != std::string::npos ||
                       manual.find("| `" + method + "` (default) |") != std::string::npos;
    EXPECT_TRUE(named) << method;
  }
  for (const Teacher* teacher : camera_teachers()) {
    const std::string model = teacher->model;
    const bool named = manual.find("`" + model + "`") != std::string::npos ||
                       manual.find("`--poses-model " + model + "`") != std::string::npos;
    EXPECT_TRUE(named) << model;
  }
}

TEST(CameraTeachers, EveryMethodHasOneDefault) {
  EXPECT_EQ(camera_network_methods(), (std::vector<PosesMethod>{PosesMethod::kVggt, PosesMethod::kDa3}));
  for (const PosesMethod method : camera_network_methods()) {
    int defaults = 0;
    for (const Teacher* teacher : camera_teachers())
      defaults += method_of(*teacher) == method && teacher->cameras.method_default;
    EXPECT_EQ(defaults, 1) << word_of(method);
    EXPECT_EQ(method_of(default_camera_teacher(method)), method);
  }
  EXPECT_THROW(default_camera_teacher(PosesMethod::kColmap), Error);
}

}  // namespace
}  // namespace aligngs
