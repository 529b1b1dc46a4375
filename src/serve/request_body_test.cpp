#include "serve/request_body.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace aligngs
