#include "edit/edit_operation.h"
#include "fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) {
    const auto edits = aligngs::parse_edits(bytes, "fuzz");
    aligngs::parse_edits(aligngs::edits_text(edits), "fuzz");  // what was accepted is written so that it reads back
  });
}
