#include "edit/named_selection.h"
#include "fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) {
    const auto selections = aligngs::parse_named_selections(bytes, "fuzz");
    const std::string text = aligngs::named_selections_text(selections);
    // the text of accepted selections reads back
    if (aligngs::named_selections_text(aligngs::parse_named_selections(text, "fuzz")) != text) __builtin_trap();
  });
}
