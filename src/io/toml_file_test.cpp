#include "io/toml_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/random.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

fs::path toml_folder() { return fs::path(testing::TempDir()) / "toml_file_test"; }

void expect_bad_toml(const std::string& text, const std::string& field, const std::string& message) {
  try {
    parse_toml(text, "config.toml");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, "config.toml");
    EXPECT_THAT(error.details().field, HasSubstr(field));
    EXPECT_THAT(error.details().message, HasSubstr(message));
  }
}

TEST(Toml, ReadsTablesAsDottedKeys) {
  const TomlTable table = parse_toml(
      "seed = 7\n[loss]\nnormal = 0.5  # weight\nenabled = true\nkinds = [\"a\", \"b\"]\nsteps = "
      "[1, 2.5]\n"
      "[loss.depth]\nname = 'inverse'\nempty = []\nsize.width = 640\n",
      "");
  EXPECT_EQ(table.at("seed").value, TomlValue(int64_t(7)));
  EXPECT_EQ(table.at("loss.normal").value, TomlValue(0.5));
  EXPECT_EQ(table.at("loss.normal").line, 3);
  EXPECT_EQ(table.at("loss.enabled").value, TomlValue(true));
  EXPECT_EQ(table.at("loss.kinds").value, TomlValue(std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(table.at("loss.steps").value, TomlValue(std::vector<double>{1, 2.5}));
  EXPECT_EQ(table.at("loss.depth.name").value, TomlValue(std::string("inverse")));
  EXPECT_EQ(table.at("loss.depth.empty").value, TomlValue(std::vector<double>{}));
  EXPECT_EQ(table.at("loss.depth.size.width").value, TomlValue(int64_t(640)));
  EXPECT_EQ(table.size(), 8u);
}

TEST(Toml, RoundTripsEveryKindOfValue) {
  const std::map<std::string, TomlValue> values = {
      {"z", true},
      {"a.b.c", int64_t(-9007199254740993)},
      {"a.text", std::string("quote \" backslash \\ tab \t line \n bell \a del \x7f \xc3\xa4")},
      {"a.list", std::vector<double>{1, -0.1, 1e300}},
      {"a.names", std::vector<std::string>{"x y", ""}},
      {"a.key with space", 1.0},
      {"infinite", std::numeric_limits<double>::infinity()},
  };
  write_toml(toml_folder() / "a.toml", values);
  const TomlTable back = read_toml(toml_folder() / "a.toml");
  ASSERT_EQ(back.size(), values.size());
  for (const auto& [key, value] : values) EXPECT_EQ(back.at(key).value, value) << key;
}

TEST(Toml, DoublesComeBackExactly) {
  Random random(1);
  std::map<std::string, TomlValue> values = {{"third", 1.0 / 3}, {"zero", -0.0},    {"one", 1.0},
                                             {"large", 1e22},    {"least", 5e-324}, {"step", 1.6e-4}};
  for (int i = 0; i < 200; ++i) {
    values["random" + std::to_string(i)] = random.normal() * std::pow(10.0, random.uniform(-30, 30));
  }
  const TomlTable back = parse_toml(format_toml(values), "");
  for (const auto& [key, value] : values) EXPECT_EQ(back.at(key).value, value) << key;
  EXPECT_TRUE(std::isnan(std::get<double>(parse_toml(format_toml({{"x", double(NAN)}}), "").at("x").value)));
}

TEST(Toml, TopLevelKeysStandBeforeTheTables) {
  EXPECT_EQ(format_toml({{"b.x", int64_t(1)}, {"c", int64_t(2)}}), "c = 2\n\n[b]\nx = 1\n");
}

TEST(Toml, SyntaxErrorsNameTheLine) {
  expect_bad_toml("a = 1\nb = = 2\n", "line 2", "");
  expect_bad_toml("a = 1\na = 2\n", "line 2", "");
  expect_bad_toml("a = \"\xff\"\n", "line 1", "");
}

TEST(Toml, RefusesWhatAFlatTableCannotHold) {
  expect_bad_toml("a = 1979-05-27\n", "line 1, a", "dates");
  expect_bad_toml("x = 1\na = [1, \"b\"]\n", "line 2, a", "either numbers or strings");
  expect_bad_toml("[[a]]\nx = 1\n", "line 1, a", "numbers or strings");
  expect_bad_toml("\"a.b\" = 1\n", "line 1, a.b", "dot");
}

TEST(Toml, ParsesSingleValues) {
  EXPECT_EQ(parse_toml_value("0.5", "x"), TomlValue(0.5));
  EXPECT_EQ(parse_toml_value("\"text\"", "x"), TomlValue(std::string("text")));
  EXPECT_THROW(parse_toml_value("text", "x"), Error);
  EXPECT_THROW(parse_toml_value("1\nother = 2", "x"), Error);
  EXPECT_THROW(parse_toml_value("{a = 1}", "x"), Error);
}

TEST(Toml, RefusesToWriteWhatCannotBeReadBack) {
  EXPECT_THROW(write_toml(toml_folder() / "bad.toml", {{"a", std::string("\xff")}}), Error);
  EXPECT_THROW(write_toml(toml_folder() / "bad.toml", {{"a", int64_t(1)}, {"a.b", int64_t(1)}}), Error);
  EXPECT_FALSE(fs::exists(toml_folder() / "bad.toml"));
}

}  // namespace
}  // namespace aligngs
