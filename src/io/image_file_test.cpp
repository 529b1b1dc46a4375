#include "io/image_file.h"

#include <gtest/gtest.h>
#include <turbojpeg.h>
#include <zlib.h>

#include <cmath>
#include <functional>
#include <memory>

#include "core/testing/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

std::filesystem::path image_folder() { return std::filesystem::path(testing::TempDir()) / "image_file_test"; }

std::string text_of(const std::vector<uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

/// 16 wide, 24 high, six flat 8x8 blocks of different brightness: no two orientations look the
/// same.
Image<uint8_t> blocks() {
  Image<uint8_t> image(16, 24, 3);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 16; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = uint8_t(20 + 40 * (x / 8 + 2 * (y / 8)));
    }
  }
  return image;
}

/// Inserts an EXIF segment that holds nothing but the orientation, right after the start-of-image
/// marker.
std::string with_exif(const std::string& jpeg, int orientation, bool big_endian) {
  const auto u16 = [&](int v) {
    const char high = char(v >> 8), low = char(v & 255);
    return big_endian ? std::string{high, low} : std::string{low, high};
  };
  const auto u32 = [&](int v) { return big_endian ? u16(0) + u16(v) : u16(v) + u16(0); };
  const std::string tiff = (big_endian ? "MM" : "II") + u16(42) + u32(8) +  // header, offset of the first directory
                           u16(1) +                                         // one entry
                           u16(0x0112) + u16(3) + u32(1) + u16(orientation) + u16(0) +  // orientation, SHORT, one value
                           u32(0);                                                      // no further directory
  const std::string content = std::string("Exif\0\0", 6) + tiff;
  const size_t length = content.size() + 2;
  return jpeg.substr(0, 2) + "\xff\xe1" + std::string{char(length >> 8), char(length & 255)} + content + jpeg.substr(2);
}

void expect_bad_photo(const std::function<void()>& action) {
  try {
    action();
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(error.details().path, "photo");
  }
}

TEST(Png, RoundTripsEveryChannelCount) {
  for (const int channels : {1, 3, 4}) {
    Image<uint8_t> image(5, 3, channels);
    for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = uint8_t(i * 7);
    write_png(image_folder() / "a.png", image);
    const Image<uint8_t> back = read_image(image_folder() / "a.png");
    ASSERT_EQ(back.channels, channels == 4 ? 4 : 3);
    ASSERT_EQ(back.width, 5);
    for (int c = 0; c < back.channels; ++c) EXPECT_EQ(back.at(4, 2, c), image.at(4, 2, channels == 1 ? 0 : c));
    EXPECT_EQ(read_image_info(image_folder() / "a.png").channels, channels);
  }
}

TEST(Png, RoundTripsSixteenBitValues) {
  Image<uint16_t> depth(3, 2, 1);
  depth.data = {0, 1, 255, 256, 40000, 65535};
  write_png16(image_folder() / "depth.png", depth);
  EXPECT_EQ(read_gray_png(image_folder() / "depth.png").data, depth.data);
  const ImageInfo info = read_image_info(image_folder() / "depth.png");
  EXPECT_EQ(info.bit_depth, 16);
  EXPECT_EQ(info.channels, 1);
  EXPECT_EQ(read_image(image_folder() / "depth.png").at(1, 1, 2), 40000 >> 8);
}

TEST(Png, GrayReaderKeepsEightBitLabels) {
  Image<uint8_t> labels(4, 1, 1);
  labels.data = {0, 7, 149, 255};
  EXPECT_EQ(decode_gray_png(text_of(encode_png(labels)), "").data, (std::vector<uint16_t>{0, 7, 149, 255}));
}

TEST(Png, GrayReaderGivesPaletteIndices) {
  // 8x1, 4 bits a pixel, palette of three colours; written by an independent encoder.
  const unsigned char file[] = {
      0x89, 'P',  'N',  'G',  13,   10,   26,   10,   0,    0,    0,    13,   'I',  'H',  'D',  'R',  0,    0,    0,
      8,    0,    0,    0,    1,    4,    3,    0,    0,    0,    0x11, 0x2e, 0xf2, 0x70, 0,    0,    0,    9,    'P',
      'L',  'T',  'E',  255,  0,    0,    0,    255,  0,    0,    0,    255,  0x2d, 0x4a, 0xcd, 0x8a, 0x00, 0x00, 0x00,
      0x0d, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0x54, 0x10, 0x52, 0x02, 0x00, 0x00, 0xaf, 0x00, 0x56, 0x29,
      0xaf, 0x4c, 0x9f, 0,    0,    0,    0,    'I',  'E',  'N',  'D',  0xae, 0x42, 0x60, 0x82};
  const std::string bytes(reinterpret_cast<const char*>(file), sizeof(file));
  EXPECT_EQ(decode_gray_png(bytes, "").data, (std::vector<uint16_t>{0, 1, 2, 0, 1, 2, 2, 2}));
  const Image<uint8_t> colors = decode_image(bytes, "");
  EXPECT_EQ(colors.at(2, 0, 2), 255);
  EXPECT_EQ(colors.at(2, 0, 0), 0);
}

