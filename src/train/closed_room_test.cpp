#include "train/closed_room.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gaussians/initialise.h"
#include "refine/box_room_for_tests.h"
#include "scene/voxel_merge.h"

namespace aligngs {
namespace {

using namespace box_room;

LabelSet room_labels() {
  LabelSet labels;
  for (const char* name : {"wall", "floor", "ceiling", "chest"}) labels.classes.push_back({name, {}, {}});
  return labels;
}

uint16_t label_at(const Vec3f& p) {
  if (p.x < kChestHigh.x + 0.03 && p.x > kChestLow.x - 0.03 && p.z > kChestLow.z - 0.03 && p.z < kChestHigh.z + 0.03 && p.y > kChestLow.y - 0.03 &&
      p.y < kFloor - 0.03) {
    return kChestLabel;
  }
  return p.y > kFloor - 0.03 ? kFloorLabel : p.y < kCeiling + 0.03 ? kCeilingLabel : kWallLabel;
}

/// Gaussians on all that the photos show, as training leaves them.
GaussianModel trained_room(int channels = 4) {
  PointCloud cloud;
  for (const LayoutView& view : photos()) {
    for (int y = 0; y < view.plane.camera.height; ++y) {
      for (int x = 0; x < view.plane.camera.width; ++x) {
        cloud.positions.push_back(view.plane.camera.unproject(x + 0.5, y + 0.5, view.plane.depth.at(x, y)).cast<float>());
        cloud.colors.push_back(kColors[view.plane.labels.at(x, y)]);
      }
    }
  }
  InitialiseOptions options;
  options.semantic_channels = channels;
  options.opacity = 0.9f;
  GaussianModel model = initialise_gaussians(voxel_thin(cloud, 0.03), options);
  for (size_t i = 0; channels > 0 && i < model.size(); ++i) {
    const float* p = &model.positions[3 * i];
    model.semantics[i * static_cast<size_t>(channels) + label_at({p[0], p[1], p[2]})] = 6;
  }
  return model;
}

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
  for (size_t i = 0; i < before.color.data.size(); ++i) difference += std::abs(before.color.data[i] - after.color.data[i]);
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
