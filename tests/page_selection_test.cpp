// Selections by hand: what the page sends, and what the command line does with it.
#include <gmock/gmock.h>

#include "edit/named_selection.h"
#include "io/atomic_file.h"
#include "io/base64.h"
#include "io/gzip.h"
#include "support/page_run.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing_support::kPatience;
using testing_support::run_aligngs;

class PageSelection : public testing_support::PageRun {
 protected:
  /// Splats that the page has.
  size_t splats() const {
    const std::string part =
        test_http::body(test_http::get(server_->port(), "/api/scene/coarse/scene.labels.ply", "localhost", kPatience));
    const std::string text = gzip_expanded(part, "part", 1 << 28);
    return parse_json(text.substr(0, text.find('\n')))["total"].get<size_t>();
  }
  static std::string packed(const std::string& bits) { return base64_text(gzip_compressed(bits)); }
  /// A selection of the page's first `count` splats.
  json selection(const std::string& name, size_t count) const {
    const size_t all = splats();
    std::string bits((all + 7) / 8, '\0');
    for (size_t i = 0; i < count; ++i) bits[i / 8] = static_cast<char>(bits[i / 8] | 1 << i % 8);
    return {{"name", name}, {"scene", "scene.labels.ply"}, {"splats", std::to_string(all)}, {"places", packed(bits)}};
  }
  std::string refusal(const std::string& path, const json& body) const {
    const std::string answer = post(path, body);
    EXPECT_EQ(test_http::status(answer), 400) << body.dump().substr(0, 200);
    return test_http::body(answer);
  }
  json selections() const {
    return parse_json(
        test_http::body(test_http::get(server_->port(), "/api/selections", "localhost", kPatience)))["selections"];
  }
  testing_support::ProcessResult edit(const std::string& options) const {
    return run_aligngs("edit " + quoted(run_) + " " + options, root());
  }
};

TEST_F(PageSelection, WhatIsDrawnIsKeptAndShownAgain) {
  const json sent = selection("my corner", 100);
  EXPECT_EQ(posted("/api/selections/save", sent)["selections"],
            json::array({{{"name", "my corner"}, {"gaussians", 100}, {"usable", true}}}));
  EXPECT_EQ(selections().size(), 1u);
  const std::string places = test_http::body(
      test_http::get(server_->port(), "/api/selections/places/my%20corner/scene.labels.ply", "localhost", kPatience));
  EXPECT_EQ(packed(gzip_expanded(places, "places", 1 << 20)), sent["places"]);
  EXPECT_EQ(test_http::status(test_http::get(server_->port(), "/api/selections/places/nook/scene.labels.ply",
                                             "localhost", kPatience)),
            400);
}

TEST_F(PageSelection, TheCommandLineEditsIt) {
  posted("/api/selections/save", selection("my corner", 100));
  EXPECT_THAT(edit("--list").out, HasSubstr("my corner: 100 Gaussians"));
  ASSERT_EQ(edit("-q --select 'my corner' --recolor '#00ff00'").status, 0);
  ASSERT_EQ(edit("-q --select 'My Corner' --move 0,0.2,0").status, 0);
  ASSERT_EQ(edit("-q --say 'delete my corner'").status, 0);
  EXPECT_EQ(list()["edits"],
            (json{"recolor my corner to #00ff00", "move my corner by 0,0.2,0", "delete my corner, hole filled"}));
  EXPECT_EQ(edit("-q --undo").status, 0);
  EXPECT_EQ(edit("-q --say 'undo the first edit'").status, 0);
  EXPECT_EQ(list()["edits"], json{"move my corner by 0,0.2,0"});
}

TEST_F(PageSelection, TheTextBoxEditsItAndUndoBringsItBack) {
  posted("/api/selections/save", selection("my corner", 100));
  const json report = posted("/api/edits/push", {{"edit", "delete my corner --no-fill"}})["report"];
  EXPECT_EQ(report["selected_gaussians"], 100);
  EXPECT_THAT(refusal("/api/edits/push", {{"edit", "delete my corner"}}), HasSubstr("is left in the room"));
  posted("/api/edits/undo", json::object());
  EXPECT_EQ(posted("/api/edits/redo", json::object())["edits"], json{"delete my corner, hole left open"});
}