TEST(Png, GrayReaderRefusesColourAndJpeg) {
  expect_bad_photo([] { decode_gray_png(text_of(encode_png(Image<uint8_t>(2, 2, 3))), "photo"); });
  expect_bad_photo([] { decode_gray_png(text_of(encode_jpeg(Image<uint8_t>(2, 2, 3))), "photo"); });
}

TEST(Jpeg, RoundTripsWithinCompressionLoss) {
  const Image<uint8_t> image = blocks();
  write_jpeg(image_folder() / "a.jpg", image, 95);
  const Image<uint8_t> back = read_image(image_folder() / "a.jpg");
  ASSERT_EQ(back.width, 16);
  ASSERT_EQ(back.height, 24);
  for (size_t i = 0; i < image.data.size(); ++i) EXPECT_NEAR(back.data[i], image.data[i], 2);
}

TEST(Jpeg, GrayIsWidenedAndAlphaDropped) {
  const Image<uint8_t> gray = decode_image(text_of(encode_jpeg(Image<uint8_t>(8, 8, 1, 77))), "");
  EXPECT_EQ(gray.channels, 3);
  EXPECT_EQ(gray.at(3, 3, 2), 77);
  EXPECT_EQ(decode_image(text_of(encode_jpeg(Image<uint8_t>(8, 8, 4, 77))), "").channels, 3);
}

TEST(Jpeg, EveryExifOrientationComesOutUpright) {
  const Image<uint8_t> upright = blocks();
  const int w = upright.width, h = upright.height;
  // Place of the stored row r and column c in the upright picture, from the EXIF table ("row 0 is
  // the visual ...").
  struct Case {
    int orientation;
    std::function<std::pair<int, int>(int, int)> upright_xy;
  };
  const std::vector<Case> cases = {
      {1, [&](int r, int c) { return std::pair(c, r); }},                  // top, left side
      {2, [&](int r, int c) { return std::pair(w - 1 - c, r); }},          // top, right side
      {3, [&](int r, int c) { return std::pair(w - 1 - c, h - 1 - r); }},  // bottom, right side
      {4, [&](int r, int c) { return std::pair(c, h - 1 - r); }},          // bottom, left side
      {5, [&](int r, int c) { return std::pair(r, c); }},                  // left side, top
      {6, [&](int r, int c) { return std::pair(w - 1 - r, c); }},          // right side, top
      {7, [&](int r, int c) { return std::pair(w - 1 - r, h - 1 - c); }},  // right side, bottom
      {8, [&](int r, int c) { return std::pair(r, h - 1 - c); }},          // left side, bottom
  };
  for (const Case& test : cases) {
    const bool swap = test.orientation >= 5;
    Image<uint8_t> stored(swap ? h : w, swap ? w : h, 3);
    for (int r = 0; r < stored.height; ++r) {
      for (int c = 0; c < stored.width; ++c) {
        const auto [x, y] = test.upright_xy(r, c);
        for (int k = 0; k < 3; ++k) stored.at(c, r, k) = upright.at(x, y, k);
      }
    }
    for (const bool big_endian : {false, true}) {
      const std::string bytes = with_exif(text_of(encode_jpeg(stored, 95)), test.orientation, big_endian);
      const Image<uint8_t> image = decode_image(bytes, "");
      ASSERT_EQ(image.width, w) << test.orientation;
      ASSERT_EQ(image.height, h);
      for (size_t i = 0; i < image.data.size(); ++i) ASSERT_NEAR(image.data[i], upright.data[i], 2) << test.orientation;
      write_file_atomically(image_folder() / "held.jpg", bytes);
      EXPECT_EQ(read_image_info(image_folder() / "held.jpg").width, w);
      EXPECT_EQ(read_image_info(image_folder() / "held.jpg").height, h);
    }
  }
}

