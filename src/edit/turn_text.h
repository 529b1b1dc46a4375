// Turns in words: "armchair by 90", "sofa a quarter turn to the left".
#pragma once

#include <optional>
#include <string>

namespace aligngs {

/// Takes a turn in degrees off the end of `text`, counter-clockwise seen from above. Nothing where the text ends
/// otherwise; Error{kUsage} for more than a circle. Examples are "by 90", "45 degrees clockwise", "a quarter turn to the
/// left".
std::optional<double> take_turn(std::string& text);

}  // namespace aligngs
