// Turns in words: "armchair by 90", "sofa a quarter turn to the left".
#pragma once

#include <optional>
#include <string>

namespace aligngs {

/// Takes a turn in degrees off the end of `text`, counter-clockwise seen from above: "by 90", "45 degrees clockwise",
/// "anticlockwise by 30 degrees", "three quarters of a turn to the left". Nothing where the text ends otherwise;
/// Error{kUsage} for more than a circle.
std::optional<double> take_turn(std::string& text);

}  // namespace aligngs
