// Two pillows on a floor: three objects of two classes.
#include "gaussians/object_labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "gaussians/instances.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

constexpr int kClasses = 4, kFloorClass = 1, kPillowClass = 3;
constexpr float kSpacing = 0.03f;  // metres
constexpr double kRoomExtent = 2;  // metres

/// A square patch of Gaussians facing up, `side` a side, one corner at (x, y, z).
void add_patch(GaussianModel& model, Vec3f corner, int side, float grey, int label) {
  for (int k = 0; k < side * side; ++k) {
    const size_t i = model.size();
    model.resize(i + 1);
    const float p[3] = {corner.x + kSpacing * static_cast<float>(k % side), corner.y,
                        corner.z + kSpacing * static_cast<float>(k / side)};
    for (size_t a = 0; a < 3; ++a) {
      model.positions[3 * i + a] = p[a];
      model.log_scales[3 * i + a] = std::log(0.5f * kSpacing);
      model.sh[3 * kShCoefficients * i + a] = (grey - 0.5f) / static_cast<float>(kSh0);
    }
    model.rotations[4 * i] = 1;
    model.opacity_logits[i] = 3;
    if (label >= 0) model.semantics[i * kClasses + static_cast<size_t>(label)] = 8;
  }
}

GaussianModel two_pillows_on_a_floor() {
  GaussianModel model;
  model.semantic_channels = kClasses;
  add_patch(model, {0, 0, 0}, 40, 0.3f, kFloorClass);
  add_patch(model, {0.1f, -0.2f, 0.1f}, 8, 0.9f, kPillowClass);
  add_patch(model, {0.8f, -0.2f, 0.8f}, 6, 0.9f, kPillowClass);
  return model;
}

LabelSet four_classes() {
  LabelSet labels;
  labels.name = "four";
  labels.classes.resize(kClasses);
  return labels;
}

TEST(ObjectLabels, EveryThingOfAClassHasItsNumber) {
  ThreadPool pool(2);
  const GaussianModel model = two_pillows_on_a_floor();
  const GaussianLabels got = object_labels(model, four_classes(), kRoomExtent, pool).labels;
  EXPECT_EQ(got.label_set, "four");
  EXPECT_EQ(got.label.front(), kFloorClass);
  EXPECT_EQ(got.label.back(), kPillowClass);
  EXPECT_EQ(got.instance[1600], 1) << "the larger pillow comes first";
  EXPECT_EQ(got.instance.back(), 2);
  EXPECT_GT(got.confidence.back(), 200);
  const std::vector<Instance> objects = list_instances(model, got);
  ASSERT_EQ(objects.size(), 3u);
  EXPECT_EQ(objects[1].gaussians, 64u);
}

TEST(ObjectLabels, NeighboursOutvoteOneWrongGaussian) {
  ThreadPool pool(1);
  GaussianModel model = two_pillows_on_a_floor();
  float* row = &model.semantics[820 * kClasses];
  row[kFloorClass] = 0;
  row[kPillowClass] = 3;
  EXPECT_EQ(object_labels(model, four_classes(), kRoomExtent, pool).labels.label[820], kFloorClass);
}

TEST(ObjectLabels, AnUntaughtThingHasNoClass) {
  ThreadPool pool(1);
  GaussianModel model;
  model.semantic_channels = kClasses;
  add_patch(model, {0, 0, 0}, 5, 0.5f, -1);
  const GaussianLabels got = object_labels(model, four_classes(), kRoomExtent, pool).labels;
  EXPECT_TRUE(std::all_of(got.label.begin(), got.label.end(), [](uint16_t l) { return l == kNoLabel; }));
  EXPECT_TRUE(std::all_of(got.instance.begin(), got.instance.end(), [](uint16_t i) { return i == 0; }));
}

TEST(ObjectLabels, AModelWithoutSemanticsIsRefused) {
  ThreadPool pool(1);
  GaussianModel model;
  model.resize(3);
  EXPECT_THROW(object_labels(model, four_classes(), kRoomExtent, pool), Error);
}

TEST(ObjectLabels, NoGaussianIsNoObject) {
  ThreadPool pool(1);
  GaussianModel model;
  model.semantic_channels = kClasses;
  EXPECT_TRUE(object_labels(model, four_classes(), 0, pool).labels.label.empty());
}

}  // namespace
}  // namespace aligngs
