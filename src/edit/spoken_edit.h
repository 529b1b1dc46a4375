// Edits as people say them: "could you get rid of the bed, please?" is "delete the bed".
#pragma once

#include <string>

namespace aligngs {

/// The sentence without "please", "could you" and the like at its ends.
std::string without_courtesy(std::string text);

/// The sentence with a verb of edit_text.h first. Courtesies go. "Get rid of", "take away", "throw out", "erase" and
/// "hide" are "delete". "Clear the table" is "delete everything on the table". "Take the pillow off the bed" is "delete
/// the pillow on the bed". "Show only" is "keep". "Make" and "turn" with a colour at the end are "recolor", and so is
/// "change the colour of". "Put", "shift" and "slide" are "move". "Half a metre" is "0.5 metre". Other sentences stay as
/// they are, and so do those of describe().
std::string plain_edit(std::string text);

}  // namespace aligngs
