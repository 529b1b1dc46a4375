#include "io/webp_codec.h"

#include <gtest/gtest.h>
#include <webp/encode.h>

#include <memory>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"

namespace aligngs {
namespace {

/// 6 x 4, every pixel another colour.
Image<uint8_t> colours(int channels) {
  Image<uint8_t> image(6, 4, channels);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = uint8_t(7 * i + 3);
  return image;
}

std::string lossless(const Image<uint8_t>& image) {
  uint8_t* out = nullptr;
  const size_t size = image.channels == 4
                          ? WebPEncodeLosslessRGBA(image.data.data(), image.width, image.height, 4 * image.width, &out)
                          : WebPEncodeLosslessRGB(image.data.data(), image.width, image.height, 3 * image.width, &out);
  const std::unique_ptr<uint8_t, void (*)(void*)> owner(out, WebPFree);
  return {reinterpret_cast<char*>(out), size};
}

std::string little_endian(size_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += char(value >> (8 * i) & 255);
  return text;
}

std::string riff(const std::string& chunks) { return "RIFF" + little_endian(chunks.size() + 4, 4) + "WEBP" + chunks; }

/// The extended form: features, the picture, EXIF at the end.
std::string with_orientation(const std::string& simple, int width, int height, int orientation,
                             const std::string& prefix) {
  const std::string tiff =
      std::string("II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", 18) + char(orientation) + std::string(7, '\0');
  const std::string exif = prefix + tiff;
  const std::string features = "VP8X" + little_endian(10, 4) + little_endian(0x08, 4) +
                               little_endian(size_t(width - 1), 3) + little_endian(size_t(height - 1), 3);
  return riff(features + simple.substr(12) + "EXIF" + little_endian(exif.size(), 4) + exif);
}

TEST(Webp, LosslessPixelsComeBack) {
  EXPECT_EQ(decode_image(lossless(colours(3)), "").data, colours(3).data);
  const Image<uint8_t> image = colours(3);
  EXPECT_EQ(decode_webp(lossless(image), "").width, 6);
}

TEST(Webp, TransparencyIsAFourthChannel) {
  Image<uint8_t> image = colours(4);
  for (size_t i = 3; i < image.data.size(); i += 4) image.data[i] = i % 8 == 3 ? 255 : 128;
  const Image<uint8_t> back = decode_image(lossless(image), "");
  ASSERT_EQ(back.channels, 4);
  EXPECT_EQ(back.data, image.data);
}

TEST(Webp, OrientationIsReadWithAndWithoutThePrefixOfJpeg) {
  for (const std::string& prefix : {std::string(), std::string("Exif\0\0", 6)}) {
    const std::string bytes = with_orientation(lossless(colours(3)), 6, 4, 6, prefix);
    const Image<uint8_t> upright = decode_image(bytes, "");
    EXPECT_EQ(upright.width, 4);
    EXPECT_EQ(upright.height, 6);
    EXPECT_EQ(decode_stored_image(bytes, "").data, colours(3).data);
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "webp_codec_test.webp";
    write_file_atomically(file, bytes);
    EXPECT_EQ(read_image_info(file).width, 4);
    EXPECT_EQ(read_image_info(file).stored_width, 6);
  }
}

TEST(Webp, WithoutOrientationTheStoredPixelsRemain) {
  const std::string plain = without_orientation(with_orientation(lossless(colours(3)), 6, 4, 6, ""), "");
  EXPECT_EQ(decode_image(plain, "").data, colours(3).data);
}

TEST(Webp, AnAnimationIsRefused) {
  const std::string animation = riff("VP8X" + little_endian(10, 4) + little_endian(0x02, 4) + little_endian(5, 3) +
                                     little_endian(3, 3) + "ANIM" + little_endian(6, 4) + std::string(6, '\0'));
  EXPECT_THROW(decode_image(animation, "photo"), Error);
}

TEST(Webp, ACutFileIsRefused) {
  const std::string whole = lossless(colours(3));
  for (const size_t keep : {whole.size() - 1, whole.size() / 2, size_t(13)})
    EXPECT_THROW(decode_image(whole.substr(0, keep), "photo"), Error) << keep;
}

}  // namespace
}  // namespace aligngs
