// Lines of events.ndjson as the JSON array that the page reads.
#pragma once

#include <string>
#include <string_view>

namespace aligngs {

/// "[{...},{...}]" of the lines that are JSON objects; "[]" when none is. A line that is torn (a writer was killed, a
/// disk was full) or nested deeply is left out, and the others stay.
std::string event_array(std::string_view lines);

}  // namespace aligngs
