// The JSON body of a request, looked at before anything reads it.
#pragma once

#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace aligngs {

/// Brackets in brackets that a request of the page may have; the page itself sends one level.
constexpr int kDeepestRequest = 8;
/// The same for files of a run: cameras.json has four levels, the description of a scene five.
constexpr int kDeepestFile = 32;

/// Deepest nesting of objects and arrays in a JSON text; brackets in strings do not count.
int json_depth(std::string_view text);

/// Why a body is refused, in words for the answer; nothing when it is good. Reading deeper JSON would use up the stack.
std::optional<std::string> json_fault(std::string_view body, int deepest = kDeepestRequest);

/// A request with exactly the named fields, all of them texts of at most `longest` bytes. Error{kUsage} for others.
nlohmann::json text_fields(const std::string& body, std::initializer_list<const char*> fields, size_t longest = 4096);

}  // namespace aligngs
