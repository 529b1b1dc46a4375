// One spelling for names that file systems write differently.
#pragma once

#include <string>
#include <string_view>

namespace aligngs {

/// The name with every letter in its decomposed form, and ASCII letters in lower case. macOS decomposes names
/// ("u" and a diaeresis for one "ü"), other systems do not, and some do not tell cases apart. Two names of one file
/// have equal forms. Letters are those of Latin, Vietnamese, Greek, Cyrillic, kana and Hangul (Unicode 15, form NFD
/// for one mark after another in the order written). Bytes that are no UTF-8 count as latin-1.
std::string common_spelling(std::string_view name);

}  // namespace aligngs
