#include "train/plane_targets.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "train/testing/trained_room.h"

namespace aligngs {
namespace {

class FittedPlanes : public testing::Test {
 protected:
  FittedPlanes() {
    for (const Camera& c : box_room::cameras()) guides_.push_back({"photo", c, {}, {}, 0.05f});
    scales_.assign(guides_.size(), 1.0f);
    render_.raster.near_plane = 0.05f;
  }
  PlaneTargets fit(const GaussianModel& model, int threads = 2) {
    const std::unique_ptr<Engine> engine = make_cpu_engine(threads);
    engine->load(model);
    ThreadPool pool(threads);
    return fit_plane_targets(*engine, {guides_, box_room::kClasses, scales_, render_}, pool);
  }
  std::vector<GuideView> guides_;
  std::vector<float> scales_;
  RenderOptions render_;
};

double mean_weight(const PlaneTargets& targets) {
  double sum = 0, count = 0;
  for (const ViewPlanes& view : targets.views) {
    for (size_t i = 0; i < view.plane.data.size(); ++i) {
      sum += view.plane.data[i] > 0 ? view.weight.data[i] / 255.0 : 0;
      count += view.plane.data[i] > 0 ? 1 : 0;
    }
  }
  return sum / count;
}

TEST_F(FittedPlanes, AreThoseOfTheRoomWhereRenderedLabelsNameThem) {
  constexpr double kThickness = 0.05;  // log depth: the round Gaussians of the room lie before its surfaces
  const PlaneTargets targets = fit(box_room::trained_room());
  ASSERT_EQ(targets.views.size(), guides_.size());
  EXPECT_GT(targets.share(), 0.5);
  for (size_t v = 0; v < guides_.size(); ++v) {
    const LayoutView truth = box_room::look(guides_[v].camera);
    const ViewPlanes& view = targets.views[v];
    size_t near = 0, on_plane = 0;
    for (int y = 0; y < view.plane.height; ++y) {
      for (int x = 0; x < view.plane.width; ++x) {
        if (view.plane.at(x, y) == 0) continue;
        const double depth = view.planes.at(view.plane.at(x, y) - 1u).depth(guides_[v].camera.ray(x + 0.5, y + 0.5));
        on_plane += 1;
        near += std::abs(std::log(depth / static_cast<double>(truth.plane.depth.at(x, y)))) < kThickness ? 1 : 0;
        EXPECT_NE(truth.plane.labels.at(x, y), box_room::kChestLabel) << "photo " << v << ", pixel " << x << ", " << y;
      }
    }
    EXPECT_GT(near, on_plane * 9 / 10) << "photo " << v;
  }
}

TEST_F(FittedPlanes, WeighAsMuchAsTheRenderedClassIsProbable) {
  const double sure = mean_weight(fit(box_room::trained_room(4, 6))),
               unsure = mean_weight(fit(box_room::trained_room(4, 1)));
  EXPECT_GT(sure, 0.9);
  EXPECT_NEAR(unsure / sure, std::exp(1.0) / (std::exp(1.0) + 3), 0.05);
}

TEST_F(FittedPlanes, AreNoneOfAModelWithoutSemantics) {
  const PlaneTargets targets = fit(box_room::trained_room(0));
  EXPECT_EQ(targets.share(), 0);
}

TEST_F(FittedPlanes, AreTheSameForAnyNumberOfThreads) {
  const PlaneTargets one = fit(box_room::trained_room(), 1), three = fit(box_room::trained_room(), 3);
  for (size_t v = 0; v < guides_.size(); ++v) {
    EXPECT_EQ(one.views[v].plane.data, three.views[v].plane.data);
    EXPECT_EQ(one.views[v].weight.data, three.views[v].weight.data);
  }
}

/// A view of 4 x 2 pixels whose right half lies on a frontal plane at depth 2.
class DrawnToPlanes : public testing::Test {
 protected:
  DrawnToPlanes() {
    Camera& camera = view_.data.camera;
    camera.width = 4;
    camera.height = 2;
    camera.fx = camera.fy = 4;
    camera.cx = 2;
    camera.cy = 1;
    view_.data.prior_depth = ImageF(4, 2, 1, 1.0f);
    view_.depth_weight = ImageF(4, 2, 1, 1.0f);
    view_.prior_normal = ImageF(4, 2, 3);
    for (size_t i = 0; i < 8; ++i) view_.prior_normal.data[3 * i] = 1;
    ViewPlanes planes;
    planes.planes = {{{0, 0, -1}, 2, PlaneKind::kNone, 1}};
    planes.plane = planes.weight = Image<uint8_t>(4, 2, 1);
    for (int y = 0; y < 2; ++y) {
      for (int x = 2; x < 4; ++x) {
        planes.plane.at(x, y) = 1;
        planes.weight.at(x, y) = 255;
      }
    }
    targets_.views = {planes};
  }
  TrainingView drawn(double strength = 1) const {
    std::vector<TrainingView> views{view_};
    draw_to_planes(targets_, strength, views);
    return views[0];
  }
  TrainingView view_;
  PlaneTargets targets_;
};

TEST_F(DrawnToPlanes, PriorAndPlaneOfEqualWeightMeetInTheMiddle) {
  const TrainingView v = drawn();
  EXPECT_NEAR(v.data.prior_depth.at(2, 0), std::sqrt(2.0), 1e-6);
  EXPECT_EQ(v.depth_weight.at(2, 0), 1);
  EXPECT_NEAR(v.prior_normal.at(2, 0, 0), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(v.prior_normal.at(2, 0, 2), -std::sqrt(0.5), 1e-6);
}

TEST_F(DrawnToPlanes, AStrongerPlaneDrawsFurther) {
  EXPECT_NEAR(drawn(3).data.prior_depth.at(3, 1), std::pow(2.0, 0.75), 1e-6);
}

TEST_F(DrawnToPlanes, PixelsOnNoPlaneKeepTheirPrior) {
  const TrainingView v = drawn();
  EXPECT_EQ(v.data.prior_depth.at(1, 0), 1);
  EXPECT_EQ(v.prior_normal.at(1, 0, 0), 1);
}

TEST_F(DrawnToPlanes, WithoutAPriorThePlaneStandsAlone) {
  view_.data.prior_depth.at(2, 0) = 0;
  view_.data.prior_depth.at(3, 0) = std::nanf("");
  view_.depth_weight.at(2, 1) = 0;
  targets_.views[0].weight.at(2, 0) = 51;
  const TrainingView v = drawn();
  for (const auto& [x, y] : {std::pair(2, 0), {3, 0}, {2, 1}})
    EXPECT_NEAR(v.data.prior_depth.at(x, y), 2, 1e-6) << x << ", " << y;
  EXPECT_NEAR(v.depth_weight.at(2, 0), 0.2, 1e-6);
}

TEST_F(DrawnToPlanes, MapsThatAViewDoesNotHaveAreMadeButNormals) {
  view_.data.prior_depth = view_.depth_weight = view_.prior_normal = {};
  const TrainingView v = drawn();
  EXPECT_EQ(v.data.prior_depth.at(0, 0), 0);
  EXPECT_NEAR(v.data.prior_depth.at(2, 0), 2, 1e-6);
  EXPECT_TRUE(v.prior_normal.empty());
}

TEST_F(DrawnToPlanes, ThePriorIsDividedByTheScaleThatTheLossMultipliesItBy) {
  view_.depth_weight.at(2, 0) = 0;
  targets_.views[0].depth_scale = 0.8f;
  EXPECT_NEAR(drawn().data.prior_depth.at(2, 0), 2.5, 1e-6);
}

TEST_F(DrawnToPlanes, ViewsMayHaveAnotherResolutionThanTheFit) {
  view_.data.camera = view_.data.camera.resized(2, 1);
  view_.data.prior_depth = ImageF(2, 1, 1, 1.0f);
  view_.depth_weight = ImageF(2, 1, 1);
  view_.prior_normal = {};
  const TrainingView v = drawn();
  EXPECT_EQ(v.data.prior_depth.at(0, 0), 1);
  EXPECT_NEAR(v.data.prior_depth.at(1, 0), 2, 1e-6);
}

TEST_F(DrawnToPlanes, NothingChangesWithoutTargets) {
  targets_ = {};
  EXPECT_EQ(drawn().data.prior_depth.data, view_.data.prior_depth.data);
}

TEST_F(DrawnToPlanes, TargetsOfAnotherNumberOfViewsAreRefused) {
  std::vector<TrainingView> two(2, view_);
  EXPECT_THROW(draw_to_planes(targets_, 1, two), Error);
}

}  // namespace
}  // namespace aligngs