TEST(Jpeg, StoredPixelsAreThoseWithoutTheTag) {
  const Image<uint8_t> stored = blocks();
  for (int orientation = 1; orientation <= 8; ++orientation) {
    for (const bool big_endian : {false, true}) {
      const std::string bytes = with_exif(text_of(encode_jpeg(stored, 95)), orientation, big_endian);
      write_file_atomically(image_folder() / "held.jpg", bytes);
      EXPECT_EQ(read_image_info(image_folder() / "held.jpg").stored_width, stored.width);
      EXPECT_EQ(read_image_info(image_folder() / "held.jpg").orientation, orientation);
      const Image<uint8_t> plain = decode_stored_image(bytes, "");
      EXPECT_EQ(plain.width, stored.width);
      EXPECT_NEAR(plain.at(15, 23, 0), stored.at(15, 23, 0), 2);
      const std::string unmarked = without_orientation(bytes, "");
      EXPECT_EQ(unmarked.size(), bytes.size());
      EXPECT_EQ(decode_image(unmarked, "").data, plain.data) << orientation;
    }
  }
}

TEST(Jpeg, NonsenseOrientationIsUpright) {
  for (const int orientation : {0, 9, 300}) {
    EXPECT_EQ(decode_image(with_exif(text_of(encode_jpeg(blocks())), orientation, false), "").width, 16);
  }
}

/// A CMYK picture as editors save it: inverted, with Adobe's segment.
std::string cmyk_jpeg(uint8_t cyan, uint8_t magenta, uint8_t yellow, uint8_t black) {
  Image<uint8_t> inks(16, 16, 4);
  for (size_t i = 0; i < inks.pixels(); ++i) {
    const uint8_t values[4] = {cyan, magenta, yellow, black};
    std::copy_n(values, 4, &inks.data[4 * i]);
  }
  const std::unique_ptr<void, int (*)(tjhandle)> handle(tjInitCompress(), tjDestroy);
  unsigned char* out = nullptr;
  unsigned long size = 0;
  EXPECT_EQ(tjCompress2(handle.get(), inks.data.data(), 16, 0, 16, TJPF_CMYK, &out, &size, TJSAMP_444, 95, 0), 0);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(out, tjFree);
  return {out, out + size};
}

TEST(Jpeg, CmykIsMultipliedOut) {
  const std::string bytes = cmyk_jpeg(200, 100, 255, 128);
  const Image<uint8_t> image = decode_image(bytes, "");
  ASSERT_EQ(image.channels, 3);
  EXPECT_NEAR(image.at(8, 8, 0), 100, 3);
  EXPECT_NEAR(image.at(8, 8, 1), 50, 3);
  EXPECT_NEAR(image.at(8, 8, 2), 128, 3);
  EXPECT_FALSE(is_common_picture(bytes, ""));
}

TEST(Jpeg, CmykWithoutAdobesSegmentIsInk) {
  std::string bytes = cmyk_jpeg(255, 255, 255, 255);
  const size_t adobe = bytes.find("\xff\xee");
  ASSERT_NE(adobe, std::string::npos);
  bytes.erase(adobe, 2 + 14);  // marker and segment
  EXPECT_LT(decode_image(bytes, "").at(8, 8, 1), 3);
}

TEST(Jpeg, ProgressiveIsRead) {
  const std::unique_ptr<void, int (*)(tjhandle)> handle(tjInitCompress(), tjDestroy);
  const Image<uint8_t> image = blocks();
  unsigned char* out = nullptr;
  unsigned long size = 0;
  ASSERT_EQ(tjCompress2(handle.get(), image.data.data(), 16, 0, 24, TJPF_RGB, &out, &size, TJSAMP_444, 95,
                        TJFLAG_PROGRESSIVE),
            0);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(out, tjFree);
  const std::string bytes(out, out + size);
  EXPECT_NEAR(decode_image(bytes, "").at(15, 23, 0), image.at(15, 23, 0), 2);
  EXPECT_TRUE(is_common_picture(bytes, ""));
}

TEST(ImageFile, TruncatedFilesAreErrors) {
  Image<uint8_t> noise(32, 32, 3);
  for (size_t i = 0; i < noise.data.size(); ++i) noise.data[i] = uint8_t(i * i * 31 + i / 7);
  for (const std::string& whole : {text_of(encode_jpeg(noise)), text_of(encode_png(noise))}) {
    EXPECT_NO_THROW(decode_image(whole, "photo"));
    for (const size_t keep : {whole.size() - 1, whole.size() - 2, whole.size() / 2, size_t(30), size_t(3), size_t(0)}) {
      expect_bad_photo([&] { decode_image(whole.substr(0, keep), "photo"); });
    }
  }
}

