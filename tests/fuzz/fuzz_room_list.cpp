#include "batch/room_list.h"
#include "fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  aligngs::accept_or_refuse(data, size, [](const std::string& bytes) { aligngs::parse_room_table(bytes, "fuzz"); });
  return aligngs::accept_or_refuse(data, size,
                                   [](const std::string& bytes) { aligngs::parse_room_toml(bytes, "fuzz"); });
}
