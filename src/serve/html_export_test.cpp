#include "serve/html_export.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "edit/edit_change.h"
#include "edit/testing/small_room.h"
#include "io/atomic_file.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class HtmlExport : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "aligngs_html_export";
    fs::create_directories(folder_);
    room_ = small_room::make(pool_);
    info_.name = "a \"room\" </script><b>";
    info_.metric = true;
  }
  HtmlParts parts() const { return {.room = room_}; }
  /// The room without its box, and the one that it was made of.
  EditableRoom edited() {
    EditOperation edit;
    edit.kind = EditKind::kDelete;
    edit.select = "box";
    EditableRoom after = room_, out = room_;
    const EditReport report = apply_edit(after, edit, pool_);
    EXPECT_TRUE(apply_change(out, difference(room_, after, edit, report, 1, 0)));
    return out;
  }
  ThreadPool pool_{1};
  EditableRoom room_;
  HtmlSceneInfo info_;
  fs::path folder_;
};

nlohmann::json head_of(const std::string& packed) { return parse_json(packed.substr(0, packed.find('\n'))); }

TEST_F(HtmlExport, ColumnsGiveTheGaussiansBack) {
  const std::string packed = packed_scene(parts(), info_);
  const size_t line = packed.find('\n');
  const nlohmann::json head = parse_json(packed.substr(0, line));
  const size_t n = head["count"];
  ASSERT_EQ(n, room_.gaussians.model.size());
  EXPECT_EQ(head["state"]["name"], info_.name);
  EXPECT_EQ(head["state"]["units"], "metres");
  EXPECT_EQ(head["state"]["up"], (nlohmann::json{0, -1, 0}));
  size_t at = line + 1;
  const GaussianModel& model = room_.gaussians.model;
  for (const auto& column : head["columns"]) {
    const std::string name = column["name"], type = column["type"];
    const size_t bytes = type == "f32" ? 4 : type == "i16" || type == "u16" ? 2 : 1;
    for (size_t i = 0; i < n; ++i, at += bytes) {
      if (name == "y") {
        float v;
        std::memcpy(&v, &packed[at], 4);
        ASSERT_EQ(v, model.positions[3 * i + 1]);
      } else if (name == "scale_0") {
        int16_t v;
        std::memcpy(&v, &packed[at], 2);
        ASSERT_NEAR(v * column["step"].get<double>(), model.log_scales[3 * i], column["step"].get<double>());
      } else if (name == "label") {
        uint16_t v;
        std::memcpy(&v, &packed[at], 2);
        ASSERT_EQ(v, room_.gaussians.labels.label[i]);
      }
    }
  }
  EXPECT_EQ(at, packed.size()) << "and nothing is left over";
}

TEST_F(HtmlExport, TheFileNeedsNothingElse) {
  const fs::path file = folder_ / "room.html";
  write_html(file, parts(), info_, pool_);
  const std::string html = read_file(file);
  EXPECT_EQ(html.find("src=\"/"), std::string::npos);
  EXPECT_EQ(html.find("href=\"/app"), std::string::npos);
  EXPECT_NE(html.find("id=\"aligngs-scene\">H4sI"), std::string::npos) << "gzip in base64";
  EXPECT_EQ(html.find(info_.name), std::string::npos) << "a name is data, never markup";
  EXPECT_NE(html.find("PlayCanvas"), std::string::npos) << "licences travel along";
  const std::string first = html;
  write_html(file, parts(), info_, pool_);
  EXPECT_TRUE(read_file(file) == first) << "the same room gives the same bytes";
}

TEST_F(HtmlExport, TheRoomBeforeItsEditsHasAllSplats) {
  const EditableRoom after = edited();
  ASSERT_LT(after.gaussians.model.size(), room_.gaussians.model.size());
  const nlohmann::json alone = head_of(packed_scene({.room = after}, info_)),
                       both = head_of(packed_scene({.room = after, .before = &room_}, info_));
  EXPECT_EQ(alone["count"], after.gaussians.model.size());
  EXPECT_EQ(alone["state"]["edited"], false);
  EXPECT_EQ(both["count"], room_.gaussians.model.size());
  EXPECT_EQ(both["state"]["edited"], true);
  const fs::path file = folder_ / "before.html";
  write_html(file, {.room = after, .before = &room_}, info_, pool_);
  EXPECT_NE(read_file(file).find("id=\"aligngs-edits\">H4sI"), std::string::npos);
  EXPECT_NE(read_file(file).find("id=\"aligngs-mesh-before\">H4sI"), std::string::npos);
  write_html(file, {.room = after}, info_, pool_);
  EXPECT_EQ(read_file(file).find("id=\"aligngs-edits\""), std::string::npos);
}

TEST_F(HtmlExport, TheMeshMayBeLeftOut) {
  ASSERT_FALSE(room_.mesh.empty());
  const fs::path file = folder_ / "mesh.html";
  EXPECT_GT(write_html(file, parts(), info_, pool_).triangles, 0u);
  EXPECT_NE(read_file(file).find("id=\"aligngs-mesh\">H4sI"), std::string::npos);
  EXPECT_EQ(head_of(packed_scene(parts(), info_))["state"]["mesh"], "mesh.ply");
  const HtmlParts without{.room = room_, .mesh = false};
  EXPECT_EQ(write_html(file, without, info_, pool_).triangles, 0u);
  EXPECT_EQ(read_file(file).find("id=\"aligngs-mesh\""), std::string::npos);
  EXPECT_EQ(head_of(packed_scene(without, info_))["state"]["mesh"], nullptr);
  EXPECT_EQ(estimate_html(without, info_).mesh, 0u);
}

TEST_F(HtmlExport, ViewsMeasurementsAndTheMeasuredRoomTravelAlong) {
  info_.notes = folder_ / "page.json";
  info_.room = folder_ / "room.json";
  write_file_atomically(info_.notes,
                        R"({"format": "aligngs page", "version": 1, "views": [{"name": "bed", "eye": [1, 2, 3],
    "target": [0, 0, 1]}], "measurements": [{"from": [0, 0, 0], "to": [0, 2, 0]}]})");
  write_file_atomically(info_.room, R"({"walls": []})");
  const nlohmann::json head = head_of(packed_scene(parts(), info_));
  EXPECT_EQ(head["state"]["notes"]["views"][0]["name"], "bed");
  EXPECT_EQ(head["state"]["notes"]["measurements"][0]["to"][1], 2);
  EXPECT_EQ(head["state"]["room"], "room.json");
  EXPECT_EQ(head["room"]["walls"], nlohmann::json::array());
  write_file_atomically(info_.notes, "{}");
  EXPECT_THROW(packed_scene(parts(), info_), Error) << "a damaged file is named, not left out";
}

TEST_F(HtmlExport, ItsSizeIsKnownBefore) {
  const EditableRoom after = edited();
  const HtmlParts all{.room = after, .before = &room_};
  const HtmlSize size = estimate_html(all, info_);
  const HtmlReport written = write_html(folder_ / "size.html", all, info_, pool_);
  EXPECT_EQ(written.bytes, fs::file_size(folder_ / "size.html"));
  EXPECT_NEAR(static_cast<double>(size.total()) / static_cast<double>(written.bytes), 1, 0.1);
}

TEST_F(HtmlExport, WhatNobodySeesIsLeftOut) {
  room_.gaussians.model.opacity_logits[0] = -9;
  const std::string packed = packed_scene(parts(), info_);
  EXPECT_EQ(parse_json(packed.substr(0, packed.find('\n')))["count"], room_.gaussians.model.size() - 1);
}

}  // namespace
}  // namespace aligngs
