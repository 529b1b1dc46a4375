#include "priors/photo_folder.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/exif_focal_length.h"
#include "io/heif_codec.h"
#include "io/image_file.h"
#include "io/jpeg_codec.h"
#include "scene/photo_mask.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class PhotoFolder : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("photos_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  std::vector<LeftOut> left_out;
  static Image<uint8_t> picture(int width, int height, int channels = 3) {
    Image<uint8_t> image(width, height, channels, 90);
    image.at(0, 0) = 255;
    return image;
  }
  std::string error_of_list() const {
    try {
      list_photos(folder);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      return error.what();
    }
    return "";
  }
  /// A JPEG whose EXIF says that the camera was held on its side (orientation 6).
  void write_turned(const fs::path& file, int width, int height) const {
    const std::vector<uint8_t> jpeg = encode_jpeg(picture(width, height));
    const std::string exif(
        "\xff\xe1\x00\x22"
        "Exif\0\0"
        "MM\0*\0\0\0\x08"
        "\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0",
        36);
    std::string bytes(jpeg.begin(), jpeg.end());
    write_file_atomically(file, bytes.substr(0, 2) + exif + bytes.substr(2));
  }

  fs::path folder;
};

TEST_F(PhotoFolder, PhotosComeInTheOrderOfPeople) {
  for (const char* name : {"10.jpg", "2.jpg", "1.JPG"}) write_jpeg(folder / name, picture(20, 16));
  const std::vector<Photo> photos = list_photos(folder).photos;
  ASSERT_EQ(photos.size(), 3u);
  EXPECT_EQ(photos[0].name, "1");
  EXPECT_EQ(photos[1].name, "2");
  EXPECT_EQ(photos[2].name, "10");
}

TEST_F(PhotoFolder, AFolderNamedImagesIsFound) {
  fs::create_directories(folder / "images");
  for (const char* name : {"a.png", "b.png"}) write_png(folder / "images" / name, picture(20, 16));
  EXPECT_EQ(list_photos(folder).photos.size(), 2u);
  EXPECT_TRUE(has_photos(folder));
}

TEST_F(PhotoFolder, PhotosInAFormatThatIsNotReadAreNamed) {
  std::ofstream(folder / "IMG_1.DNG") << "x";
  EXPECT_THAT(error_of_list(), testing::HasSubstr("IMG_1.DNG"));
}

TEST_F(PhotoFolder, PhotosOfATelephoneBecomeJpegWithTheirFocalLength) {
  const fs::path pictures = fs::path(ALIGNGS_SOURCE_DIR) / "tests/data/pictures";
  if (!can_decode_heif()) GTEST_SKIP() << "built without libheif";
  fs::copy_file(pictures / "plain.heic", folder / "IMG_1.HEIC");
  fs::copy_file(pictures / "turned.heic", folder / "IMG_2.HEIC");
  ThreadPool pool(2);
  const std::vector<Photo> prepared = prepare_photos(list_photos(folder).photos, folder / "work", 1600, pool, left_out);
  ASSERT_EQ(prepared.size(), 2u);
  EXPECT_EQ(prepared[0].file, folder / "work" / "IMG_1.jpg");
  const std::string bytes = read_file(prepared[0].file);
  EXPECT_TRUE(is_common_picture(bytes, ""));
  EXPECT_EQ(exif_focal_35mm(exif_of_picture(bytes, ""), 96), 28);
  EXPECT_EQ(read_image(prepared[1].file).width, 96);
}

TEST_F(PhotoFolder, MasksComeAlongUprightAndWhiteWhereThereIsNone) {
  write_turned(folder / "a.jpg", 40, 24);
  write_jpeg(folder / "b.jpg", picture(40, 24));
  Image<uint8_t> mask(40, 24, 1);
  mask.at(0, 0) = 255;  // of the stored pixels; upright, it is the upper right one
  write_png(folder / "masks" / "a.png", mask);
  ThreadPool pool(2);
  const std::vector<Photo> prepared =
      prepare_photos(list_photos(folder).photos, folder / "work" / "images", 1600, pool, left_out);
  ASSERT_EQ(prepared.size(), 2u);
  const Image<uint8_t> turned = read_image(folder / "work" / "masks" / "a.jpg.png"),
                       white = read_image(folder / "work" / "masks" / "b.jpg.png");
  EXPECT_EQ(find_mask(prepared[0].file), folder / "work" / "masks" / "a.jpg.png");
  EXPECT_EQ(turned.width, 24);
  EXPECT_EQ(turned.at(23, 0), 255);
  EXPECT_EQ(turned.at(0, 0), 0);
  EXPECT_EQ(white.at(5, 5), 255);
}

