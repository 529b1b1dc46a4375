#include "io/exif_focal_length.h"

#include <libexif/exif-data.h>

#include <cmath>
#include <memory>

namespace aligngs {
namespace {

/// Lenses of cameras and phones lie far inside; anything else is a slip of the writer.
constexpr double kShortest = 3, kLongest = 3000;  // mm
/// COLMAP's rule: focal length in pixels = this fraction of the longer side.
constexpr double kFilmSide = 35;  // mm

double number_in(ExifData* data, ExifIfd ifd, ExifTag tag) {
  const ExifEntry* entry = exif_content_get_entry(data->ifd[ifd], tag);
  if (!entry || entry->components != 1) return 0;
  const ExifByteOrder order = exif_data_get_byte_order(data);
  if (entry->format == EXIF_FORMAT_SHORT && entry->size >= 2) return exif_get_short(entry->data, order);
  if (entry->format == EXIF_FORMAT_RATIONAL && entry->size >= 8) {
    const ExifRational r = exif_get_rational(entry->data, order);
    return r.denominator == 0 ? 0 : double(r.numerator) / double(r.denominator);
  }
  return 0;
}

bool sensible(double millimetres) { return millimetres >= kShortest && millimetres <= kLongest; }

void append16(std::string& out, unsigned value) {
  out += char(value & 0xff);
  out += char(value >> 8 & 0xff);
}
void append32(std::string& out, unsigned value) {
  append16(out, value & 0xffff);
  append16(out, value >> 16);
}

}  // namespace

std::optional<double> exif_focal_35mm(std::string_view exif, int longer_side) {
  constexpr size_t kMaxSegment = 65535;  // bytes: a JPEG segment holds no more
  if (exif.empty() || exif.size() > kMaxSegment) return {};
  const std::unique_ptr<ExifData, void (*)(ExifData*)> data(exif_data_new(), exif_data_unref);
  if (!data) return {};
  exif_data_unset_option(data.get(),
                         EXIF_DATA_OPTION_FOLLOW_SPECIFICATION);  // read only, repair nothing
  exif_data_load_data(data.get(), reinterpret_cast<const unsigned char*>(exif.data()),
                      static_cast<unsigned>(exif.size()));
  const auto number = [&](ExifTag tag) { return number_in(data.get(), EXIF_IFD_EXIF, tag); };
  const double stated = number(EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM);
  if (sensible(stated)) return stated;
  const double unit = number(EXIF_TAG_FOCAL_PLANE_RESOLUTION_UNIT);  // 2: inch, 3: centimetre
  const double per_mm = number(EXIF_TAG_FOCAL_PLANE_X_RESOLUTION) / (unit == 3 ? 10 : 25.4);
  const double pixels = number(EXIF_TAG_FOCAL_LENGTH) * per_mm;
  const double computed = longer_side > 0 ? pixels / longer_side * kFilmSide : 0;
  if (sensible(computed)) return computed;
  return {};
}

std::string exif_with_focal_35mm(double millimetres) {
  constexpr unsigned kExifIfdTag = 0x8769, kLong = 4, kShort = 3, kExifIfdAt = 26;
  std::string out("Exif\0\0II\x2a\0", 10);
  append32(out, 8);  // offset of the first directory from "II"
  append16(out, 1);
  append16(out, kExifIfdTag);
  append16(out, kLong);
  append32(out, 1);
  append32(out, kExifIfdAt);
  append32(out, 0);  // no further directory
  append16(out, 1);
  append16(out, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM);
  append16(out, kShort);
  append32(out, 1);
  append32(out, static_cast<unsigned>(std::lround(millimetres)));
  append32(out, 0);
  return out;
}

}  // namespace aligngs
