#include "fuzz_target.h"
#include "serve/page_notes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size,
                                   [](const std::string& bytes) { aligngs::read_page_notes(bytes, "fuzz"); });
}
