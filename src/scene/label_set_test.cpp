#include "scene/label_set.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"

namespace aligngs {
namespace {

std::filesystem::path write_csv(const std::string& name, const std::string& content) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "label_set_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name) << content;
  return folder / name;
}

std::string csv_message(const std::string& name, const std::string& content) {
  try {
    read_label_csv(write_csv(name, content));
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    return error.what();
  }
  return "";
}

TEST(LabelSet, Ade20kHasItsClassesInOrder) {
  const LabelSet& labels = ade20k_labels();
  ASSERT_EQ(labels.size(), 150);
  EXPECT_EQ(labels.classes[0].name, "wall");
  EXPECT_EQ(labels.classes[7].name, "bed");
  EXPECT_EQ(labels.classes[57].name, "pillow");
  EXPECT_EQ(labels.classes[149].name, "flag");
  EXPECT_EQ(labels.classes[3].color, (std::array<uint8_t, 3>{80, 50, 50}));
}

TEST(LabelSet, FindsNamesAndSynonymsWithoutRegardToCase) {
  const LabelSet& labels = ade20k_labels();
  EXPECT_EQ(labels.find("Floor"), 3);
  EXPECT_EQ(labels.find(" window "), labels.find("windowpane"));
  EXPECT_EQ(labels.find("couch"), labels.find("sofa"));
  EXPECT_EQ(labels.find("no such thing"), -1);
}

TEST(LabelSet, ANameWinsOverASynonymOfAnEarlierClass) {
  LabelSet labels;
  labels.classes = {{"chest", {"cabinet"}, {}}, {"cabinet", {}, {}}};
  EXPECT_EQ(labels.find("cabinet"), 1);
}

TEST(LabelSet, WrittenCsvReadsBackEqual) {
  LabelSet labels;
  labels.classes = {{"wall, bare", {"a \"plain\" wall", "partition"}, {1, 2, 3}}, {"floor", {}, {255, 0, 9}}};
  const std::filesystem::path path = write_csv("round.csv", "");
  write_label_csv(path, labels);
  const LabelSet back = read_label_csv(path);
  EXPECT_EQ(back.name, "round.csv");
  ASSERT_EQ(back.size(), 2);
  EXPECT_EQ(back.classes[0].name, "wall, bare");
  EXPECT_EQ(back.classes[0].synonyms, labels.classes[0].synonyms);
  EXPECT_EQ(back.classes[1].color, labels.classes[1].color);
}

TEST(LabelSet, ColumnsMayStandInAnyOrder) {
  const LabelSet labels =
      read_label_csv(write_csv("order.csv", "b,name,extra,g,index,r\r\n3,chair,x,2,1,1\r\n6,table,x,5,0,4\r\n"));
  ASSERT_EQ(labels.size(), 2);
  EXPECT_EQ(labels.classes[0].name, "table");
  EXPECT_EQ(labels.classes[1].color, (std::array<uint8_t, 3>{1, 2, 3}));
}

TEST(LabelSet, BadFilesNameLineAndColumn) {
  EXPECT_NE(csv_message("h.csv", "index,name\n").find("'r'"), std::string::npos);
  EXPECT_NE(csv_message("c.csv", "index,name,r,g,b\n0,wall,300,0,0\n").find("line 2, column r"), std::string::npos);
  EXPECT_NE(csv_message("d.csv", "index,name,r,g,b\n0,a,1,1,1\n0,b,1,1,1\n").find("twice"), std::string::npos);
  EXPECT_NE(csv_message("g.csv", "index,name,r,g,b\n0,a,1,1,1\n5,b,1,1,1\n").find("gaps"), std::string::npos);
  EXPECT_NE(csv_message("e.csv", "index,name,r,g,b\n").find("no class"), std::string::npos);
  EXPECT_NE(csv_message("n.csv", "index,name,r,g,b\n0,,1,1,1\n").find("without a name"), std::string::npos);
}

}  // namespace
}  // namespace aligngs
