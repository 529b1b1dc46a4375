#include "serve/request_body.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.h"

namespace aligngs {
namespace {

TEST(JsonDepth, CountsBracketsOutsideStrings) {
  EXPECT_EQ(json_depth("7"), 0);
  EXPECT_EQ(json_depth(R"({"a": [1, [2]], "b": {}})"), 3);
  EXPECT_EQ(json_depth(R"({"edit": "delete [[[[[[[[[[ \" {{{{"})"), 1);
}

TEST(JsonFault, ToldForDeepNesting) {
  EXPECT_EQ(json_fault(std::string(8, '[') + std::string(8, ']')), std::nullopt);
  EXPECT_EQ(json_fault(std::string(9, '[') + std::string(9, ']')), "the JSON is nested deeper than 8 levels");
  EXPECT_EQ(json_fault(std::string(1 << 20, '[')), "the JSON is nested deeper than 8 levels") << "the stack holds";
}

TEST(JsonFault, ToldForTextThatIsNoJson) {
  EXPECT_EQ(json_fault("{"), "the body is not JSON");
  EXPECT_EQ(json_fault(""), "the body is not JSON");
}

TEST(TextFields, ErrorsNameTheFieldAndARemedy) {
  const auto error_of = [](const std::string& body) {
    try {
      text_fields(body, {"edit"}, 10);
    } catch (const Error& error) {
      return error.details().field + ": " + error.details().remedy;
    }
    return std::string("no error");
  };
  EXPECT_EQ(error_of(R"({"edit": "undo"})"), "no error");
  EXPECT_EQ(error_of("{}"), "edit: add it");
  EXPECT_EQ(error_of(R"({"edit": "delete everything"})"), "edit: send at most 10 bytes");
  EXPECT_EQ(error_of(R"({"edit": "undo", "output": "x"})"), "output: send these alone: edit");
}

}  // namespace
}  // namespace aligngs
