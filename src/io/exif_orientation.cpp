#include "io/exif_orientation.h"

#include <libexif/exif-data.h>

#include <algorithm>
#include <memory>

namespace aligngs {

int exif_orientation(std::string_view exif) {
  constexpr size_t kMaxSegment = 65535;  // bytes: a JPEG segment holds no more
  if (exif.size() > kMaxSegment) return 1;
  const std::unique_ptr<ExifData, void (*)(ExifData*)> data(exif_data_new(), exif_data_unref);
  if (!data) return 1;
  exif_data_unset_option(data.get(),
                         EXIF_DATA_OPTION_FOLLOW_SPECIFICATION);  // read only, repair nothing
  exif_data_load_data(data.get(), reinterpret_cast<const unsigned char*>(exif.data()),
                      static_cast<unsigned>(exif.size()));
  const ExifEntry* entry = exif_content_get_entry(data->ifd[EXIF_IFD_0], EXIF_TAG_ORIENTATION);
  if (!entry || entry->format != EXIF_FORMAT_SHORT || entry->components != 1 || entry->size < 2)
    return 1;
  const int value = exif_get_short(entry->data, exif_data_get_byte_order(data.get()));
  return value >= 1 && value <= 8 ? value : 1;
}

Image<uint8_t> apply_orientation(Image<uint8_t> stored, int orientation) {
  if (orientation <= 1 || orientation > 8) return stored;
  const bool swap = orientation_swaps_sides(orientation);
  const int width = swap ? stored.height : stored.width,
            height = swap ? stored.width : stored.height;
  // Where the stored picture is mirrored, along its own axes, after the exchange of axes is undone.
  const bool flip_x = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool flip_y = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  Image<uint8_t> upright(width, height, stored.channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int sx = swap ? y : x, sy = swap ? x : y;
      if (flip_x) sx = stored.width - 1 - sx;
      if (flip_y) sy = stored.height - 1 - sy;
      std::copy_n(stored.pixel(sx, sy), stored.channels, upright.pixel(x, y));
    }
  }
  return upright;
}

}  // namespace aligngs
