#include "io/json_text.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace aligngs {
namespace {

TEST(JsonText, LinesAreForProgramsAndDocumentsForFilesAndPeople) {
  const nlohmann::json value = {{"views", 2}, {"folder", "renders"}};
  EXPECT_EQ(json_line(value), R"({"folder":"renders","views":2})");
  EXPECT_EQ(json_document(value), "{\n  \"folder\": \"renders\",\n  \"views\": 2\n}\n");
}

TEST(JsonText, OrderedObjectsKeepTheirOrder) {
  const std::string text = R"({"views":2,"folder":"renders"})";
  EXPECT_EQ(json_line(parse_ordered_json(text)), text);
}

TEST(JsonText, AFileNameThatIsNoUtf8IsWrittenAllTheSame) {
  EXPECT_EQ(json_line(nlohmann::json{{"folder", "room\xff"}}), "{\"folder\":\"room\xef\xbf\xbd\"}");
}

TEST(JsonText, NumbersThatAreNotFiniteAreNull) {
  EXPECT_EQ(json_line(nlohmann::json(std::numeric_limits<double>::quiet_NaN())), "null");
}

TEST(JsonText, PythonsWordsForSuchNumbersAreTexts) {
  const nlohmann::json value = parse_json(R"({"a": [NaN, -Infinity, Infinity, 1], "NaN": "an \"Infinity\" NaN"})");
  EXPECT_EQ(value,
            nlohmann::json::parse(R"({"a": ["NaN", "-Infinity", "Infinity", 1], "NaN": "an \"Infinity\" NaN"})"));
  EXPECT_TRUE(parse_json("{NaN: 1}").is_discarded());
}

TEST(JsonText, TheFaultOfATextHasALineAndAColumn) {
  EXPECT_EQ(place_of_json_fault("{\n \"a\": 1,\n}"), "line 3, column 1");
  EXPECT_EQ(place_of_json_fault("// mine\n{}"), "line 1, column 1");
  EXPECT_EQ(place_of_json_fault("{\"a\""), "line 1, column 5");
}

TEST(JsonText, CommentsAndLastCommasBecomeBlanks) {
  for (const auto& [text, plain] :
       {std::pair{"[1, // one\n2]", "[1,       \n2]"},
        {"[1, /* a\n ] */ 2,]", "[1,     \n      2 ]"},
        {"{\"a\": \"//,]\", \"b\\\\\": [1], } // end", "{\"a\": \"//,]\", \"b\\\\\": [1]  }       "},
        {"[1, // ]\n]", "[1      \n]"}})
    EXPECT_EQ(without_comments(text), plain);
  for (const char* open : {"/*", "//", "\"", "\"\\", ",", "[,]", "/"})
    EXPECT_EQ(without_comments(open).size(), std::string(open).size());
}

TEST(JsonText, WhatIsNoJsonIsDiscarded) {
  for (const char* text : {"", "{", "{\"a\":1} and more", "nul", "\"\xff\"", "[1,]"}) {
    EXPECT_TRUE(parse_json(text).is_discarded()) << text;
    EXPECT_TRUE(parse_ordered_json(text).is_discarded()) << text;
  }
  EXPECT_EQ(parse_json("[1, 2]").size(), 2u);
}

}  // namespace
}  // namespace aligngs
