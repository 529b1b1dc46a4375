#include "fuzz_target.h"
#include "io/colmap_text.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using aligngs::accept_or_refuse;
  accept_or_refuse(data, size, [](const std::string& b) { aligngs::parse_colmap_cameras_text(b, "fuzz"); });
  accept_or_refuse(data, size, [](const std::string& b) { aligngs::parse_colmap_points_text(b, "fuzz"); });
  return accept_or_refuse(data, size, [](const std::string& b) { aligngs::parse_colmap_images_text(b, "fuzz"); });
}
