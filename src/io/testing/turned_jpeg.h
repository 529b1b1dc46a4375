// Photos that were held another way, for tests.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/jpeg_codec.h"

namespace aligngs {

/// The file with an EXIF block that has nothing but the orientation, 1 to 8.
inline std::string turned_jpeg(const std::vector<uint8_t>& jpeg, int orientation) {
  std::string exif("Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x01\0\0\0\0\0\0", 32);
  exif[25] = static_cast<char>(orientation);
  return with_exif(jpeg, exif);
}

}  // namespace aligngs
