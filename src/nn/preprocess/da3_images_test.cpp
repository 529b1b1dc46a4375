#include "nn/preprocess/da3_images.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "nn/preprocess/opencv_area_resize.h"
#include "nn/preprocess/opencv_cubic_resize.h"
#include "nn/preprocess/pillow_resize.h"

namespace aligngs::nn {
namespace {

TEST(Da3Images, CommonShapesGetThePublishedSizes) {
  struct Size {
    int width, height, expected_width, expected_height;
  };
  for (const Size& s : {Size{4032, 3024, 504, 378}, Size{3000, 2000, 504, 336}, Size{1920, 1080, 504, 280},
                        Size{600, 800, 378, 504}, Size{100, 80, 504, 406}}) {
    ImagePlacement where;
    const Image<uint8_t> image = da3_image(Image<uint8_t>(s.width, s.height, 3, 7), {}, &where);
    EXPECT_EQ(image.width, s.expected_width);
    EXPECT_EQ(image.height, s.expected_height);
    EXPECT_NEAR(where.scale_x * s.width, image.width, 1e-9);
    EXPECT_NEAR(where.scale_y * s.height, image.height, 1e-9);
  }
}

TEST(Da3Images, TheSizeIsKnownBeforeThePhotoIsRead) {
  for (const Da3ImageOptions& options : {Da3ImageOptions{}, Da3ImageOptions{56, true, true}}) {
    for (const auto& [width, height] : {std::pair{640, 480}, {480, 640}, {1600, 900}, {504, 378}}) {
      const Image<uint8_t> image = da3_image(Image<uint8_t>(width, height, 3, 9), options);
      const ImageSize size = da3_image_size(width, height, options);
      EXPECT_EQ(size.width, image.width) << width << " x " << height;
      EXPECT_EQ(size.height, image.height) << width << " x " << height;
    }
  }
}

TEST(Da3Images, CutImagesKeepTheirMiddle) {
  ImagePlacement where;
  const Image<uint8_t> image = da3_image(Image<uint8_t>(504, 301, 3), {504, false, true}, &where);
  EXPECT_EQ(image.height, 294);
  EXPECT_EQ(where.offset_y, -3);
  EXPECT_EQ(where.scale_y, 1);
}

TEST(Da3Images, ABatchIsCutToWhatAllHave) {
  std::vector<Image<uint8_t>> images = {Image<uint8_t>(504, 378, 3), Image<uint8_t>(378, 504, 3)};
  std::vector<ImagePlacement> where(2);
  da3_common_size(images, &where);
  for (const Image<uint8_t>& image : images) {
    EXPECT_EQ(image.width, 378);
    EXPECT_EQ(image.height, 378);
  }
  EXPECT_EQ(where[0].offset_x, -63);
  EXPECT_EQ(where[1].offset_y, -63);
}

TEST(Da3Images, AlphaIsDroppedAndGreyRepeated) {
  Image<uint8_t> rgba(28, 28, 4, 50);
  EXPECT_EQ(da3_image(rgba, {28}).data, (Image<uint8_t>(28, 28, 3, 50).data));
  EXPECT_EQ(da3_image(Image<uint8_t>(28, 28, 1, 9), {28}).data, (Image<uint8_t>(28, 28, 3, 9).data));
}

TEST(Da3Images, StripsAreRefused) {
  EXPECT_THROW(da3_image(Image<uint8_t>(5000, 20, 3)), Error);
  EXPECT_THROW(da3_image(Image<uint8_t>()), Error);
}

TEST(Da3Images, ResizesKeepAConstantImage) {
  const Image<uint8_t> image(13, 11, 3, 201);
  for (const uint8_t v : opencv_resize_area(image, 5, 4).data) ASSERT_EQ(v, 201);
  for (const uint8_t v : opencv_resize_cubic(image, 40, 7).data) ASSERT_EQ(v, 201);
  for (const uint8_t v : pillow_resize_bilinear(image, 5, 29).data) ASSERT_EQ(v, 201);
  EXPECT_THROW(opencv_resize_area(image, 14, 4), Error);
}

TEST(Da3Images, AnAreaResizeByWholeNumbersIsTheMean) {
  Image<uint8_t> image(4, 2, 1);
  image.data = {1, 2, 10, 20, 3, 5, 30, 41};
  EXPECT_EQ(opencv_resize_area(image, 2, 1).data, (std::vector<uint8_t>{3, 25}));
}

}  // namespace
}  // namespace aligngs::nn
