#include "edit/vocabulary.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "edit/class_synonyms.h"

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
  EXPECT_EQ(name_of("children"), "person");
  EXPECT_EQ(name_of("women"), "person");
  EXPECT_EQ(name_of("stair"), "step") << "an exact word goes before the singular of another";
}

TEST(Vocabulary, BlanksWithinANameDoNotMatter) {
  EXPECT_EQ(name_of("barstools"), "stool");
  EXPECT_EQ(name_of("lamp shade"), "lamp");
  EXPECT_EQ(name_of("arm chair"), "armchair");
  EXPECT_EQ(name_of("trashcan"), "ashcan");
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

TEST(Vocabulary, EveryClassHasFiveWordsBesidesItsName) {
  const Vocabulary vocabulary(ade20k_labels());
  ASSERT_EQ(everyday_synonyms().size(), 150u);
  for (const ClassSynonyms& entry : everyday_synonyms()) {
    size_t words = 0;
    for (size_t begin = 0; begin < entry.words.size(); ++words) {
      const size_t end = std::min(entry.words.find(';', begin), entry.words.size());
      const std::string word(entry.words.substr(begin, end - begin));
      EXPECT_EQ(name_of(word), entry.name) << word;
      begin = end + 1;
    }
    EXPECT_GE(words, 5u) << entry.name;
  }
}

TEST(Vocabulary, WhatTheRoomHoldsIsSuggestedFirst) {
  Vocabulary vocabulary(ade20k_labels());
  const auto label = [](const char* name) { return ade20k_labels().find(name); };
  EXPECT_EQ(vocabulary.suggestions("lampe").front(), "lamp");
  vocabulary.prefer({label("bed"), label("sofa"), label("rug")});
  EXPECT_THAT(vocabulary.suggestions("qzxqzxqzx"), testing::SizeIs(3)) << "the nearest of what can be meant";
  EXPECT_EQ(vocabulary.suggestions("rig").front(), "rug");
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
