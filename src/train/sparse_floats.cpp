#include "train/sparse_floats.h"

#include <cstring>
#include <vector>

namespace aligngs {
namespace {

constexpr size_t kFloatBytes = 4;
constexpr size_t kOneOtherIn = 4;  // one value in four may differ: beyond, the bits cost more than they gain

uint32_t bits_at(const char* floats, size_t i) {
  uint32_t bits = 0;
  std::memcpy(&bits, floats + kFloatBytes * i, kFloatBytes);
  return bits;
}

/// The value of more than half of all, if there is one (Boyer and Moore's vote).
uint32_t majority(const char* floats, size_t count) {
  uint32_t leader = 0;
  size_t lead = 0;
  for (size_t i = 0; i < count; ++i) {
    const uint32_t bits = bits_at(floats, i);
    if (lead == 0) leader = bits;
    lead = bits == leader ? lead + 1 : lead - 1;
  }
  return leader;
}

size_t mask_bytes(size_t count) { return (count + 7) / 8; }

}  // namespace

std::optional<SparseFloats> sparse_floats(std::string_view floats) {
  const size_t count = floats.size() / kFloatBytes;
  SparseFloats out;
  out.common = majority(floats.data(), count);
  out.bytes.assign(mask_bytes(count), '\0');
  std::vector<uint32_t> others;
  for (size_t i = 0; i < count; ++i) {
    const uint32_t bits = bits_at(floats.data(), i);
    if (bits == out.common) continue;
    out.bytes[i / 8] = static_cast<char>(out.bytes[i / 8] | (1 << (i % 8)));
    others.push_back(bits);
    if (others.size() > count / kOneOtherIn) return std::nullopt;
  }
  out.bytes.reserve(out.bytes.size() + kFloatBytes * others.size());
  for (size_t plane = 0; plane < kFloatBytes; ++plane) {
    for (const uint32_t bits : others) out.bytes += static_cast<char>(bits >> (8 * plane));
  }
  return out;
}

size_t most_sparse_bytes(size_t count) { return mask_bytes(count) + kFloatBytes * (count / kOneOtherIn); }

bool expand_sparse_floats(uint32_t common, std::string_view bytes, size_t count, uint8_t* floats) {
  const size_t mask = mask_bytes(count);
  if (bytes.size() < mask || (bytes.size() - mask) % kFloatBytes != 0) return false;
  const size_t others = (bytes.size() - mask) / kFloatBytes;
  const char* values = bytes.data() + mask;
  size_t taken = 0;
  for (size_t i = 0; i < count; ++i) {
    uint32_t bits = common;
    if ((static_cast<uint8_t>(bytes[i / 8]) >> (i % 8) & 1) != 0) {
      if (taken == others) return false;
      bits = 0;
      for (size_t plane = 0; plane < kFloatBytes; ++plane)
        bits |= uint32_t(static_cast<uint8_t>(values[others * plane + taken])) << (8 * plane);
      ++taken;
    }
    std::memcpy(floats + kFloatBytes * i, &bits, kFloatBytes);
  }
  return taken == others;
}

}  // namespace aligngs