TEST_F(PageSelection, NamesAreChangedOnThePageAndOnTheCommandLine) {
  posted("/api/selections/save", selection("my corner", 100));
  EXPECT_EQ(posted("/api/selections/rename", {{"name", "my corner"}, {"to", "nook"}})["selections"][0]["name"], "nook");
  ASSERT_EQ(edit("--rename-selection nook 'reading corner'").status, 0);
  EXPECT_EQ(selections()[0]["name"], "reading corner") << "the page sees what the command line did";
  posted("/api/edits/push", {{"edit", "highlight reading corner"}});
  EXPECT_EQ(edit("--remove-selection 'reading corner'").status, 2) << "an edit speaks of it";
  EXPECT_THAT(refusal("/api/selections/remove", {{"name", "reading corner"}}), HasSubstr("undo that edit first"));
  posted("/api/edits/undo", json::object());
  ASSERT_EQ(edit("--remove-selection 'reading corner'").status, 0);
  EXPECT_TRUE(selections().empty());
  EXPECT_FALSE(fs::exists(run_ / "selections.json"));
}

TEST_F(PageSelection, MistakesAreAnsweredInWordsAndChangeNothing) {
  const json good = selection("my corner", 100);
  const auto with = [&](const char* field, const json& value) {
    json changed = good;
    changed[field] = value;
    return changed;
  };
  const auto save = [&](const json& body) { return refusal("/api/selections/save", body); };
  EXPECT_THAT(save(with("name", "bed")), HasSubstr("means objects"));
  EXPECT_THAT(save(with("name", "a,b")), HasSubstr("sign"));
  EXPECT_THAT(save(with("name", 7)), HasSubstr("no text"));
  EXPECT_THAT(save(with("more", "x")), HasSubstr("nobody knows"));
  EXPECT_THAT(save(with("splats", "3")), HasSubstr("other splats"));
  EXPECT_THAT(save(with("scene", "../trained/scene.ply")), HasSubstr("other splats"));
  EXPECT_THAT(save(with("places", "%%%")), HasSubstr("base64"));
  EXPECT_THAT(save(with("places", base64_text("no gzip"))), HasSubstr("cannot be read"));
  EXPECT_THAT(save(with("places", packed("x"))), HasSubstr("number of places"));
  EXPECT_THAT(save(with("places", packed(std::string(1 << 24, 'x')))), HasSubstr("cannot be read"));
  EXPECT_THAT(save(selection("nothing", 0)), HasSubstr("nothing is selected"));
  EXPECT_THAT(refusal("/api/selections/rename", {{"name", "nook"}, {"to", "corner"}}), HasSubstr("no selection"));
  EXPECT_FALSE(fs::exists(run_ / "selections.json"));
}

TEST_F(PageSelection, ASelectionOfAnotherTrainingIsRefused) {
  posted("/api/selections/save", selection("my corner", 100));
  std::vector<NamedSelection> kept = read_named_selections(run_ / "selections.json");
  kept[0].scene ^= 1;
  write_file_atomically(run_ / "selections.json", named_selections_text(kept));
  EXPECT_EQ(selections()[0]["usable"], false);
  EXPECT_THAT(refusal("/api/edits/push", {{"edit", "delete my corner"}}), HasSubstr("another training"));
  const auto told = edit("--select 'my corner' --delete");
  EXPECT_EQ(told.status, 3);
  EXPECT_THAT(told.err, HasSubstr("selections.json"));
  posted("/api/edits/push", {{"edit", "highlight bed"}});
}

TEST_F(PageSelection, ADamagedFileIsNamed) {
  write_file_atomically(run_ / "selections.json", "{\"schema\": 1}");
  const auto told = edit("--list");
  EXPECT_EQ(told.status, 3);
  EXPECT_THAT(told.err, HasSubstr("selections.json"));
  EXPECT_THAT(told.err, HasSubstr("remove selections.json"));
}

}  // namespace
}  // namespace aligngs
