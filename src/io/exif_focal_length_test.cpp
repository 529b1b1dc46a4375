#include "io/exif_focal_length.h"

#include <gtest/gtest.h>

namespace aligngs {
namespace {

/// EXIF with the focal length in millimetres and the resolution of the sensor, big endian as Canon
/// writes it.
std::string exif_with_sensor(unsigned focal, unsigned pixels_per_unit, unsigned unit) {
  std::string out("Exif\0\0MM\0\x2a", 10);
  const auto put16 = [&](unsigned v) { out += {char(v >> 8 & 0xff), char(v & 0xff)}; };
  const auto put32 = [&](unsigned v) {
    put16(v >> 16);
    put16(v & 0xffff);
  };
  const auto entry = [&](unsigned tag, unsigned format, unsigned value) {
    put16(tag);
    put16(format);
    put32(1);
    put32(value);
  };
  put32(8);
  put16(1);
  entry(0x8769, 4, 26);
  put32(0);
  put16(3);
  const unsigned values_at = 26 + 2 + 3 * 12 + 4;
  entry(0x920A, 5, values_at);
  entry(0xA20E, 5, values_at + 8);
  entry(0xA210, 3, unit << 16);
  put32(0);
  for (const unsigned v : {focal, 1u, pixels_per_unit, 1u}) put32(v);
  return out;
}

TEST(ExifFocalLength, WhatIsWrittenIsRead) { EXPECT_EQ(exif_focal_35mm(exif_with_focal_35mm(26.3), 4000), 26); }

TEST(ExifFocalLength, ComesFromTheSensorWhereItIsNotStated) {
  // 18 mm, 100 pixels per mm: 1800 pixels of 3500, of 35 mm film 18.
  const auto inches = exif_focal_35mm(exif_with_sensor(18, 2540, 2), 3500);
  ASSERT_TRUE(inches.has_value());
  EXPECT_NEAR(*inches, 18, 1e-9);
  const auto centimetres = exif_focal_35mm(exif_with_sensor(18, 1000, 3), 3500);
  ASSERT_TRUE(centimetres.has_value());
  EXPECT_NEAR(*centimetres, 18, 1e-9);
}

TEST(ExifFocalLength, NothingAndNonsenseAreEmpty) {
  EXPECT_FALSE(exif_focal_35mm("", 4000).has_value());
  EXPECT_FALSE(exif_focal_35mm("Exif", 4000).has_value());
  EXPECT_FALSE(exif_focal_35mm(exif_with_focal_35mm(0), 4000).has_value());
  EXPECT_FALSE(exif_focal_35mm(exif_with_sensor(18, 0, 2), 4000).has_value());
  const std::string whole = exif_with_focal_35mm(26);
  for (size_t size = 0; size < whole.size(); ++size)
    exif_focal_35mm(whole.substr(0, size), 4000);  // a truncated one may say anything but must end
}

}  // namespace
}  // namespace aligngs
