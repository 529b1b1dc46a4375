#include "priors/teacher_list.h"

#include <gtest/gtest.h>

#include <set>

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

}  // namespace
}  // namespace aligngs
