#include "edit/named_selection.h"

#include <gmock/gmock.h>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

NamedSelection corner() {
  NamedSelection s;
  s.name = "my corner";
  s.scene = 0x0123456789abcdefu;
  s.set_rows({1, 0, 1, 1, 1, 0, 0, 1});
  return s;
}

TEST(NamedSelectionFile, WhatIsWrittenReadsBack) {
  NamedSelection second = corner();
  second.name = "Omas Sessel \xc3\xbc";  // a letter that is not English
  const std::string text = named_selections_text({corner(), second});
  EXPECT_THAT(text, HasSubstr("\"0,2-4,7\""));
  const std::vector<NamedSelection> back = parse_named_selections(text, "selections.json");
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(back[0].name, "my corner");
  EXPECT_EQ(back[1].name, second.name);
  EXPECT_EQ(back[0].scene, corner().scene);
  EXPECT_EQ(back[0].count(), 5u);
  EXPECT_EQ(back[0].mask(), (std::vector<uint8_t>{1, 0, 1, 1, 1, 0, 0, 1}));
  EXPECT_EQ(named_selections_text(back), text);
}

TEST(NamedSelectionFile, AnAbsentFileHasNoSelections) {
  EXPECT_TRUE(read_named_selections("/nonexistent/selections.json").empty());
}

TEST(NamedSelectionFile, MalformedFilesAreRefusedByName) {
  const auto entry = [](const std::string& name, const std::string& scene, const std::string& gaussians,
                        const std::string& rows) {
    return R"({"schema": 1, "selections": [{"name": )" + name + R"(, "scene": )" + scene + R"(, "gaussians": )" +
           gaussians + R"(, "rows": )" + rows + "}]}";
  };
  const std::string scene = "\"0123456789abcdef\"", good = entry("\"a\"", scene, "9", "\"0-3,5,8\"");
  ASSERT_EQ(parse_named_selections(good, "selections.json")[0].count(), 6u);
  const auto rows = [&](const std::string& text) { return entry("\"a\"", scene, "9", "\"" + text + "\""); };
  const std::string bad[] = {"",
                             "[]",
                             "{",
                             R"({"selections": []})",
                             R"({"schema": 2, "selections": []})",
                             R"({"schema": 1})",
                             R"({"schema": 1, "selections": {}})",
                             R"({"schema": 1, "selections": [7]})",
                             entry("7", scene, "9", "\"0\""),
                             entry("\"a,b\"", scene, "9", "\"0\""),
                             entry("\" a\"", scene, "9", "\"0\""),
                             entry("\"\"", scene, "9", "\"0\""),
                             entry("\"" + std::string(65, 'a') + "\"", scene, "9", "\"0\""),
                             entry("\"a\"", "\"0123\"", "9", "\"0\""),
                             entry("\"a\"", "\"0123456789abcdeg\"", "9", "\"0\""),
                             entry("\"a\"", "12", "9", "\"0\""),
                             entry("\"a\"", scene, "0", "\"0\""),
                             entry("\"a\"", scene, "-4", "\"0\""),
                             entry("\"a\"", scene, "1e99", "\"0\""),
                             entry("\"a\"", scene, "4294967296", "\"0\""),
                             entry("\"a\"", scene, "9", "[0]"),
                             rows(""),
                             rows("9"),
                             rows("0-9"),
                             rows("3-2"),
                             rows("4,3"),
                             rows("3,4"),  // no gap: one range
                             rows("3,3"),
                             rows("1,"),
                             rows("1-"),
                             rows("-1"),
                             rows("1 ,3"),
                             rows("1;3"),
                             rows("99999999999999999999"),
                             good.substr(0, good.size() - 3),
                             R"({"schema": 1, "selections": )" + std::string(100000, '[')};
  for (const std::string& text : bad) {
    try {
      parse_named_selections(text, "selections.json");
      ADD_FAILURE() << text.substr(0, 200);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << text.substr(0, 200);
      EXPECT_EQ(error.details().path, "selections.json");
      EXPECT_THAT(error.details().remedy, HasSubstr("selections.json"));
    }
  }
}

TEST(NamedSelectionFile, TwoSelectionsOfANameAreRefused) {
  NamedSelection again = corner();
  again.name = "My-Corner";
  EXPECT_THROW(parse_named_selections(named_selections_text({corner(), again}), "selections.json"), Error);
}

TEST(SelectionName, BlanksAreTidied) { EXPECT_EQ(selection_name("  my   corner "), "my corner"); }

TEST(SelectionName, SignsThatEditsNeedAreRefused) {
  for (const char* name : {"", "  ", "12", "a,b", "a#2", "a/b", "a\"b", "a\nb", "a(b)", "\xff\xfe", "\xc3("})
    EXPECT_THROW(selection_name(name), Error) << name;
}

}  // namespace
}  // namespace aligngs
