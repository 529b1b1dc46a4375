#include "edit/absent_objects.h"

#include <gmock/gmock.h>

#include "edit/vocabulary.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class AbsentObjects : public testing::Test {
 protected:
  AbsentObjects() {
    for (const auto& [name, number] : {std::pair("wall", 1), {"bed", 1}, {"bed", 2}, {"armchair", 1}}) {
      Instance object;
      object.label = labels_.find(name);
      object.number = number;
      objects_.push_back(object);
    }
  }
  SelectionQuery query(const std::string& text) const { return parse_selection(text, Vocabulary(labels_)); }
  std::vector<std::string> absent(const std::string& text) const {
    return absent_names(objects_, query(text), labels_);
  }
  std::string instead(const std::string& text) const { return held_instead(objects_, query(text).include, labels_); }

  LabelSet labels_ = ade20k_labels();
  std::vector<Instance> objects_;
};

TEST_F(AbsentObjects, AreNamedOneByOne) {
  EXPECT_THAT(absent("bed#1-3, sofa, armchair"), ElementsAre("bed#3", "sofa"));
  EXPECT_THAT(absent("bed#1-9"), ElementsAre("bed#3-9"));
  EXPECT_THAT(absent("bed, wall"), IsEmpty());
}

TEST_F(AbsentObjects, CountAlsoAfterBut) { EXPECT_THAT(absent("every bed but bed#9"), ElementsAre("bed#9")); }

TEST_F(AbsentObjects, OtherNumbersOfTheClassAreHeldInstead) {
  EXPECT_THAT(instead("bed#9"), HasSubstr("it holds bed#1, bed#2;"));
}

TEST_F(AbsentObjects, ThenThingsOfItsKin) { EXPECT_THAT(instead("chair"), HasSubstr("it holds armchair#1;")); }

TEST_F(AbsentObjects, ThenAnything) {
  EXPECT_THAT(instead("vase"), HasSubstr("wall#1, bed#1, bed#2, armchair#1"));
  EXPECT_THAT(instead("vase"), Not(HasSubstr("more")));
}

}  // namespace
}  // namespace aligngs
