#include "serve/byte_range.h"

#include <algorithm>
#include <charconv>

namespace aligngs {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// Digits alone; nothing for other text and for numbers beyond 64 bits.
std::optional<uint64_t> number_of(std::string_view text) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.empty()) return {};
  return value;
}

}  // namespace

AskedRange asked_range(std::string_view range, std::string_view if_range, std::string_view etag, uint64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  const AskedRange whole;
  if (!if_range.empty() && trimmed(if_range) != etag) return whole;
  if (range.substr(0, kUnit.size()) != kUnit) return whole;
  const std::string_view asked = trimmed(range.substr(kUnit.size()));
  const size_t dash = asked.find('-');
  if (dash == std::string_view::npos || asked.find(',') != std::string_view::npos) return whole;
  const std::string_view from = trimmed(asked.substr(0, dash)), to = trimmed(asked.substr(dash + 1));
  const AskedRange beyond{AskedRange::Kind::kBeyondTheFile, {}};
  if (from.empty()) {
    const auto last = number_of(to);
    if (!last) return whole;
    const uint64_t count = std::min(*last, size);
    if (count == 0) return beyond;
    return {AskedRange::Kind::kPart, {size - count, count}};
  }
  const auto first = number_of(from);
  const auto last = to.empty() ? std::optional<uint64_t>(UINT64_MAX) : number_of(to);
  if (!first || !last || *last < *first) return whole;
  if (*first >= size) return beyond;
  return {AskedRange::Kind::kPart, {*first, std::min(*last, size - 1) - *first + 1}};
}

std::string content_range(const ByteRange& bytes, uint64_t size) {
  return "bytes " + std::to_string(bytes.first) + "-" + std::to_string(bytes.first + bytes.count - 1) + "/" +
         std::to_string(size);
}

bool names_etag(std::string_view if_none_match, std::string_view etag) {
  constexpr std::string_view kWeak = "W/";
  while (!if_none_match.empty()) {
    const std::string_view item = if_none_match.substr(0, if_none_match.find(','));
    if_none_match.remove_prefix(std::min(if_none_match.size(), item.size() + 1));
    std::string_view name = trimmed(item);
    if (name == "*") return true;
    if (name.substr(0, kWeak.size()) == kWeak) name.remove_prefix(kWeak.size());
    if (name == etag) return true;
  }
  return false;
}

}  // namespace aligngs
