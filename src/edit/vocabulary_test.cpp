#include "edit/vocabulary.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::Contains;
using testing::HasSubstr;

std::string name_of(const std::string& word) {
  const Vocabulary vocabulary(ade20k_labels());
  const auto label = vocabulary.find(word);
  return label ? ade20k_labels().classes[*label].name : "";
}

TEST(Vocabulary, EveryNameOfAde20kMeansItself) {
  const Vocabulary vocabulary(ade20k_labels());
  for (int i = 0; i < ade20k_labels().size(); ++i) EXPECT_EQ(vocabulary.find(ade20k_labels().classes[i].name), i);
}

TEST(Vocabulary, SynonymsAndEverydayWords) {
  EXPECT_EQ(name_of("couch"), "sofa");
  EXPECT_EQ(name_of("tv"), "television");
  EXPECT_EQ(name_of("fridge"), "refrigerator");
  EXPECT_EQ(name_of("window"), "windowpane");
  EXPECT_EQ(name_of("stool"), "stool") << "a name goes before the synonym of another class";
}

TEST(Vocabulary, CasePluralAndHyphensDoNotMatter) {
  EXPECT_EQ(name_of("  PILLOWS "), "pillow");
  EXPECT_EQ(name_of("Chests_of-Drawers"), "chest of drawers");
  EXPECT_EQ(name_of("shelves"), "shelf");
  EXPECT_EQ(name_of("boxes"), "box");
  EXPECT_EQ(name_of("glasses"), "glass");
  EXPECT_EQ(name_of("couches"), "sofa");
  EXPECT_EQ(name_of("stair"), "step") << "an exact word goes before the singular of another";
}

TEST(Vocabulary, ATypingErrorIsAnsweredWithSuggestions) {
  const Vocabulary vocabulary(ade20k_labels());
  EXPECT_THAT(vocabulary.suggestions("pilow"), Contains("pillow"));
  EXPECT_THAT(vocabulary.suggestions("cushoins"), Contains("cushion"));
  try {
    vocabulary.resolve("pilow");
    FAIL() << "a misspelt name must not be guessed";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    EXPECT_THAT(error.details().remedy, HasSubstr("did you mean \"pillow\""));
  }
}

TEST(Vocabulary, NonsenseHasNoSuggestion) {
  const Vocabulary vocabulary(ade20k_labels());
  EXPECT_TRUE(vocabulary.suggestions("qzxqzxqzx").empty());
  EXPECT_TRUE(vocabulary.suggestions("").empty());
  EXPECT_TRUE(vocabulary.suggestions(std::string(5000, 'a')).empty());
}

TEST(Vocabulary, AnyLabelSetWorks) {
  LabelSet labels;
  labels.name = "labels.csv";
  labels.classes = {{"Gadget", {"gizmo", "thing"}, {}}, {"washer and dryer", {}, {}}};
  const Vocabulary vocabulary(labels);
  EXPECT_EQ(vocabulary.find("gizmos"), 0);
  EXPECT_EQ(vocabulary.find("Washer and Dryer"), 1);
  EXPECT_FALSE(vocabulary.find("fridge"));
}

}  // namespace
}  // namespace aligngs
