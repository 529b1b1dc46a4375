// Integers of JSON within the range of their type.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

namespace aligngs {

/// The integer that a value holds, also as 3.0; none for a fraction, a number beyond the range of T, and whatever is no
/// number. The library's get<T>() cuts fractions, wraps integers and has no defined result for 1e308.
template <std::integral T, class Json>
std::optional<T> integer_in(const Json& value) {
  if (value.is_number_unsigned()) {
    const auto number = value.template get<uint64_t>();
    return std::in_range<T>(number) ? std::optional(static_cast<T>(number)) : std::nullopt;
  }
  if (value.is_number_integer()) {
    const auto number = value.template get<int64_t>();
    return std::in_range<T>(number) ? std::optional(static_cast<T>(number)) : std::nullopt;
  }
  constexpr double kLargestWhole = 9007199254740992.0;  // 2^53: up to there doubles have every integer
  const double number = value.is_number() ? value.template get<double>() : NAN;
  if (!(std::abs(number) <= kLargestWhole) || number != std::trunc(number)) return std::nullopt;
  const auto whole = static_cast<int64_t>(number);
  return std::in_range<T>(whole) ? std::optional(static_cast<T>(whole)) : std::nullopt;
}

/// The same; throws std::out_of_range where there is none.
template <std::integral T, class Json>
T integer_of(const Json& value) {
  if (const std::optional<T> number = integer_in<T>(value)) return *number;
  throw std::out_of_range("not an integer of the expected range");
}

/// The integer of an object's member, else `otherwise`: where it is absent or none of the range.
template <std::integral T, class Json>
T integer_member(const Json& object, const char* name, T otherwise = 0) {
  const auto it = object.find(name);
  return it != object.end() ? integer_in<T>(*it).value_or(otherwise) : otherwise;
}

}  // namespace aligngs
