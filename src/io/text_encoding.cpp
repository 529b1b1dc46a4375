#include "io/text_encoding.h"

#include <cstddef>
#include <cstdint>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr uint32_t kBad = 0xffffffff;

/// The next character (RFC 3629), `kBad` for bytes that are none.
uint32_t next_character(std::string_view text, size_t& at) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  const uint8_t first = byte(at++);
  if (first < 0x80) return first;
  const int more = first >= 0xc2 && first <= 0xdf   ? 1
                   : (first & 0xf0) == 0xe0         ? 2
                   : first >= 0xf0 && first <= 0xf4 ? 3
                                                    : 0;
  if (more == 0 || at + more > text.size()) return kBad;
  uint32_t code = first & (0x3f >> more);
  for (int i = 0; i < more; ++i) {
    if ((byte(at) & 0xc0) != 0x80) return kBad;
    code = code << 6 | (byte(at++) & 0x3f);
  }
  const bool overlong = (more == 2 && code < 0x800) || (more == 3 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return overlong || surrogate || code > 0x10ffff ? kBad : code;
}

}  // namespace

bool is_utf8(std::string_view text) {
  for (size_t at = 0; at < text.size();) {
    if (next_character(text, at) == kBad) return false;
  }
  return true;
}

std::string utf8_of_latin1(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<uint8_t>(c);
    if (byte < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xc0 | byte >> 6);
      out += static_cast<char>(0x80 | (byte & 0x3f));
    }
  }
  return out;
}

std::string as_utf8(std::string_view text) { return is_utf8(text) ? std::string(text) : utf8_of_latin1(text); }

std::string latin1_of_utf8(std::string_view text) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    const uint32_t code = next_character(text, at);
    if (code > 0xff) return {};
    out += static_cast<char>(code);
  }
  return out;
}

std::u32string characters_of_utf8(std::string_view text) {
  std::u32string out;
  for (size_t at = 0; at < text.size();) out += static_cast<char32_t>(next_character(text, at));
  return out;
}

std::string utf8_of_characters(std::u32string_view characters) {
  std::string out;
  const auto add = [&](char32_t bits) { out += static_cast<char>(bits); };
  for (const char32_t c : characters) {
    if (c < 0x80) {
      add(c);
      continue;
    }
    if (c < 0x800) {
      add(0xc0 | c >> 6);
    } else {
      if (c < 0x10000) {
        add(0xe0 | c >> 12);
      } else {
        add(0xf0 | c >> 18);
        add(0x80 | (c >> 12 & 0x3f));
      }
      add(0x80 | (c >> 6 & 0x3f));
    }
    add(0x80 | (c & 0x3f));
  }
  return out;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  if (text.substr(0, kMark.size()) == kMark) text.remove_prefix(kMark.size());
  return text;
}

std::string_view text_of_file(std::string_view content, const std::filesystem::path& file) {
  for (const std::string_view mark : {"\xff\xfe", "\xfe\xff"}) {
    if (content.substr(0, mark.size()) == mark) throw_bad_input(file, "", "this text is in UTF-16", "save it as UTF-8");
  }
  if (content.find('\0') != std::string_view::npos)
    throw_bad_input(file, "", "this text holds zero bytes: it is in UTF-16, or damaged",
                    "save it as UTF-8, or copy the file again");
  return without_byte_order_mark(content);
}

}  // namespace aligngs
