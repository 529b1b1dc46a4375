#include "io/image_limits.h"

#include <string>

#include "core/error.h"
#include "io/damaged_file.h"

namespace aligngs {

void require_plausible_image(uint64_t width, uint64_t height, uint64_t file_bytes, double max_pixels_per_byte,
                             const std::filesystem::path& name) {
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  if (width == 0 || height == 0) throw_bad_input(name, "size", "the picture is empty (" + size + ")");
  if (width > uint64_t(kMaxImageSide) || height > uint64_t(kMaxImageSide) || width * height > kMaxImagePixels) {
    throw_bad_input(name, "size", size + " pixels are more than supported (65535 a side, 400 million in all)",
                    "scale the picture down");
  }
  if (double(width * height) > max_pixels_per_byte * double(file_bytes)) {
    throw_bad_input(name, "size", std::to_string(file_bytes) + " bytes cannot hold " + size + " pixels",
                    kDamagedFileRemedy);
  }
}

}  // namespace aligngs
