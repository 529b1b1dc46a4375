#include "serve/connection_slots.h"

#include <gtest/gtest.h>

#include <string>

namespace aligngs {
namespace {

TEST(ConnectionSlots, TheOneThatIsSilentLongestMakesRoom) {
  ConnectionSlots slots(2);
  std::string closed;
  auto a = slots.take([&] { closed += 'a'; });
  auto b = slots.take([&] { closed += 'b'; });
  a->busy();
  a->idle();  // has just been used
  auto c = slots.take([&] { closed += 'c'; });
  ASSERT_TRUE(c);
  EXPECT_EQ(closed, "b");
  EXPECT_TRUE(b->closed());
  EXPECT_EQ(slots.taken(), 2u);
}

TEST(ConnectionSlots, ConnectionsAtWorkAreNotClosed) {
  ConnectionSlots slots(1);
  bool closed = false;
  auto a = slots.take([&] { closed = true; });
  a->busy();
  EXPECT_FALSE(slots.take([] {}));
  EXPECT_FALSE(closed);
}

TEST(ConnectionSlots, APlaceIsFreeAgainWhenItsConnectionEnds) {
  ConnectionSlots slots(1);
  {
    auto a = slots.take([] {});
    a->busy();
  }
  EXPECT_EQ(slots.taken(), 0u);
  EXPECT_TRUE(slots.take([] {}));
}

}  // namespace
}  // namespace aligngs
