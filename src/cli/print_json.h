// The result of a command as --json asks for it.
#pragma once

#include <cstdio>
#include <string>

#include "cli/command.h"
#include "io/json_text.h"

namespace aligngs {

/// One JSON document on standard output; `Json` is nlohmann::json or ordered_json.
template <typename Json>
void print_json(const Json& document) {
  std::fputs(json_document(document).c_str(), stdout);
}

/// One result in both forms: the document with --json, else the text for people.
template <typename Json>
void print_result(const CommandContext& context, const Json& document, const std::string& text) {
  if (context.global.json)
    print_json(document);
  else
    std::fputs(text.c_str(), stdout);
}

}  // namespace aligngs
