#include "synth/label_controls.h"

#include <gtest/gtest.h>

#include "core/half.h"

namespace aligngs {
namespace {

/// Class 3 on the left half, class 5 on the right.
std::vector<ScoreMap> two_maps() {
  ScoreMap map;
  map.channels = 12;
  map.width = 6;
  map.height = 4;
  map.values.assign(12 * 24, float_to_half(0));
  for (size_t p = 0; p < 24; ++p) map.values[(p % 6 < 3 ? 3 : 5) * 24 + p] = float_to_half(0.8f);
  return {map, map};
}

int best(const ScoreMap& map, int x) {
  int out = 0;
  for (int c = 1; c < map.channels; ++c) {
    if (map.score(c, x, 0) > map.score(out, x, 0)) out = c;
  }
  return out;
}

TEST(LabelControls, ConstantIsOneClassEverywhere) {
  std::vector<ScoreMap> maps = two_maps();
  apply_label_control(LabelTeacher::kConstant, maps, Random(1));
  for (const ScoreMap& map : maps) {
    EXPECT_EQ(best(map, 0), 0);
    EXPECT_EQ(best(map, 5), 0);
    EXPECT_EQ(map.score(3, 0, 0), 0);
  }
}

TEST(LabelControls, ShuffledKeepsTheOutlinesAndLosesTheNames) {
  std::vector<ScoreMap> maps = two_maps();
  apply_label_control(LabelTeacher::kShuffled, maps, Random(1));
  for (const ScoreMap& map : maps) {
    EXPECT_EQ(best(map, 0), best(map, 2));
    EXPECT_NE(best(map, 2), best(map, 3)) << "the edge stays";
    EXPECT_NEAR(map.score(best(map, 0), 0, 0), 0.8f, 1e-3);
  }
  EXPECT_FALSE(best(maps[0], 0) == best(maps[1], 0) && best(maps[0], 5) == best(maps[1], 5))
      << "another name in every view";
}

TEST(LabelControls, TheTeacherItselfIsLeftAlone) {
  std::vector<ScoreMap> maps = two_maps();
  apply_label_control(LabelTeacher::kTeacher, maps, Random(1));
  EXPECT_EQ(maps[0].values, two_maps()[0].values);
}

}  // namespace
}  // namespace aligngs
