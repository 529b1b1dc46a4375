#include "serve/page_notes.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kText =
    R"({"format": "aligngs page", "version": 1, "views": [{"name": "bed", "eye": [1, 2, 3], "target": [0, 0.5, -1]}],
        "measurements": [{"from": [0, 0, 0], "to": [0, 2.5, 0]}]})";

std::string field_of_refusal(const std::string& text) {
  try {
    read_page_notes(text, "page.json");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, "page.json");
    EXPECT_FALSE(error.details().remedy.empty());
    return error.details().field;
  }
  return "accepted";
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = kText;
  return text.replace(text.find(from), from.size(), to);
}

TEST(PageNotes, ComeBackAsTheyWere) {
  const PageNotes notes = read_page_notes(kText, "page.json");
  ASSERT_EQ(notes.views.size(), 1u);
  EXPECT_EQ(notes.views[0].name, "bed");
  EXPECT_EQ(notes.views[0].target[1], 0.5);
  ASSERT_EQ(notes.measurements.size(), 1u);
  EXPECT_EQ(notes.measurements[0].to[1], 2.5);
  EXPECT_EQ(page_notes_json(notes), parse_json(kText));
}

TEST(PageNotes, RefusalsNameTheField) {
  EXPECT_EQ(field_of_refusal("[]"), "");
  EXPECT_EQ(field_of_refusal("{\"format\""), "");
  EXPECT_EQ(field_of_refusal(with("aligngs page", "keys")), "format");
  EXPECT_EQ(field_of_refusal(with("\"version\": 1", "\"version\": 2")), "format");
  EXPECT_EQ(field_of_refusal(with("\"bed\"", "\"\"")), "views[0].name");
  EXPECT_EQ(field_of_refusal(with("[1, 2, 3]", "[1, 2]")), "views[0].eye");
  EXPECT_EQ(field_of_refusal(with("-1]", "NaN]")), "views[0].target");
  EXPECT_EQ(field_of_refusal(with("2.5", "2e6")), "measurements[0].to");
  EXPECT_EQ(field_of_refusal(with("[{\"from\": [0, 0, 0], \"to\": [0, 2.5, 0]}]", "7")), "measurements");
}

TEST(PageNotes, AViewMayCutTheRoom) {
  const std::string text = with("\"eye\"", "\"cut\": [0, 1, 0, 0.5, 0.25, 1], \"eye\"");
  const PageNotes notes = read_page_notes(text, "page.json");
  ASSERT_TRUE(notes.views[0].cut);
  EXPECT_EQ((*notes.views[0].cut)[3], 0.5);
  EXPECT_EQ(page_notes_json(notes), parse_json(text));
  for (const char* cut : {"[0, 1]", "[0, 1, 0, 2, 0, 1]", "[0, 1, 0.5, 0.5, 0, 1]", "7"}) {
    EXPECT_EQ(field_of_refusal(with("\"eye\"", std::string("\"cut\": ") + cut + ", \"eye\"")), "views[0].cut") << cut;
  }
}

TEST(PageNotes, ListsHaveAnEnd) {
  nlohmann::json json = parse_json(kText);
  for (int i = 0; i < 200; ++i) json["measurements"].push_back(json["measurements"][0]);
  EXPECT_EQ(field_of_refusal(json_line(json)), "measurements");
}

TEST(PageNotes, ThePageWritesThem) {
  const fs::path run = fs::path(testing::TempDir()) / "aligngs_page_notes";
  fs::remove_all(run);
  fs::create_directories(run);
  EXPECT_TRUE(page_notes_of_run(run).views.empty()) << "none without a file";
  ViewServerOptions options;
  serve_notes(run, options);
  EXPECT_EQ(options.post.at("/api/notes")(kText), "{}");
  EXPECT_EQ(page_notes_of_run(run).views.at(0).name, "bed");
  EXPECT_THROW(options.post.at("/api/notes")("{}"), Error);
  EXPECT_EQ(page_notes_of_run(run).views.at(0).name, "bed") << "a refused request changes nothing";
}

TEST(PageNotes, AFolderThatIsGoneStaysGone) {
  const fs::path run = fs::path(testing::TempDir()) / "aligngs_page_notes_gone";
  fs::remove_all(run);
  ViewServerOptions options;
  serve_notes(run, options);
  EXPECT_THROW(options.post.at("/api/notes")(kText), Error);
  EXPECT_FALSE(fs::exists(run));
}

}  // namespace
}  // namespace aligngs
