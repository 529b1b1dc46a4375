#include "engine/cpu/lane_places.h"

#include <gtest/gtest.h>

#include <vector>

namespace aligngs::cpu {
namespace {

TEST(LanePlaces, AreTheSetBitsOfEveryByte) {
  for (size_t byte = 0; byte < 256; ++byte) {
    std::vector<uint8_t> bits;
    for (size_t bit = 0; bit < kByteBits; ++bit) {
      if ((byte & (size_t(1) << bit)) != 0) bits.push_back(static_cast<uint8_t>(bit));
    }
    bits.resize(kByteBits, 0);
    const auto first = kPlacesOfBits.begin() + static_cast<std::ptrdiff_t>(kByteBits * byte);
    EXPECT_EQ(bits, std::vector<uint8_t>(first, first + kByteBits)) << byte;
  }
}

}  // namespace
}  // namespace aligngs::cpu