TEST_F(PhotoFolder, ANameThatLiesAboutTheFormatIsNoTrouble) {
  if (!can_decode_heif()) GTEST_SKIP() << "built without libheif";
  fs::copy_file(fs::path(ALIGNGS_SOURCE_DIR) / "tests/data/pictures/plain.heic", folder / "a.jpg");
  write_jpeg(folder / "b.jpg", picture(20, 16));
  ThreadPool pool(1);
  const std::vector<Photo> prepared = prepare_photos(list_photos(folder).photos, folder / "work", 1600, pool, left_out);
  EXPECT_TRUE(is_common_picture(read_file(prepared[0].file), ""));
}

TEST_F(PhotoFolder, TwoPhotosOfOneNameAreRefused) {
  write_jpeg(folder / "a.jpg", picture(20, 16));
  write_png(folder / "a.png", picture(20, 16));
  EXPECT_THAT(error_of_list(), testing::HasSubstr("same name"));
}

TEST_F(PhotoFolder, FilesThatCannotBeUsedAreLeftOutWithALine) {
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) write_jpeg(folder / name, picture(40, 32));
  std::ofstream(folder / "._a.jpg") << "what macOS keeps beside a photo";
  std::ofstream(folder / "empty.jpg").flush();
  const std::string whole = read_file(folder / "a.jpg");
  std::ofstream(folder / "cut.jpg", std::ios::binary) << whole.substr(0, whole.size() / 2);
  const PhotoList list = list_photos(folder);
  EXPECT_EQ(list.photos.size(), 3u);
  ASSERT_EQ(list.left_out.size(), 3u);
  EXPECT_THAT(list.left_out[0].reason, testing::HasSubstr("hidden"));
  EXPECT_THAT(list.left_out[1].reason, testing::HasSubstr("truncated"));
}

TEST_F(PhotoFolder, SubfoldersCountWhereTheFolderItselfHasNoPhotos) {
  for (const char* side : {"left", "right"}) {
    fs::create_directories(folder / side);
    write_jpeg(folder / side / "1.jpg", picture(20, 16));
  }
  const PhotoList list = list_photos(folder);
  ASSERT_EQ(list.photos.size(), 2u);
  EXPECT_EQ(list.photos[1].name, "right/1");
  ThreadPool pool(1);
  EXPECT_EQ(prepare_photos(list.photos, folder / "work", 100, pool, left_out)[0].file,
            folder / "work" / "left" / "1.jpg");
  EXPECT_TRUE(fs::exists(folder / "work" / "left" / "1.jpg"));
}

TEST_F(PhotoFolder, AnEmptyFolderAndOnePhotoAreRefused) {
  EXPECT_THAT(error_of_list(), testing::HasSubstr("no photo here"));
  write_jpeg(folder / "a.jpg", picture(20, 16));
  EXPECT_THAT(error_of_list(), testing::HasSubstr("one photo"));
}

TEST_F(PhotoFolder, APictureThatIsNoneIsNamed) {
  write_jpeg(folder / "a.jpg", picture(20, 16));
  std::ofstream(folder / "b.jpg") << "not a picture";
  EXPECT_THAT(error_of_list(), testing::HasSubstr("b.jpg"));
}

TEST_F(PhotoFolder, UprightPhotosAreCopiedAsTheyAre) {
  write_jpeg(folder / "a.jpg", picture(20, 16));
  write_png(folder / "b.png", picture(20, 16, 4));
  ThreadPool pool(2);
  const auto prepared = prepare_photos(list_photos(folder).photos, folder / "work", 1600, pool, left_out);
  EXPECT_EQ(read_file(prepared[0].file), read_file(folder / "a.jpg"));
  EXPECT_EQ(read_file(prepared[1].file), read_file(folder / "b.png"));
}

TEST_F(PhotoFolder, TurnedPhotosAreMadeUpright) {
  write_turned(folder / "a.jpg", 40, 24);
  write_jpeg(folder / "b.jpg", picture(40, 24));
  ThreadPool pool(2);
  const std::vector<Photo> photos = list_photos(folder).photos;
  EXPECT_EQ(photos[0].width, 24);
  EXPECT_EQ(photos[0].height, 40);
  const auto prepared = prepare_photos(photos, folder / "work", 1600, pool, left_out);
  const Image<uint8_t> image = read_image(prepared[0].file);
  EXPECT_EQ(image.width, 24);
  EXPECT_NE(read_file(prepared[0].file), read_file(folder / "a.jpg"));
}

TEST_F(PhotoFolder, LargePhotosAreShrunkToTheLongerSide) {
  write_jpeg(folder / "a.jpg", picture(200, 100));
  write_png(folder / "b.png", picture(100, 200, 4));
  ThreadPool pool(1);
  const auto prepared = prepare_photos(list_photos(folder).photos, folder / "work", 50, pool, left_out);
  EXPECT_EQ(prepared[0].width, 50);
  EXPECT_EQ(prepared[0].height, 25);
  const Image<uint8_t> second = read_image(prepared[1].file);
  EXPECT_EQ(second.width, 25);
  EXPECT_EQ(second.channels, 4);
}

