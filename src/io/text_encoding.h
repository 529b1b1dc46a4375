// Names of files in the two encodings that other people's archives hold.
#pragma once

#include <string>
#include <string_view>

namespace aligngs {

bool is_utf8(std::string_view text);
/// Each byte taken as a character of ISO 8859-1 (latin-1).
std::string utf8_of_latin1(std::string_view text);
/// The text itself when it is UTF-8, else as latin-1: always valid UTF-8.
std::string as_utf8(std::string_view text);
/// Empty when a character has no place in latin-1, or when the text is no UTF-8.
std::string latin1_of_utf8(std::string_view text);
/// Without the byte order mark that Windows programs put before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);

}  // namespace aligngs
