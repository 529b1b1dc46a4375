#include "io/json_integer.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

using Json = nlohmann::json;

TEST(JsonInteger, IntegersOfTheRangeAreThemselves) {
  EXPECT_EQ(integer_in<int>(Json(-3)), -3);
  EXPECT_EQ(integer_in<uint16_t>(Json(65535)), 65535);
  EXPECT_EQ(integer_in<uint64_t>(Json(uint64_t(18446744073709551615u))), 18446744073709551615u);
  EXPECT_EQ(integer_in<int64_t>(nlohmann::ordered_json(INT64_MIN)), INT64_MIN);
}

TEST(JsonInteger, AWholeNumberMayBeWrittenWithAPoint) {
  EXPECT_EQ(integer_in<int>(Json::parse("3.0")), 3);
  EXPECT_EQ(integer_in<int64_t>(Json::parse("-1e3")), -1000);
}

TEST(JsonInteger, NumbersBeyondTheRangeAreNone) {
  EXPECT_FALSE(integer_in<uint32_t>(Json(-1)));
  EXPECT_FALSE(integer_in<uint16_t>(Json(65536)));
  EXPECT_FALSE(integer_in<int64_t>(Json(uint64_t(18446744073709551615u))));
  EXPECT_FALSE(integer_in<int64_t>(Json(1e308)));
  EXPECT_FALSE(integer_in<int>(Json(-1e10)));
}

TEST(JsonInteger, FractionsAndOtherTypesAreNone) {
  EXPECT_FALSE(integer_in<int>(Json(2.5)));
  EXPECT_FALSE(integer_in<int>(Json("3")));
  EXPECT_FALSE(integer_in<int>(Json(true)));
  EXPECT_FALSE(integer_in<int>(Json()));
}

TEST(JsonInteger, AMemberThatIsAbsentOrNoneIsTheOther) {
  const Json object = {{"views", 12}, {"seed", 1e308}};
  EXPECT_EQ(integer_member<int>(object, "views"), 12);
  EXPECT_EQ(integer_member<int>(object, "seed"), 0);
  EXPECT_EQ(integer_member<int>(object, "masks", 3), 3);
}

TEST(JsonInteger, AnIntegerThatMustBeThereIsAnException) {
  EXPECT_EQ(integer_of<uint32_t>(Json(7)), 7u);
  EXPECT_THROW(integer_of<uint32_t>(Json(1e308)), std::out_of_range);
}

}  // namespace
}  // namespace aligngs
