#include "train/closed_room.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "train/testing/trained_room.h"

namespace aligngs {
namespace {

using namespace box_room;

class ClosedRoom : public testing::Test {
 protected:
  ClosedRoom() {
    for (const Camera& c : cameras()) views_.push_back({"photo", c, {}, {}, 0.05f});
    render_.raster.near_plane = 0.05f;
    engine_->load(trained_room());
  }
  size_t close(size_t most = std::numeric_limits<size_t>::max()) {
    return close_room(*engine_, {views_, labels_, kExtent, most, render_}, pool_);
  }
  Rendering render(const Camera& camera) const {
    RenderOptions options = render_;
    options.labels = true;
    return engine_->render(camera, options);
  }
  /// From where no photo was taken: of the floor that lies behind the cameras.
  static Camera beyond() { return camera({0, -0.3, 0.4}, 3.0, 0.5); }

  static constexpr double kExtent = 4;
  ThreadPool pool_{2};
  std::unique_ptr<Engine> engine_ = make_cpu_engine(2);
  std::vector<GuideView> views_;
  LabelSet labels_ = room_labels();
  RenderOptions render_;
};

TEST_F(ClosedRoom, ShowsFloorWhereThereWasAHole) {
  const Rendering before = render(beyond());
  EXPECT_GT(close(), 500u);
  const Rendering after = render(beyond());
  size_t holes = 0, filled = 0;
  for (int y = 70; y < 120; ++y) {
    for (int x = 30; x < 130; ++x) {
      if (before.alpha.at(x, y) >= 0.1f) continue;
      ++holes;
      filled += after.alpha.at(x, y) > 0.9f && after.label.at(x, y) == kFloorLabel &&
                std::abs(after.color.at(x, y, 0) - kColors[kFloorLabel].x) < 0.1f;
    }
  }
  ASSERT_GT(holes, 1000u);
  EXPECT_GT(filled, holes * 9 / 10);
}

TEST_F(ClosedRoom, ChangesNothingThatATrainingViewShows) {
  const Rendering before = render(views_[2].camera);
  ASSERT_GT(close(), 0u);
  const Rendering after = render(views_[2].camera);
  double difference = 0;
  for (size_t i = 0; i < before.color.data.size(); ++i)
    difference += std::abs(before.color.data[i] - after.color.data[i]);
  EXPECT_LT(difference / static_cast<double>(before.color.data.size()), 0.002);
}

TEST_F(ClosedRoom, ASecondTimeAddsNextToNothing) {
  const size_t first = close();
  EXPECT_LT(close(), first / 50);
}

TEST_F(ClosedRoom, TrainedRowsStayAsTheyWere) {
  GaussianModel before, after;
  engine_->store(before);
  const size_t added = close();
  engine_->store(after);
  ASSERT_EQ(after.size(), before.size() + added);
  after.resize(before.size());
  EXPECT_EQ(after.positions, before.positions);
  EXPECT_EQ(after.opacity_logits, before.opacity_logits);
  EXPECT_EQ(after.semantics, before.semantics);
}

TEST_F(ClosedRoom, NeverExceedsTheCap) { EXPECT_EQ(close(engine_->size() + 10), 0u); }

TEST_F(ClosedRoom, WithoutSemanticsNothingIsClosed) {
  engine_->load(trained_room(0));
  EXPECT_EQ(close(), 0u);
}

}  // namespace
}  // namespace aligngs
