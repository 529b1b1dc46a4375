#include "fuzz_target.h"
#include "io/exif_focal_length.h"
#include "io/exif_orientation.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return aligngs::accept_or_refuse(data, size, [](std::string bytes) {
    aligngs::exif_focal_35mm(bytes, 4000);
    const int orientation = aligngs::exif_orientation(bytes);
    if (orientation < 1 || orientation > 8) __builtin_trap();
    aligngs::set_exif_upright(bytes, 0, bytes.size());
  });
}
