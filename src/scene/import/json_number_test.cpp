#include "scene/import/json_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace aligngs {
namespace {

using NumberJson = nlohmann::json;

TEST(JsonNumber, TextsOfNumbersAreNumbers) {
  EXPECT_EQ(number_of_json(NumberJson("1920")), 1920);
  EXPECT_TRUE(is_number_of_json(NumberJson("-0.5e1")));
}

TEST(JsonNumber, WordsOfNumbersThatAreNotFiniteAreNumbers) {
  for (const char* word : {"NaN", "Infinity", "-Infinity"}) {
    EXPECT_TRUE(is_number_of_json(NumberJson(word))) << word;
    EXPECT_FALSE(std::isfinite(number_of_json(NumberJson(word)))) << word;
  }
}

TEST(JsonNumber, OtherValuesAreNone) {
  for (const NumberJson& value : {NumberJson("abc"), NumberJson(""), NumberJson("30 px"), NumberJson(nullptr),
                                  NumberJson(true), NumberJson::array(), NumberJson::object()}) {
    EXPECT_FALSE(is_number_of_json(value)) << value;
    EXPECT_TRUE(std::isnan(number_of_json(value))) << value;
  }
}

TEST(JsonNumber, TheMessageShowsTheValue) {
  EXPECT_EQ(no_number(NumberJson("abc")), "expected a number, found \"abc\"");
  EXPECT_EQ(no_number(NumberJson(nullptr)), "expected a number, found null");
}

TEST(JsonNumber, TheMessageCutsALongValue) { EXPECT_LT(no_number(NumberJson(std::string(1000, 'a'))).size(), 100u); }

}  // namespace
}  // namespace aligngs
