#include "edit/edit_change_file.h"
#include "fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) {
    const std::string again = aligngs::encode_change(aligngs::decode_change(bytes, "fuzz"));
    aligngs::decode_change(again, "fuzz");  // what was accepted reads back
  });
}
