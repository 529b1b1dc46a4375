#include "io/jpeg_warnings.h"

#include <gtest/gtest.h>

#include "core/testing/error.h"
#include "io/image_file.h"
#include "io/jpeg_segments.h"

namespace aligngs {
namespace {

/// A JPEG of 64 x 96 pixels, all different.
std::string noisy_jpeg() {
  Image<uint8_t> image(64, 96, 3);
  uint32_t state = 1;
  for (uint8_t& value : image.data) {
    state = state * 1664525u + 1013904223u;
    value = uint8_t(state >> 24);
  }
  const std::vector<uint8_t> bytes = encode_jpeg(image);
  return {bytes.begin(), bytes.end()};
}

/// The scan holds more than the header promises: libjpeg skips the rest, as after a bit error.
std::string with_half_height(std::string jpeg) {
  SegmentWalker walker(jpeg);
  uint8_t marker = 0;
  std::string_view content;
  while (walker.next(marker, content) && !is_frame_header(marker)) {
  }
  jpeg[size_t(content.data() - jpeg.data()) + 2] = 48;
  return jpeg;
}

std::string before_end(std::string jpeg, const std::string& bytes) { return jpeg.insert(jpeg.size() - 2, bytes); }

/// Bytes behind the first segment.
std::string with_odd_header(std::string jpeg) {
  SegmentWalker walker(jpeg);
  uint8_t marker = 0;
  std::string_view content;
  walker.next(marker, content);
  return jpeg.insert(walker.position(), "\x01\x02\x03");
}

void expect_damage(const std::string& jpeg) {
  const std::string message = error_of(ErrorKind::kBadInput, [&] { decode_image(jpeg, "a.jpg"); });
  EXPECT_NE(message.find("Corrupt JPEG data"), std::string::npos) << message;
}

TEST(JpegWarnings, PixelsThatTheDecoderSkipsAreDamage) { expect_damage(with_half_height(noisy_jpeg())); }

TEST(JpegWarnings, ABrokenScanIsDamage) {
  std::string jpeg = noisy_jpeg();
  for (size_t i = jpeg.size() / 2; i < jpeg.size() / 2 + 200; ++i) jpeg[i] = '\x55';
  EXPECT_THROW(decode_image(jpeg, "a.jpg"), Error);
}

TEST(JpegWarnings, FillingBeforeTheEndIsHarmless) {
  EXPECT_EQ(decode_image(before_end(noisy_jpeg(), std::string(400, '\0')), "a.jpg").data,
            decode_image(noisy_jpeg(), "a.jpg").data);
}

TEST(JpegWarnings, AFewBytesBeforeTheEndAreHarmless) {
  EXPECT_EQ(decode_image(before_end(noisy_jpeg(), "abc"), "a.jpg").data, decode_image(noisy_jpeg(), "a.jpg").data);
}

TEST(JpegWarnings, ManyDifferentBytesBeforeTheEndAreDamage) {
  expect_damage(before_end(noisy_jpeg(), "not one of these bytes is like the others"));
}

TEST(JpegWarnings, BytesBetweenHeadersAreHarmless) {
  EXPECT_EQ(decode_image(with_odd_header(noisy_jpeg()), "a.jpg").data, decode_image(noisy_jpeg(), "a.jpg").data);
}

TEST(JpegWarnings, BytesBetweenHeadersHideNoDamage) { expect_damage(with_odd_header(with_half_height(noisy_jpeg()))); }

TEST(JpegWarnings, AnUnknownColourTransformIsHarmless) {
  EXPECT_FALSE(means_damage("Unknown Adobe color transform code 7", {}));
}

TEST(JpegWarnings, PlainHeadersStayAsTheyAre) { EXPECT_EQ(without_odd_headers(noisy_jpeg()), noisy_jpeg()); }

}  // namespace
}  // namespace aligngs
