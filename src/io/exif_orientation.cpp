#include "io/exif_orientation.h"

#include <libexif/exif-data.h>

#include <algorithm>
#include <memory>
#include <utility>

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
  if (!entry || entry->format != EXIF_FORMAT_SHORT || entry->components != 1 || entry->size < 2) return 1;
  const int value = exif_get_short(entry->data, exif_data_get_byte_order(data.get()));
  return value >= 1 && value <= 8 ? value : 1;
}

bool set_exif_upright(std::string& bytes, size_t begin, size_t size) {
  // "Exif\0\0", then TIFF (revision 6.0): byte order, 42, offset of the first directory. A directory is a count and
  // entries of tag, type, number of values, value.
  constexpr size_t kPrefix = 6, kEntry = 12, kTag = 0x0112, kShort = 3;
  if (begin > bytes.size() || size > bytes.size() - begin || size < kPrefix + 8) return false;
  const size_t tiff = begin + kPrefix, end = begin + size;
  const bool big = bytes[tiff] == 'M';
  const auto number = [&](size_t at, size_t count) {
    size_t value = 0;
    for (size_t i = 0; i < count; ++i) value = value << 8 | uint8_t(bytes[at + (big ? i : count - 1 - i)]);
    return value;
  };
  const size_t offset = number(tiff + 4, 4);
  if (offset > size || tiff + offset + 2 > end) return false;
  const size_t directory = tiff + offset, entries = number(directory, 2);
  for (size_t i = 0; i < entries; ++i) {
    const size_t entry = directory + 2 + kEntry * i;
    if (entry + kEntry > end) return false;
    if (number(entry, 2) != kTag || number(entry + 2, 2) != kShort || number(entry + 4, 4) != 1) continue;
    bytes[entry + 8] = char(big ? 0 : 1);
    bytes[entry + 9] = char(big ? 1 : 0);
    return true;
  }
  return false;
}

namespace {

template <class T>
Image<T> turned_upright(Image<T> stored, int orientation) {
  if (orientation <= 1 || orientation > 8) return stored;
  const bool swap = orientation_swaps_sides(orientation);
  const int width = swap ? stored.height : stored.width, height = swap ? stored.width : stored.height;
  // Mirrored axes of the stored picture, along its own axes, after the exchange of axes is undone.
  const bool flip_x = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool flip_y = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  Image<T> upright(width, height, stored.channels);
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

}  // namespace

Image<uint8_t> apply_orientation(Image<uint8_t> stored, int orientation) {
  return turned_upright(std::move(stored), orientation);
}

ImageF apply_orientation(ImageF stored, int orientation) { return turned_upright(std::move(stored), orientation); }

}  // namespace aligngs
