#include "priors/teacher_list.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/atomic_file.h"
#include "priors/scene_priors.h"

namespace aligngs {
namespace {

TEST(TeacherList, EveryWordIsOneModelOfTheRegistry) {
  for (const auto* teachers : {&semantic_teachers(), &depth_teachers()}) {
    std::set<std::string> words;
    for (const TeacherWord& teacher : *teachers) {
      EXPECT_TRUE(words.insert(teacher.word).second) << teacher.word << " is there twice";
      EXPECT_EQ(published_model(teacher.model).name, teacher.model);
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

TEST(CameraTeachers, EveryNetworkIsPublishedAndThoseWithTermsComeLast) {
  bool terms = false;
  for (const CameraTeacher& teacher : camera_teachers()) {
    const ModelLicence& licence = published_model(teacher.model).licence;
    const bool free = licence.commercial && licence.question.empty();
    EXPECT_FALSE(terms && free) << teacher.model << " comes after a network with terms";
    terms = terms || !free;
    EXPECT_FALSE(teacher.reason.empty()) << teacher.model;
  }
  EXPECT_TRUE(terms);
}

TEST(CameraTeachers, TheManualNamesEveryMethodAndNetwork) {
  const std::string manual = read_file(std::string(ALIGNGS_SOURCE_DIR) + "/docs/photos.md");
  for (const std::string& method : camera_network_methods())
    EXPECT_NE(manual.find("| `" + method + "` |"), std::string::npos) << method;
  for (const CameraTeacher& teacher : camera_teachers()) {
    const bool named = manual.find("`" + teacher.model + "`") != std::string::npos ||
                       manual.find("`--poses-model " + teacher.model + "`") != std::string::npos;
    EXPECT_TRUE(named) << teacher.model;
  }
}

TEST(CameraTeachers, EveryMethodHasOneDefault) {
  EXPECT_EQ(camera_network_methods(), (std::vector<std::string>{"vggt", "da3"}));
  for (const std::string& method : camera_network_methods()) {
    int defaults = 0;
    for (const CameraTeacher& teacher : camera_teachers())
      defaults += teacher.method == method && teacher.method_default;
    EXPECT_EQ(defaults, 1) << method;
    EXPECT_EQ(default_camera_teacher(method).method, method);
  }
  EXPECT_THROW(default_camera_teacher("colmap"), Error);
}

}  // namespace
}  // namespace aligngs
