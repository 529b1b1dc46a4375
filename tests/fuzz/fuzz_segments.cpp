// Segments of a photo: a PNG whose numbers must be classes that the label set has.
#include "file_input.h"
#include "fuzz_target.h"
#include "scene/segment_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace aligngs;
  return accept_or_refuse(data, size, [](const std::string& bytes) { read_segments(FileInput(bytes).path(), 150); });
}
