#include "fuzz_target.h"
#include "io/toml_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) { aligngs::parse_toml(bytes, "fuzz"); });
}
