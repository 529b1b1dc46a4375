// JSON as text, in one place: the writer and the parser are compiled once, and neither throws.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace aligngs {

/// One line, without a line break at its end. Bytes that are no UTF-8 (the name of a file may have them) become U+FFFD,
/// numbers that are not finite null.
std::string json_line(const nlohmann::json& value);
std::string json_line(const nlohmann::ordered_json& value);

/// The same for files and people: two spaces a level, and a line break at the end.
std::string json_document(const nlohmann::json& value);
std::string json_document(const nlohmann::ordered_json& value);

/// The value of a text; `is_discarded()` where the text is no JSON. Python writes NaN, Infinity and -Infinity, although
/// JSON has no such words. They become texts. A reader of numbers refuses these, and does not take them for absent.
nlohmann::json parse_json(std::string_view text);
nlohmann::ordered_json parse_ordered_json(std::string_view text);  // objects keep the order of their members

/// The text as long as it was, with blanks for comments (// and /* */) and for a comma before a closing bracket. People
/// write them, although JSON has none.
std::string without_comments(std::string_view text);

/// The first fault of a text that is no JSON: "line 3, column 5", or "a number beyond all".
std::string place_of_json_fault(std::string_view text);

}  // namespace aligngs
