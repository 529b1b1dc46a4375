#include "refine/patch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace aligngs {
namespace {

ImageF noise(int width, int height) {
  Random random(5);
  ImageF image(width, height, 1);
  for (float& v : image.data) v = static_cast<float>(random.uniform(0, 1));
  return image;
}

/// Three pixels in a row, expected between those of the photo.
Patch small_patch() {
  Patch patch;
  patch.value = {-0.7f, 0.1f, 0.6f};
  patch.place = {{4.25, 3.75}, {5.25, 3.75}, {6.5, 3.5}};
  patch.centre = patch.place[1];
  return patch;
}

double bilinear(const ImageF& image, Vec2d at) {
  const int x = static_cast<int>(std::floor(at.x - 0.5)), y = static_cast<int>(std::floor(at.y - 0.5));
  const double a = at.x - 0.5 - x, b = at.y - 0.5 - y;
  return (1 - b) * ((1 - a) * image.at(x, y) + a * image.at(x + 1, y)) +
         b * ((1 - a) * image.at(x, y + 1) + a * image.at(x + 1, y + 1));
}

TEST(ShiftedScores, AreCorrelations) {
  const ImageF image = noise(16, 12);
  const Patch patch = small_patch();
  ShiftedScores scores(patch, image);
  for (const auto& [dx, dy] : {std::pair{0, 0}, std::pair{-2, 3}, std::pair{5, -1}}) {
    double mean = 0, dot = 0, variance = 0, values[3];
    for (size_t i = 0; i < 3; ++i)
      mean += (values[i] = bilinear(image, {patch.place[i].x + dx, patch.place[i].y + dy})) / 3;
    for (size_t i = 0; i < 3; ++i) {
      dot += static_cast<double>(patch.value[i]) * values[i];
      variance += (values[i] - mean) * (values[i] - mean);
    }
    EXPECT_NEAR(scores.at(dx, dy), dot / std::sqrt(variance), 1e-5) << dx << ", " << dy;
  }
}

TEST(ShiftedScores, ARowIsWhatSingleShiftsAre) {
  const Patch patch = small_patch();
  for (const int width : {16, 37}) {
    const ImageF image = noise(width, 12);
    const ShiftedScores scores(patch, image);
    for (int dy = -6; dy <= 12; ++dy) {
      double row[31];
      scores.row(-15, 31, dy, row);
      for (int k = 0; k < 31; ++k) EXPECT_EQ(row[k], scores.at(k - 15, dy)) << width << ", " << k << ", " << dy;
    }
  }
}

TEST(ShiftedScores, EverySecondIsWhatSingleShiftsAre) {
  const Patch patch = small_patch();
  for (const int width : {8, 16, 37, 70}) {
    const ImageF image = noise(width, 29);
    const ShiftedScores scores(patch, image);
    for (const int reach : {1, 2, 8, 15, 16, 17, 30, 33}) {
      const std::vector<double> square = scores.every_second(reach);
      size_t i = 0;
      for (int dy = -reach; dy <= reach; dy += 2) {
        for (int dx = -reach; dx <= reach; dx += 2)
          EXPECT_EQ(square.at(i++), scores.at(dx, dy)) << width << ", " << reach << ", " << dx << ", " << dy;
      }
      EXPECT_EQ(i, square.size());
    }
  }
}

TEST(ShiftedScores, OutsideOfThePhotoThereIsNoScore) {
  const ImageF image = noise(16, 12);
  Patch patch = small_patch();
  ShiftedScores scores(patch, image);
  EXPECT_GT(scores.at(-3, -3), ShiftedScores::kOutside);
  EXPECT_EQ(scores.at(-4, 0), ShiftedScores::kOutside);  // the first pixel's left neighbour would be column -1
  EXPECT_EQ(scores.at(0, -4), ShiftedScores::kOutside);
  EXPECT_GT(scores.at(8, 0), ShiftedScores::kOutside);
  EXPECT_EQ(scores.at(9, 0), ShiftedScores::kOutside);
  EXPECT_EQ(scores.at(0, 8), ShiftedScores::kOutside);
  patch.place[0].x = 1e30;
  EXPECT_EQ(ShiftedScores(patch, image).at(0, 0), ShiftedScores::kOutside);
  EXPECT_EQ(ShiftedScores(patch, image).every_second(4), std::vector<double>(25, ShiftedScores::kOutside));
}

TEST(ShiftedScores, AFlatPhotoHasNoScore) {
  const Patch patch = small_patch();
  const ImageF image(16, 12, 1, 0.4f);
  EXPECT_EQ(ShiftedScores(patch, image).at(0, 0), ShiftedScores::kOutside);
}

}  // namespace
}  // namespace aligngs