TEST(ImageFile, AJpegWithTrailingBytesIsRead) {
  EXPECT_EQ(decode_image(text_of(encode_jpeg(blocks())) + "preview data of a phone", "photo").height, 24);
}

TEST(ImageFile, AHeaderThatPromisesTooMuchIsRefusedBeforeAllocating) {
  std::string png = text_of(encode_png(Image<uint8_t>(20, 20, 3)));
  std::string jpeg = text_of(encode_jpeg(Image<uint8_t>(20, 20, 3)));
  for (size_t i = jpeg.find("\xff\xc0") + 5, k = 0; k < 4; ++k)
    jpeg[i + k] = char(k % 2 ? 0x20 : 0x4e);  // 20000 a side
  expect_bad_photo([&] { decode_image(jpeg, "photo"); });
  png.replace(16, 8, std::string("\0\0\x4e\x20\0\0\x4e\x20", 8));
  expect_bad_photo([&] { decode_image(png, "photo"); });
}

TEST(ImageFile, OtherFilesAreRefused) {
  write_file_atomically(image_folder() / "text.png", "this is no picture");
  EXPECT_THROW(read_image(image_folder() / "text.png"), Error);
  EXPECT_THROW(read_image_info(image_folder() / "text.png"), Error);
  EXPECT_THROW(read_image_info(image_folder() / "absent.png"), Error);
  EXPECT_THROW(read_image_info(image_folder()), Error);
}

TEST(ImageFile, InfoIsFoundBehindALargeProfile) {
  std::string jpeg = text_of(encode_jpeg(blocks()));
  std::string profile = "\xff\xe2\xff\xff" + std::string(65533, 'p');
  write_file_atomically(image_folder() / "profile.jpg", jpeg.substr(0, 2) + profile + profile + jpeg.substr(2));
  EXPECT_EQ(read_image_info(image_folder() / "profile.jpg").width, 16);
}

TEST(ImageFile, InfoOfALargePngNeedsOnlyItsBeginning) {
  Image<uint8_t> noise(300, 200, 3);
  uint32_t state = 1;
  for (uint8_t& value : noise.data) value = uint8_t((state = state * 1664525 + 1013904223) >> 24);
  const std::string png = text_of(encode_png(noise));
  ASSERT_GT(png.size(), 100000u);
  write_file_atomically(image_folder() / "large.png", png);
  EXPECT_EQ(read_image_info(image_folder() / "large.png").width, 300);
  // A private chunk of 100 kB between the header and the pixels, with its checksum.
  std::string chunk = std::string("\0\1\x86\xa0", 4) + "prVt" + std::string(100000, 'x');
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(chunk.data() + 4), unsigned(chunk.size() - 4));
  for (int shift = 24; shift >= 0; shift -= 8) chunk += char(crc >> shift & 255);
  constexpr size_t kEndOfHeader = 33;
  write_file_atomically(image_folder() / "chunk.png", png.substr(0, kEndOfHeader) + chunk + png.substr(kEndOfHeader));
  EXPECT_EQ(read_image_info(image_folder() / "chunk.png").height, 200);
  EXPECT_EQ(read_image(image_folder() / "chunk.png").data, noise.data);
}

TEST(ImageFile, FloatConversionsClampAndRound) {
  ImageF image(6, 1, 1);
  image.data = {-1, 0, 0.5f, 1, 2, NAN};
  EXPECT_EQ(to_bytes(image).data, (std::vector<uint8_t>{0, 0, 128, 255, 255, 0}));
  Image<uint8_t> all(256, 1, 1);
  for (int i = 0; i < 256; ++i) all.at(i, 0) = uint8_t(i);
  EXPECT_EQ(to_bytes(to_float(all)).data, all.data);
}

TEST(ImageFile, ATruncatedPngIsCalledTruncated) {
  Image<uint8_t> noise(32, 32, 3);
  for (size_t i = 0; i < noise.data.size(); ++i) noise.data[i] = uint8_t(i * i * 31 + i / 7);
  const std::string png = text_of(encode_png(noise));
  const std::string message =
      error_of(ErrorKind::kBadInput, [&] { decode_image(png.substr(0, png.size() / 2), "photo"); });
  EXPECT_NE(message.find("the picture is truncated"), std::string::npos) << message;
}

}  // namespace
}  // namespace aligngs
