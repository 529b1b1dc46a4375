#include "serve/compact_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "io/gzip.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

using nlohmann::json;

/// `count` small splats on a line, of which number 7 is large and number 3 cannot be seen.
SplatTable line_of(size_t count) {
  SplatTable t;
  for (size_t i = 0; i < count; ++i) {
    t.position[0].push_back(0.01f * static_cast<float>(i));
    t.position[1].push_back(-1.5f);
    t.position[2].push_back(static_cast<float>(i % 7));
    for (size_t k = 0; k < 3; ++k) t.color[k].push_back(0.25f * static_cast<float>(k));
    for (size_t k = 0; k < 3; ++k) t.log_scale[k].push_back(i == 7 ? -1.0f : -4.0f);
    for (size_t k = 0; k < 4; ++k) t.rotation[k].push_back(k == 1 ? 2.0f : 0.0f);
    t.opacity.push_back(i == 3 ? -20.0f : 2.0f);
    t.label.push_back(static_cast<uint16_t>(i % 5));
    t.instance.push_back(static_cast<uint16_t>(i % 3));
    t.confidence.push_back(200);
  }
  t.sh_degree = 1;
  t.harmonics.assign(9, std::vector<float>(count, 0.125f));
  return t;
}

struct Decoded {
  json head;
  std::map<std::string, std::vector<double>> columns;
};
/// Columns as the page reads them from a part.
Decoded decoded(const std::string& part) {
  const std::string bytes = gzip_expanded(part, "part", 1 << 26);
  Decoded out;
  size_t at = bytes.find('\n') + 1;
  out.head = parse_json(std::string_view(bytes).substr(0, at - 1));
  for (const json& column : out.head["columns"]) {
    const std::string type = column["type"];
    uint16_t before = 0;
    for (size_t i = 0; i < column["count"]; ++i) {
      double number = 0;
      if (type == "u8" || type == "i8") {
        number = type == "i8" ? static_cast<int8_t>(bytes[at]) : static_cast<uint8_t>(bytes[at]);
        at += 1;
      } else {
        uint16_t raw;
        std::memcpy(&raw, &bytes[at], 2);
        at += 2;
        if (column["delta"]) raw = before = static_cast<uint16_t>(before + raw);
        number = type == "i16" ? static_cast<int16_t>(raw) : raw;
      }
      double value = number * column["step"].get<double>();
      if (column["log"]) value = std::copysign(std::expm1(std::fabs(value)), value);
      out.columns[column["name"]].push_back(value);
    }
  }
  EXPECT_EQ(at, bytes.size()) << "nothing follows the columns";
  return out;
}

TEST(CompactScene, TheMostVisibleSplatsComeFirst) {
  const CompactScene scene = compact_scene(line_of(100'000));
  const Decoded coarse = decoded(scene.coarse), rest = decoded(scene.rest);
  EXPECT_EQ(coarse.head["total"], 99'999) << "one cannot be seen";
  EXPECT_EQ(coarse.head["shown"], 24'999);
  EXPECT_EQ(coarse.columns.at("x").size() + rest.columns.at("x").size(), 99'999u);
  const std::vector<double>& scales = coarse.columns.at("scale_0");
  EXPECT_EQ(std::count(scales.begin(), scales.end(), -1.0), 1) << "the large one is in the first part";
  EXPECT_FALSE(coarse.columns.contains("f_rest_0")) << "colours that turn with the view come later";
  EXPECT_EQ(rest.columns.at("f_rest_8").size(), 99'999u);
}

TEST(CompactScene, NumbersComeBackNearly) {
  const SplatTable table = line_of(500);
  const Decoded coarse = decoded(compact_scene(table).coarse);
  ASSERT_EQ(coarse.columns.at("x").size(), 499u);
  for (size_t i = 0; i < 499; ++i) {
    const double row = std::round(coarse.columns.at("x")[i] / 0.01);  // rows are sorted in space
    EXPECT_NEAR(coarse.columns.at("x")[i], 0.01 * row, 1e-3);
    EXPECT_NEAR(coarse.columns.at("y")[i], -1.5, 1e-3);
    EXPECT_EQ(coarse.columns.at("label")[i], static_cast<int>(row) % 5);
    EXPECT_EQ(coarse.columns.at("instance")[i], static_cast<int>(row) % 3);
  }
  EXPECT_NEAR(coarse.columns.at("f_dc_2")[0], 0.5, 1.0 / 128);
  EXPECT_NEAR(coarse.columns.at("opacity")[0], 2, 1.0 / 32);
  EXPECT_NEAR(coarse.columns.at("rot_1")[0], 1, 1e-6) << "of unit length";
}

TEST(CompactScene, ARoomWithoutSplatsIsEmpty) {
  const Decoded coarse = decoded(compact_scene(SplatTable{}).coarse);
  EXPECT_EQ(coarse.head["total"], 0);
}

}  // namespace
}  // namespace aligngs
