#include <gtest/gtest.h>

#include "core/error.h"
#include "nn/preprocess/normalised_image.h"
#include "nn/preprocess/opencv_resize.h"
#include "nn/preprocess/pillow_resize.h"
#include "nn/preprocess/vggt_images.h"

namespace aligngs::nn {
namespace {

Image<uint8_t> picture(int width, int height, int channels = 3) {
  Image<uint8_t> image(width, height, channels);
  for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = uint8_t(i * 2654435761u >> 13);
  return image;
}

TEST(Resize, TheSameSizeIsTheSameImage) {
  const Image<uint8_t> image = picture(17, 9);
  EXPECT_EQ(pillow_resize_bicubic(image, 17, 9).data, image.data);
  EXPECT_EQ(opencv_resize_linear(image, 17, 9).data, image.data);
}

TEST(Resize, AConstantImageStaysConstant) {
  const Image<uint8_t> image(13, 11, 3, 201);
  for (const auto& [width, height] : {std::pair(5, 29), std::pair(40, 4), std::pair(1, 1)}) {
    for (const uint8_t v : pillow_resize_bicubic(image, width, height).data) ASSERT_EQ(v, 201);
    for (const uint8_t v : opencv_resize_linear(image, width, height).data) ASSERT_EQ(v, 201);
  }
}

TEST(Resize, NothingCannotBeResized) {
  EXPECT_THROW(pillow_resize_bicubic(picture(3, 3), 0, 3), Error);
  EXPECT_THROW(opencv_resize_linear(Image<uint8_t>(), 3, 3), Error);
}

TEST(RgbOnWhite, AlphaDecidesBetweenImageAndWhite) {
  Image<uint8_t> rgba(2, 1, 4);
  rgba.data = {10, 20, 30, 255, 10, 20, 30, 0};
  EXPECT_EQ(pillow_rgb_on_white(rgba).data, (std::vector<uint8_t>{10, 20, 30, 255, 255, 255}));
}

TEST(RgbOnWhite, GreyBecomesRgb) {
  EXPECT_EQ(pillow_rgb_on_white(Image<uint8_t>(1, 1, 1, 7)).data, (std::vector<uint8_t>{7, 7, 7}));
}

TEST(VggtImages, SidesAreMultiplesOfThePatchAndThePlacementFits) {
  for (const auto& [width, height] : {std::pair(640, 480), std::pair(480, 640), std::pair(50, 51)}) {
    for (const VggtFit fit : {VggtFit::kCrop, VggtFit::kPad}) {
      VggtPlacement place;
      const Image<uint8_t> image = vggt_image(picture(width, height), fit, &place);
      EXPECT_EQ(image.width, 518);
      EXPECT_EQ(image.height % 14, 0);
      EXPECT_LE(image.height, 518);
      // The middle of the photograph is the middle of the result, within a pixel of rounding.
      EXPECT_NEAR(place.scale_x * width / 2 + place.offset_x, image.width / 2.0, 1);
      EXPECT_NEAR(place.scale_y * height / 2 + place.offset_y, image.height / 2.0, 1);
    }
  }
}

TEST(VggtImages, AnExtremelyWideImageKeepsOnePatchOfHeight) {
  EXPECT_EQ(vggt_image(picture(1000, 2), VggtFit::kCrop).height, 14);
}

TEST(VggtImages, TheSizeIsKnownBeforeThePhotoIsRead) {
  for (const VggtFit fit : {VggtFit::kCrop, VggtFit::kPad}) {
    for (const auto& [width, height] : {std::pair{640, 480}, {480, 640}, {1600, 900}, {2000, 40}}) {
      const Image<uint8_t> image = vggt_image(Image<uint8_t>(width, height, 3, 9), fit);
      const ImageSize size = vggt_image_size(width, height, fit);
      EXPECT_EQ(size.width, image.width) << width << " x " << height;
      EXPECT_EQ(size.height, image.height) << width << " x " << height;
    }
  }
}

TEST(SegmentationImage, TheShortSideDecidesWithinTheLongOne) {
  EXPECT_EQ(segmentation_image(picture(64, 48), {99999999, 96, 0}).width, 128);
  EXPECT_EQ(segmentation_image(picture(64, 48), {100, 96, 0}).width, 100);
  const Image<uint8_t> multiple = segmentation_image(picture(64, 48), {99999999, 90, 32});
  EXPECT_EQ(multiple.width, 128);
  EXPECT_EQ(multiple.height, 96);
}

TEST(CentrePadded, ZerosSurroundTheImage) {
  FeatureMap image(3, 4, 1);
  for (float& v : image.data) v = 1;
  const FeatureMap padded = centre_padded(image, 7);
  EXPECT_EQ(padded.height, 7);
  EXPECT_EQ(padded.width, 7);
  EXPECT_EQ(padded.at(1, 1)[0], 0);
  EXPECT_EQ(padded.at(2, 1)[0], 1);
  EXPECT_EQ(padded.at(4, 4)[0], 1);
  EXPECT_EQ(padded.at(5, 4)[0], 0);
}

}  // namespace
}  // namespace aligngs::nn
