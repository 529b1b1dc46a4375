#include "edit/taken_objects.h"

#include <gtest/gtest.h>

#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr uint16_t kTakenBed = 7, kTakenChair = 19;

/// Two beds of two Gaussians, a chair of three, and one Gaussian without a label.
GaussianLabels labels() {
  GaussianLabels out;
  out.label = {kTakenBed, kTakenBed, kTakenBed, kTakenBed, kTakenChair, kTakenChair, kTakenChair, kNoLabel};
  out.instance = {1, 1, 2, 2, 1, 1, 1, 0};
  return out;
}

TEST(TakenObjects, AreThoseOfWhichHalfIsSelected) {
  const GaussianLabels named = labels();
  const TakenObjects taken(named, {1, 0, 0, 0, 1, 0, 0, 0});
  EXPECT_TRUE(taken.holds(kTakenBed, 1));
  EXPECT_FALSE(taken.holds(kTakenBed, 2));
  EXPECT_FALSE(taken.holds(kTakenChair, 1)) << "a third of it";
}

TEST(TakenObjects, HoldTheirUnselectedGaussians) {
  const GaussianLabels named = labels();
  const TakenObjects taken(named, {1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_TRUE(taken.holds_row(1));
  EXPECT_FALSE(taken.holds_row(2));
}

TEST(TakenObjects, AGaussianWithoutALabelIsOfNone) {
  const GaussianLabels named = labels();
  EXPECT_FALSE(TakenObjects(named, {0, 0, 0, 0, 0, 0, 0, 1}).holds_row(7));
}

}  // namespace
}  // namespace aligngs
