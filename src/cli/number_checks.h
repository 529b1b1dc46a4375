// Checks of numbers whose messages say what is allowed; CLI11's own print the largest double.
#pragma once

#include <CLI/App.hpp>
#include <cmath>
#include <cstdlib>
#include <string>

namespace aligngs {

/// Numbers above zero.
inline CLI::Validator positive_number() {
  return CLI::Validator(
      [](const std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        return end != text.c_str() && *end == '\0' && value > 0 && std::isfinite(value)
                   ? std::string()
                   : text + " is no number above zero";
      },
      "POSITIVE");
}

/// Zero and numbers above it.
inline CLI::Validator number_from_zero() {
  return CLI::Validator(
      [](const std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        return end != text.c_str() && *end == '\0' && value >= 0 && std::isfinite(value)
                   ? std::string()
                   : text + " is no number from zero on";
      },
      "NONNEGATIVE");
}

}  // namespace aligngs
