#include "scene/import/intrinsics.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

Intrinsics read(const std::string& text) {
  const auto file = std::filesystem::path(testing::TempDir()) / "intrinsics_test.txt";
  write_file_atomically(file, text);
  return read_intrinsics(file);
}

TEST(Intrinsics, AMatrixAndFourNumbersAreTheSame) {
  for (const char* text : {"500 0 320\n0 510 240\n0 0 1\n", "500 0 320 0\n0 510 240 0\n0 0 1 0\n0 0 0 1\n",
                           "# fx fy cx cy\n500, 510, 320, 240\n", "[[500. 0. 320.]\n [0. 510. 240.]\n [0. 0. 1.]]"}) {
    const Intrinsics lens = read(text);
    EXPECT_EQ(lens.fx, 500) << text;
    EXPECT_EQ(lens.fy, 510) << text;
    EXPECT_EQ(lens.cx, 320) << text;
    EXPECT_EQ(lens.cy, 240) << text;
  }
}

TEST(Intrinsics, OtherNumbersAreRefused) {
  for (const char* text : {"", "500 320 240", "0 0 320 240", "nan 500 320 240", "-500 0 320\n0 510 240\n0 0 1\n"})
    EXPECT_THROW(read(text), Error) << text;
}

TEST(Intrinsics, AMatrixIsRefusedForWhatItIs) {
  const auto fault_of = [](const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      return error.details().message;
    }
    return std::string();
  };
  EXPECT_THAT(fault_of("500 0 0\n0 510 0\n320 240 1\n"), HasSubstr("column-major"));
  EXPECT_THAT(fault_of("500 0 0 0\n0 510 0 0\n320 240 1 0\n0 0 0 1\n"), HasSubstr("column-major"));
  EXPECT_THAT(fault_of("500 5 320\n0 510 240\n0 0 1\n"), HasSubstr("skew"));
  EXPECT_THAT(fault_of("500 0 320\n0 510 240\n0 0 2\n"), HasSubstr("third row"));
  EXPECT_THAT(fault_of("500 0 320\n0 510 240\n0 0 nan\n"), HasSubstr("finite"));
  EXPECT_THAT(fault_of("500 510 320 240 0.2 -0.9 0.01 0 1"), HasSubstr("distortion")) << "with a lens behind";
  EXPECT_EQ(fault_of("500 1e-9 320\n0 510 240\n1e-12 0 1\n"), "") << "rounding";
}

TEST(Intrinsics, TextIsToldWhichNumbersToWrite) {
  try {
    read("Camera.fx: 500\n");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.details().remedy, HasSubstr("fx fy cx cy"));
  }
}

TEST(IntrinsicsMisfit, LensesAreAFewHundredthsOffTheMiddle) {
  EXPECT_EQ(misfit_of_intrinsics(318.6, 255.3, 640, 480), "");  // TUM freiburg1
  EXPECT_EQ(misfit_of_intrinsics(320, 240, 640, 480), "");
  EXPECT_EQ(misfit_of_intrinsics(0.45 * 640, 0.55 * 480, 640, 480), "");
  EXPECT_EQ(misfit_of_intrinsics(240, 320, 480, 640), "");
  EXPECT_EQ(misfit_of_intrinsics(0.55 * 90, 0.45 * 100, 90, 100), "");
}

TEST(IntrinsicsMisfit, APhotoThatWasCroppedOnOneSideFits) {
  EXPECT_EQ(misfit_of_intrinsics(320, 240, 480, 480), "");
  EXPECT_EQ(misfit_of_intrinsics(320, 240, 640, 360), "");
}

TEST(IntrinsicsMisfit, PhotosThatWereResizedDoNotFit) {
  EXPECT_THAT(misfit_of_intrinsics(648, 484, 864, 645), HasSubstr("photos of about 1296 x 968"));
  EXPECT_THAT(misfit_of_intrinsics(320, 240, 1280, 960), HasSubstr("photos of about 640 x 480"));
}

TEST(IntrinsicsMisfit, PhotosThatWereTurnedDoNotFit) {
  EXPECT_THAT(misfit_of_intrinsics(648, 484, 968, 1296), HasSubstr("turned by a quarter"));
  EXPECT_THAT(misfit_of_intrinsics(320, 240, 960, 1280), HasSubstr("turned by a quarter"));
}

TEST(IntrinsicsMisfit, APrincipalPointOutsideIsNamed) {
  EXPECT_THAT(misfit_of_intrinsics(160, 120, 32, 24), HasSubstr("(160, 120) lies outside of a photo of 32 x 24"));
}

}  // namespace
}  // namespace aligngs
