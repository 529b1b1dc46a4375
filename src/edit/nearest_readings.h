// Suggestions for a sentence that is not understood: "delte bedd" may be "delete bed".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "edit/edit_text.h"
#include "edit/vocabulary.h"

namespace aligngs {

/// Up to three sentences that parse_edit() reads and whose names the vocabulary knows, nearest first. Verbs and names
/// that are understood stay as they are. Empty where the text is understood, and where nothing is near.
std::vector<std::string> nearest_readings(std::string_view text, const Vocabulary& vocabulary);

/// The error of a sentence that was not understood, with its nearest readings as the remedy.
Error with_readings(const Error& error, std::string_view text, const Vocabulary& vocabulary);

/// Reads a sentence (edit_text.h) and the names of its selection. Error{kUsage} with the nearest readings for what is not
/// understood.
EditRequest read_request(std::string_view text, const Vocabulary& vocabulary);

}  // namespace aligngs
