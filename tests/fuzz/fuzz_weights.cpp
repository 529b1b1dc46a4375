// Weight files of every layout, each tensor read.
#include "fuzz_target.h"
#include "io/weight_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](const std::string& bytes) {
    const auto file = aligngs::WeightFile::from_memory(bytes, "fuzz");
    for (const auto& tensor : file->tensors()) file->read(tensor.first);
  });
}
