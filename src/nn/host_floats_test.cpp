#include "nn/host_floats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace aligngs::nn {
namespace {

TEST(HostFloats, BeginAsZerosOnABoundaryOfALine) {
  for (const size_t count : {size_t(1), size_t(1000), size_t(3) << 20}) {  // the last: pages of its own
    const HostFloats floats(count);
    EXPECT_EQ(floats.size(), count);
    EXPECT_EQ(reinterpret_cast<uintptr_t>(floats.data()) % 64, 0u);
    EXPECT_TRUE(std::all_of(floats.data(), floats.data() + count, [](float f) { return f == 0; }));
  }
}

TEST(HostFloats, AMoveTakesTheMemory) {
  for (const size_t count : {size_t(10), size_t(3) << 20}) {
    HostFloats from(count);
    from.data()[count - 1] = 7;
    const float* const memory = from.data();
    HostFloats to(5);
    to = std::move(from);
    EXPECT_EQ(to.data(), memory);
    EXPECT_EQ(to.data()[count - 1], 7);
    EXPECT_EQ(from.size(), 0u);  // NOLINT(bugprone-use-after-move): empty by contract
    EXPECT_EQ(from.data(), nullptr);
  }
}

TEST(HostFloats, NoneTakeNoMemory) { EXPECT_EQ(HostFloats(0).data(), nullptr); }

}  // namespace
}  // namespace aligngs::nn
