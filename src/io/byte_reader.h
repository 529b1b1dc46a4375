// Bounds-checked reading of numbers from bytes in memory: every parser of a binary format goes
// through it.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "core/error.h"

namespace aligngs {

/// The value of T stored at `bytes` in the given byte order; the caller has checked that sizeof(T)
/// bytes are there.
template <class T>
T load_number(const char* bytes, bool big_endian) {
  static_assert(std::is_arithmetic_v<T>);
  char copy[sizeof(T)];
  const bool swap = big_endian != (std::endian::native == std::endian::big);
  for (size_t i = 0; i < sizeof(T); ++i) copy[i] = bytes[swap ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, copy, sizeof(T));
  return value;
}

/// Appends the little-endian bytes of a number.
template <class T>
void append_little(std::string& out, T value) {
  static_assert(std::is_arithmetic_v<T>);
  char copy[sizeof(T)];
  std::memcpy(copy, &value, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) {
    for (size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(copy[i], copy[sizeof(T) - 1 - i]);
  }
  out.append(copy, sizeof(T));
}

/// A cursor over bytes. Reading past the end is Error{kBadInput} naming the file and the field.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, std::filesystem::path name) : bytes_(bytes), name_(std::move(name)) {}

  size_t offset() const { return offset_; }
  size_t remaining() const { return bytes_.size() - offset_; }

  std::string_view take(uint64_t count, const std::string& field) {
    if (count > remaining()) {
      fail(field, "the file ends too early (" + std::to_string(count) + " bytes needed, " +
                      std::to_string(remaining()) + " left)");
    }
    const std::string_view part = bytes_.substr(offset_, static_cast<size_t>(count));
    offset_ += static_cast<size_t>(count);
    return part;
  }
  template <class T>
  T little(const char* field) {
    if (remaining() < sizeof(T)) take(sizeof(T), field);
    const T value = load_number<T>(bytes_.data() + offset_, false);
    offset_ += sizeof(T);
    return value;
  }
  /// A count of records of at least `record_bytes` (>= 1) each: refused when the rest of the file
  /// cannot hold them. A corrupt file hence cannot cause a large allocation.
  uint64_t count_of(uint64_t count, uint64_t record_bytes, const std::string& field) const {
    if (count > remaining() / record_bytes) {
      fail(field, "the file cannot hold " + std::to_string(count) + " entries");
    }
    return count;
  }
  [[noreturn]] void fail(const std::string& field, const std::string& message) const {
    throw_bad_input(name_, field, message, "the file is damaged or incomplete; copy or create it again");
  }

 private:
  std::string_view bytes_;
  std::filesystem::path name_;
  size_t offset_ = 0;
};

}  // namespace aligngs
