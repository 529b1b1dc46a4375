#include "fuzz_target.h"
#include "io/npz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) { aligngs::decode_npz(bytes, "fuzz"); });
}
