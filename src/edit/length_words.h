// Lengths as people write them: "two hundred cm", "1/2 m", "5' 6\"".
#pragma once

#include <string>

namespace aligngs {

/// The same text with decimal numbers and units of motion_text.h: "200 cm", "0.5 m", "66 in". Words that are no lengths
/// stay. A quotation mark means feet or inches where the text has one of its kind.
std::string with_plain_lengths(std::string text);

}  // namespace aligngs
