#include "gaussians/label_smoothing.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace aligngs {
namespace {

constexpr size_t kSmoothedCount = 400;
constexpr double kSmoothedExtent = 3;

/// Gaussians in a cube of 10 cm, with three classes drawn at random.
GaussianModel cloud_of_classes(uint64_t seed) {
  GaussianModel model;
  model.semantic_channels = 3;
  model.resize(kSmoothedCount);
  Random places(1), rows(seed);
  for (float& p : model.positions) p = static_cast<float>(0.1 * places.uniform());
  for (float& o : model.opacity_logits) o = static_cast<float>(4 * places.uniform() - 2);
  for (float& s : model.semantics) s = static_cast<float>(3 * rows.uniform());
  return model;
}

TEST(LabelSmoothing, OneSmootherServesAllLabelsOfTheSameGaussians) {
  ThreadPool pool(2);
  const GaussianModel first = cloud_of_classes(2), second = cloud_of_classes(3);
  const LabelSmoother of_first(first, kSmoothedExtent, pool), of_second(second, kSmoothedExtent, pool);
  const SoftLabels own = of_second.smoothed(second, pool), shared = of_first.smoothed(second, pool);
  EXPECT_EQ(own.label, shared.label);
  EXPECT_EQ(own.probability, shared.probability);
  EXPECT_NE(of_first.smoothed(first, pool).probability, shared.probability);
}

TEST(LabelSmoothing, NeighboursOfOtherPlacesAreNotTaken) {
  ThreadPool pool(2);
  const GaussianModel model = cloud_of_classes(2);
  const LabelSmoother searched(model, kSmoothedExtent, pool);
  const PlacedNeighbours own{model.positions, searched.shared_graph()};
  const LabelSmoother known(model, kSmoothedExtent, pool, {}, own);
  EXPECT_EQ(known.shared_graph(), searched.shared_graph());
  EXPECT_EQ(known.smoothed(model, pool).probability, searched.smoothed(model, pool).probability);
  GaussianModel moved = model;
  moved.positions[0] += 0.01f;
  EXPECT_NE(LabelSmoother(moved, kSmoothedExtent, pool, {}, own).shared_graph(), searched.shared_graph());
  SmoothingOptions fewer;
  fewer.neighbours = 4;
  EXPECT_EQ(LabelSmoother(model, kSmoothedExtent, pool, fewer, own).graph().k, 4u);
}

TEST(LabelSmoothing, TheNumberOfThreadsDoesNotMatter) {
  ThreadPool one(1), three(3);
  const GaussianModel model = cloud_of_classes(2);
  EXPECT_EQ(LabelSmoother(model, kSmoothedExtent, one).smoothed(model, one).probability,
            LabelSmoother(model, kSmoothedExtent, three).smoothed(model, three).probability);
}

TEST(LabelSmoothing, ALoneDissenterTakesTheClassOfItsNeighbours) {
  ThreadPool pool(1);
  GaussianModel model = cloud_of_classes(2);
  for (size_t i = 0; i < kSmoothedCount; ++i) {
    for (size_t c = 0; c < 3; ++c) model.semantics[3 * i + c] = c == (i == 7 ? 1u : 0u) ? 2.0f : 0.0f;
  }
  EXPECT_EQ(LabelSmoother(model, kSmoothedExtent, pool).smoothed(model, pool).label[SoftLabels::kTop * 7], 0);
}

TEST(LabelSmoothing, NeighboursOutOfReachSayNothing) {
  ThreadPool pool(1);
  const GaussianModel model = cloud_of_classes(2);
  constexpr double kNoReach = 1e-6;  // scene units: the reach is a fiftieth of it
  EXPECT_EQ(LabelSmoother(model, kNoReach, pool).smoothed(model, pool).label, soft_labels(model, pool).label);
}

TEST(LabelSmoothing, NoGaussiansHaveNoLabels) {
  ThreadPool pool(1);
  GaussianModel none;
  none.semantic_channels = 3;
  EXPECT_EQ(LabelSmoother(none, kSmoothedExtent, pool).smoothed(none, pool).size(), 0u);
}

}  // namespace
}  // namespace aligngs
