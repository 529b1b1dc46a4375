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

/// Seeds: whole numbers from zero on that any number of a JSON file holds.
inline CLI::Validator seed_number() {
  return CLI::Validator(
      [](const std::string& text) {
        constexpr unsigned long long kLargest = 9007199254740992;  // two to the 53rd
        const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
        return digits && text.size() < 17 && std::strtoull(text.c_str(), nullptr, 10) <= kLargest
                   ? std::string()
                   : text + " is no whole number from 0 to " + std::to_string(kLargest);
      },
      "SEED");
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
