// The result of a command as --json asks for it.
#pragma once

#include <cstdio>

#include "io/json_text.h"

namespace aligngs {

/// One JSON document on standard output; `Json` is nlohmann::json or ordered_json.
template <typename Json>
void print_json(const Json& document) {
  std::fputs(json_document(document).c_str(), stdout);
}

}  // namespace aligngs
