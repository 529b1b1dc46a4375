#include "fuzz_target.h"
#include "io/colmap.h"
#include "split_input.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) {
    const auto [cameras, images, points] = aligngs::split_input(bytes);
    aligngs::decode_colmap_binary(cameras, images, points, "fuzz");
  });
}
