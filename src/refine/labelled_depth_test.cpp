#include "refine/labelled_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

constexpr uint16_t kCornerWall = 0, kFloorLabel = 1, kOtherLabel = 2;
const FlatClasses kCornerClasses = {{{PlaneKind::kWall, false}, {PlaneKind::kFloor, false}, {}}, {}};

/// Photos of the corner of which stereo measured one column in three; in between the depth is a fifth too large.
struct HalfMeasured {
  std::vector<MatchView> views;
  std::vector<Image<uint16_t>> labels;
  std::vector<PhotoDepth> depths;
  std::vector<ImageF> truth;
  ThreadPool pool{2};

  explicit HalfMeasured(int count = 6) {
    for (int i = 0; i < count; ++i) {
      MatchView view = photo(true_camera(i)).match;
      truth.push_back(view.depth);
      PhotoDepth depth;
      depth.depth = view.depth;
      depth.certainty = ImageF(kWidth, kHeight, 1);
      Image<uint16_t> label(kWidth, kHeight, 1);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Vec3d world = view.camera.unproject(x + 0.5, y + 0.5, static_cast<double>(view.depth.at(x, y)));
          label.at(x, y) = world.y > 0.79 ? kFloorLabel : kCornerWall;
          const bool measured = x / 20 % 3 == 0;
          depth.certainty.at(x, y) = measured ? 1.0f : 0.0f;
          if (!measured) depth.depth.at(x, y) *= 1.2f;
        }
      }
      view.depth = {};
      views.push_back(std::move(view));
      labels.push_back(std::move(label));
      depths.push_back(std::move(depth));
    }
  }

  LabelledDepthReport lay(const FlatClasses& classes = kCornerClasses) {
    return lay_on_planes(views, labels, classes, {}, pool, depths);
  }

  double median_error(size_t i) const {
    std::vector<double> errors;
    for (size_t p = 0; p < truth[i].pixels(); ++p)
      errors.push_back(std::abs(static_cast<double>(depths[i].depth.data[p] / truth[i].data[p]) - 1));
    return median_of(std::move(errors));
  }
};

TEST(LabelledDepth, BareWallsLieOnThePlanesOfWhatWasMeasuredOfThem) {
  HalfMeasured photos;
  EXPECT_GT(photos.median_error(1), 0.1);
  const LabelledDepthReport report = photos.lay();
  EXPECT_EQ(report.planes.size(), 3u);
  EXPECT_GT(report.on_planes, 0.6);
  for (size_t i = 0; i < photos.views.size(); ++i) EXPECT_LT(photos.median_error(i), 0.01) << i;
  for (const float c : photos.depths[1].certainty.data) EXPECT_LE(c, 1.0f);
}

TEST(LabelledDepth, WhatIsNoLayoutButAPanelLiesOnAPlaneOfItsOwn) {
  HalfMeasured photos;
  // both walls are a mirror
  const LabelledDepthReport report =
      photos.lay({std::vector<PlaneClass>(3), {PanelClass::kFree, PanelClass::kNone, PanelClass::kNone}});
  EXPECT_TRUE(report.planes.empty());
  EXPECT_FALSE(report.panels.empty());
  EXPECT_LT(photos.median_error(1), 0.01);
}

TEST(LabelledDepth, WhatHasNoPlaneStays) {
  HalfMeasured photos;
  for (auto& label : photos.labels) std::fill(label.data.begin(), label.data.end(), kOtherLabel);
  const std::vector<float> before = photos.depths[0].depth.data;
  const LabelledDepthReport report = photos.lay();
  EXPECT_TRUE(report.planes.empty());
  EXPECT_EQ(report.on_planes, 0);
  EXPECT_EQ(photos.depths[0].depth.data, before);
}

TEST(LabelledDepth, PhotosWithoutDepthOrLabelsAreLeftOut) {
  HalfMeasured photos;
  photos.depths[0] = {};
  photos.labels[1] = {};
  const LabelledDepthReport report = photos.lay();
  EXPECT_FALSE(report.planes.empty());
  EXPECT_TRUE(photos.depths[0].depth.empty());
  EXPECT_GT(photos.median_error(1), 0.1);
  EXPECT_LT(photos.median_error(2), 0.01);
}

}  // namespace
}  // namespace aligngs