TEST_F(PhotoFolder, AShrunkPhotoKeepsItsFocalLength) {
  for (const char* const name : {"a.jpg", "b.jpg"}) {
    std::ofstream(folder / name, std::ios::binary)
        << with_exif(encode_jpeg_bytes(picture(200, 100), 90), exif_with_focal_35mm(24));
  }
  ThreadPool pool(1);
  const fs::path file = prepare_photos(list_photos(folder).photos, folder / "work", 50, pool, left_out)[0].file;
  const std::string bytes = read_file(file);
  EXPECT_EQ(exif_focal_35mm(parse_jpeg_header(bytes, file).exif, 50), 24);
  EXPECT_EQ(read_image(file).width, 50);
}

TEST_F(PhotoFolder, APhotoWithDamagedPixelsIsLeftOutOfWhatIsPrepared) {
  write_jpeg(folder / "good.jpg", picture(64, 48));
  std::string damaged = read_file(folder / "good.jpg");
  damaged.insert(damaged.size() - 2, "not one of these bytes is like the others");
  write_file_atomically(folder / "bad.jpg", damaged);
  ThreadPool pool(1);
  const auto prepared = prepare_photos(list_photos(folder).photos, folder / "work", 1600, pool, left_out);
  ASSERT_EQ(prepared.size(), 1u);
  ASSERT_EQ(left_out.size(), 1u);
  EXPECT_THAT(left_out[0].reason, testing::HasSubstr("Corrupt JPEG data"));
}

TEST_F(PhotoFolder, APngWithADamagedChunkIsLeftOutOfWhatIsPrepared) {
  write_png(folder / "good.png", picture(64, 48));
  std::string damaged = read_file(folder / "good.png");
  damaged[damaged.find("IDAT") + 10] ^= 1;
  write_file_atomically(folder / "bad.png", damaged);
  ThreadPool pool(1);
  EXPECT_EQ(prepare_photos(list_photos(folder).photos, folder / "work", 1600, pool, left_out).size(), 1u);
}

TEST_F(PhotoFolder, APhotoWhoseMaskCannotBeReadIsLeftOutWithItsMask) {
  write_jpeg(folder / "a.jpg", picture(64, 48));
  write_jpeg(folder / "b.jpg", picture(64, 48));
  write_file_atomically(folder / "masks" / "b.png", "");
  ThreadPool pool(1);
  prepare_photos(list_photos(folder).photos, folder / "work" / "images", 1600, pool, left_out);
  ASSERT_EQ(left_out.size(), 1u);
  EXPECT_THAT(left_out[0].reason, testing::HasSubstr("masks/b.png"));
}

TEST_F(PhotoFolder, WhoFindsCamerasDoesNotSeeAPhotoThatIsLeftOut) {
  write_jpeg(folder / "a.jpg", picture(64, 48));
  write_jpeg(folder / "b.jpg", picture(64, 48));
  write_file_atomically(folder / "masks" / "b.png", "");
  ThreadPool pool(1);
  prepare_photos(list_photos(folder).photos, folder / "work" / "images", 1600, pool, left_out);
  EXPECT_FALSE(fs::exists(folder / "work" / "images" / "b.jpg"));
}

/// The error of a list where its folder of photos may not be read, as somebody without the rights of root meets it.
class BarredList : public PhotoFolder {
 protected:
  std::string error_with(const fs::path& photos) {
    folder = fs::temp_directory_path() / ("aligngs_barred_list_" + std::to_string(::getpid()));
    const fs::path barred = folder / photos;
    fs::create_directories(barred);
    write_jpeg(barred / "a.jpg", picture(64, 48));
    fs::permissions(barred, fs::perms::none);
    constexpr uid_t kStranger = 65534;
    const bool root = ::geteuid() == 0;
    EXPECT_TRUE(!root || ::seteuid(kStranger) == 0);
    const std::string message = error_of_list();
    EXPECT_TRUE(!root || ::seteuid(0) == 0);
    fs::permissions(barred, fs::perms::owner_all);
    fs::remove_all(folder);
    return message;
  }
};

TEST_F(BarredList, AFolderOfPhotosThatMayNotBeReadIsNamed) {
  EXPECT_THAT(error_with("images"), testing::HasSubstr("images: this place may not be read: Permission denied"));
}

TEST_F(BarredList, ASubfolderThatMayNotBeReadIsNamed) {
  EXPECT_THAT(error_with("left"), testing::HasSubstr("left: this place may not be read: Permission denied"));
}

}  // namespace
}  // namespace aligngs
