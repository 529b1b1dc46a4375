#include "edit/edit_operation.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

TEST(EditsFile, WhatIsWrittenReadsBack) {
  EditOperation remove;
  remove.select = "pillow#2";
  remove.fill = true;
  EditOperation recolor;
  recolor.kind = EditKind::kRecolor;
  recolor.select = "everything but wall";
  recolor.color = {173, 216, 230};
  recolor.threshold = {ThresholdRule::Kind::kValue, 0.25};
  recolor.number = 4;
  recolor.change = "0004-0123456789abcdef.edit";
  const std::string text = edits_text({remove, recolor});
  const std::vector<EditOperation> back = parse_edits(text, "edits.json");
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(describe(back[0]), "delete pillow#2, hole filled");
  EXPECT_EQ(describe(back[1]), "recolor everything but wall to #add8e6 (threshold 0.25)");
  EXPECT_EQ(back[1].change, recolor.change);
  EXPECT_EQ(edits_text(back), text);
}

TEST(EditsFile, AReplacementReadsBack) {
  EditOperation replace;
  replace.kind = EditKind::kReplace;
  replace.select = "armchair";
  replace.with = "other_run#sofa#1";
  replace.fit = true;
  replace.up_axis = UpAxis::kMinusY;
  replace.motion.turn = 45;
  const std::vector<EditOperation> back = parse_edits(edits_text({replace}), "edits.json");
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(describe(back[0]), describe(replace));
}

TEST(EditsFile, AnAbsentFileIsAnEmptyStack) { EXPECT_TRUE(read_edits("/nonexistent/edits.json").empty()); }

TEST(EditsFile, MalformedFilesAreRefusedByName) {
  const auto entry = [](const std::string& text) { return R"({"schema": 1, "edits": [)" + text + "]}"; };
  const std::string bad[] = {
      "",
      "[]",
      "{",
      "nonsense",
      R"({"schema": 3, "edits": []})",
      R"({"edits": []})",
      R"({"schema": 1})",
      R"({"schema": 1, "edits": {}})",
      entry("1"),
      entry(R"({"operation": "explode", "select": "pillow"})"),
      entry(R"({"operation": "delete"})"),
      entry(R"({"operation": "delete", "select": 3})"),
      entry(R"({"operation": "delete", "select": "a", "fill": "yes"})"),
      entry(R"({"operation": "recolor", "select": "a"})"),
      entry(R"({"operation": "replace", "select": "a", "up": "z"})"),
      entry(R"({"operation": "replace", "select": "a", "with": "b.ply"})"),
      entry(R"({"operation": "replace", "select": "a", "with": "b.ply", "up": "north"})"),
      entry(R"({"operation": "recolor", "select": "a", "color": "blue"})"),
      entry(R"({"operation": "delete", "select": "a", "threshold": "2"})"),
      entry(R"({"operation": "delete", "select": ")" + std::string(5000, 'a') + "\"}"),
      entry(R"({"operation": "delete", "select": "a", "number": 0})"),
      entry(R"({"operation": "delete", "select": "a", "number": 1, "change": "../../etc/passwd"})"),
      entry(R"({"operation": "delete", "select": "a", "change": "0001-0123456789abcdef.edit"})"),
      entry(
          R"({"operation": "delete", "select": "a", "number": 2}, {"operation": "delete", "select": "a", "number": 2})"),
      std::string(100000, '['),
      R"({"schema": 1e400, "edits": []})"};
  for (const std::string& text : bad) {
    try {
      parse_edits(text, "edits.json");
      ADD_FAILURE() << "accepted: " << text.substr(0, 80);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      EXPECT_THAT(error.what(), HasSubstr("edits.json"));
    }
  }
}

TEST(EditsFile, TheMessageNamesEntryAndField) {
  try {
    parse_edits(R"({"schema": 1, "edits": [{"operation": "delete", "select": "a"}, {"operation": "delete"}]})",
                "edits.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.details().field, "edits[1].select");
  }
}

TEST(EditColor, HexOfThreeOrSixDigits) {
  EXPECT_EQ(color_text(parse_color("#ADD8e6")), "#add8e6");
  EXPECT_EQ(color_text(parse_color("#fa0")), "#ffaa00");
  for (const char* bad : {"", "#", "red", "#12", "#12345", "#gggggg", "123456", "#1234567"})
    EXPECT_THROW(parse_color(bad), Error) << bad;
}

}  // namespace
}  // namespace aligngs
