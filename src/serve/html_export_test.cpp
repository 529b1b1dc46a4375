#include "serve/html_export.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "edit/small_room_for_tests.h"
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
  ThreadPool pool_{1};
  EditableRoom room_;
  HtmlSceneInfo info_;
  fs::path folder_;
};

TEST_F(HtmlExport, ColumnsGiveTheGaussiansBack) {
  const std::string packed = packed_scene(room_, info_);
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
  write_html(file, room_, info_);
  const std::string html = read_file(file);
  EXPECT_EQ(html.find("src=\"/"), std::string::npos);
  EXPECT_EQ(html.find("href=\"/app"), std::string::npos);
  EXPECT_NE(html.find("id=\"aligngs-scene\">H4sI"), std::string::npos) << "gzip in base64";
  EXPECT_EQ(html.find(info_.name), std::string::npos) << "a name is data, never markup";
  EXPECT_NE(html.find("PlayCanvas"), std::string::npos) << "licences travel along";
  const std::string first = html;
  write_html(file, room_, info_);
  EXPECT_TRUE(read_file(file) == first) << "the same room gives the same bytes";
}

TEST_F(HtmlExport, WhatNobodySeesIsLeftOut) {
  room_.gaussians.model.opacity_logits[0] = -9;
  const std::string packed = packed_scene(room_, info_);
  EXPECT_EQ(parse_json(packed.substr(0, packed.find('\n')))["count"], room_.gaussians.model.size() - 1);
}

}  // namespace
}  // namespace aligngs
