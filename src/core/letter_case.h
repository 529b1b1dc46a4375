// Letters without their case, as in words that people type, extensions of files and names of HTTP.
#pragma once

#include <string>
#include <string_view>

namespace aligngs {

/// An ASCII letter in lower case, in any locale. Other bytes stay.
constexpr char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

inline std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = lower_case(c);
  return out;
}

}  // namespace aligngs
