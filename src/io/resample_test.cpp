#include "io/resample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::ElementsAre;
using testing::FloatNear;
using testing::Pointwise;

ImageF row(std::vector<float> values) {
  ImageF image(int(values.size()), 1, 1);
  image.data = std::move(values);
  return image;
}

/// f(x, y) = 2x + 3y at pixel centres, in units of the whole picture.
ImageF ramp(int width, int height) {
  ImageF image(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at(x, y) = 2 * (x + 0.5f) / width + 3 * (y + 0.5f) / height;
  }
  return image;
}

TEST(Resample, TheSameSizeIsTheSamePicture) {
  const ImageF image = ramp(7, 5);
  EXPECT_EQ(resize_bilinear(image, 7, 5).data, image.data);
  EXPECT_EQ(resize_area(image, 7, 5).data, image.data);
  EXPECT_EQ(resize_depth(image, 7, 5).data, image.data);
}

TEST(Resample, ALinearRampStaysInPlace) {
  for (const auto& [w, h] : {std::pair{20, 16}, {5, 4}, {13, 3}}) {
    const ImageF expected = ramp(w, h);
    const ImageF bilinear = resize_bilinear(ramp(10, 8), w, h), area = resize_area(ramp(10, 8), w, h);
    for (int y = 1; y + 1 < h; ++y) {  // at the border bilinear sampling repeats the last pixel
      for (int x = 1; x + 1 < w; ++x) {
        EXPECT_NEAR(bilinear.at(x, y), expected.at(x, y), 1e-5);
        EXPECT_NEAR(area.at(x, y), expected.at(x, y), 1e-5);
      }
    }
  }
}

TEST(Resample, BytesGiveWhatTheirFloatsGive) {
  Image<uint8_t> bytes(13, 9, 3);
  for (size_t i = 0; i < bytes.data.size(); ++i) bytes.data[i] = uint8_t(i * 37);
  ImageF floats(13, 9, 3);
  for (size_t i = 0; i < bytes.data.size(); ++i) floats.data[i] = float(bytes.data[i]) / 255.0f;
  for (const auto& [w, h] : {std::pair{5, 4}, {13, 9}, {20, 3}, {30, 25}})
    EXPECT_EQ(resize_area(bytes, w, h).data, resize_area(floats, w, h).data);
}

TEST(Resample, AreaAveragesWhatEachPixelCovers) {
  EXPECT_THAT(resize_area(row({1, 3, 5, 9}), 2, 1).data, ElementsAre(2, 7));
  EXPECT_THAT(resize_area(row({1, 2, 4}), 2, 1).data,
              Pointwise(FloatNear(1e-6f), {(1 + 0.5f * 2) / 1.5f, (0.5f * 2 + 4) / 1.5f}));
  EXPECT_THAT(resize_area(ramp(6, 1), 6, 4).data[6], FloatNear(ramp(6, 1).data[0], 1e-6f));  // grows in y only
}

TEST(Resample, OnePixelBecomesAConstant) {
  for (const float value : resize_bilinear(ImageF(1, 1, 1, 0.3f), 4, 3).data) EXPECT_FLOAT_EQ(value, 0.3f);
}

TEST(Resample, ChannelsAreIndependent) {
  ImageF image(2, 1, 2);
  image.data = {0, 10, 1, 20};
  EXPECT_THAT(resize_bilinear(image, 1, 1).data, ElementsAre(0.5f, 15));
}

TEST(ResizeDepth, InterpolatesOnASurface) {
  EXPECT_THAT(resize_depth(row({2.00f, 2.04f}), 4, 1).data, Pointwise(FloatNear(1e-6f), {2.00f, 2.01f, 2.03f, 2.04f}));
}

TEST(ResizeDepth, NeverMixesTwoSurfaces) {
  EXPECT_THAT(resize_depth(row({1, 3}), 4, 1).data, ElementsAre(1, 1, 3, 3));
  EXPECT_THAT(resize_depth(row({3, 1}), 1, 1).data,
              ElementsAre(1));  // a tie goes to the nearer surface
}

TEST(ResizeDepth, InvalidSamplesCountForNothing) {
  EXPECT_THAT(resize_depth(row({2, NAN}), 1, 1).data, ElementsAre(2));
  EXPECT_THAT(resize_depth(row({INFINITY, 0, -1, NAN}), 2, 1).data, ElementsAre(0, 0));
}

TEST(ResizeNearest, TakesThePixelUnderTheCentre) {
  Image<uint8_t> labels(4, 1, 1);
  labels.data = {1, 2, 3, 4};
  EXPECT_THAT(resize_nearest(labels, 2, 1).data, ElementsAre(2, 4));
  EXPECT_THAT(resize_nearest(labels, 8, 1).data, ElementsAre(1, 1, 2, 2, 3, 3, 4, 4));
}

TEST(Resample, EmptyPicturesAreErrors) {
  EXPECT_THROW(resize_bilinear(ImageF(), 2, 2), Error);
  EXPECT_THROW(resize_area(ImageF(2, 2, 1), 0, 2), Error);
  EXPECT_THROW(resize_depth(ImageF(2, 2, 3), 2, 2), Error);
}

}  // namespace
}  // namespace aligngs
