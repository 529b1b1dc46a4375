// Names of files in the two encodings that other people's archives hold.
#pragma once

#include <filesystem>
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
/// The characters of a text that is UTF-8, and back.
std::u32string characters_of_utf8(std::string_view text);
std::string utf8_of_characters(std::u32string_view characters);
/// Without the byte order mark that Windows programs put before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);
/// The same for the content of a file. Error{kBadInput} where its mark is that of UTF-16, or where it holds zero bytes.
/// UTF-16 without a mark has those, and so have files that a disk or a connection filled up.
std::string_view text_of_file(std::string_view content, const std::filesystem::path& file);

}  // namespace aligngs
