#include "refine/bare_planes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

/// Photos of the corner. Part of the back wall is bare: nothing was measured there, and the depth between is wrong.
struct BareCorner {
  static constexpr double kLeft = -0.6, kRight = 0.4, kTop = -0.7, kBottom = 0.2;  // of the bare part
  std::vector<MatchView> views;
  std::vector<PhotoDepth> depths;
  std::vector<ImageF> truth;
  std::vector<Image<uint8_t>> bare;
  std::vector<Image<uint16_t>> labels;  ///< none, unless a test draws them
  BarePlaneSettings settings;

  explicit BareCorner(int count) {
    for (int i = 0; i < count; ++i) {
      RefineView shown = photo(true_camera(i), 0.3);
      PhotoDepth depth;
      depth.depth = shown.match.depth;
      depth.certainty = ImageF(kWidth, kHeight, 1, 0.5f);
      bare.emplace_back(kWidth, kHeight, 1);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Vec3d at =
              shown.match.camera.unproject(x + 0.5, y + 0.5, static_cast<double>(shown.match.depth.at(x, y)));
          if (at.z < 2.999 || at.x < kLeft || at.x > kRight || at.y < kTop || at.y > kBottom) continue;
          bare.back().at(x, y) = 1;
          shown.match.luma.at(x, y) = 0.9f;
          depth.depth.at(x, y) *= 0.85f;
          depth.certainty.at(x, y) = 0;
        }
      }
      truth.push_back(std::move(shown.match.depth));
      shown.match.depth = {};
      views.push_back(std::move(shown.match));
      depths.push_back(std::move(depth));
    }
  }

  BarePlaneReport lay(int threads = 2) {
    ThreadPool pool(threads);
    return lay_on_bare_planes(views, labels, settings, {}, pool, depths);
  }

  /// Labels: `of_bare` in the bare part, `elsewhere` in the rest.
  void label(uint16_t of_bare, uint16_t elsewhere) {
    labels.clear();
    for (const Image<uint8_t>& part : bare) {
      labels.emplace_back(kWidth, kHeight, 1, elsewhere);
      for (size_t p = 0; p < part.data.size(); ++p) {
        if (part.data[p]) labels.back().data[p] = of_bare;
      }
    }
  }

  /// Share of the bare pixels of photo i whose depth is right within 1 %.
  double right(size_t i) const {
    int all = 0, good = 0;
    for (size_t p = 0; p < truth[i].data.size(); ++p) {
      if (!bare[i].data[p]) continue;
      ++all;
      good += std::abs(depths[i].depth.data[p] / truth[i].data[p] - 1) < 0.01f;
    }
    return all == 0 ? 1 : static_cast<double>(good) / all;
  }
};

TEST(BarePlanes, ABarePartOfAWallLiesOnThePlaneOfTheRest) {
  BareCorner corner(5);
  ASSERT_EQ(corner.right(2), 0);
  EXPECT_GE(corner.lay().planes.size(), 3u);
  for (size_t i = 0; i < corner.views.size(); ++i) EXPECT_GT(corner.right(i), 0.95) << i;
}

TEST(BarePlanes, AMeasuredThingBeforeTheWallStays) {
  BareCorner corner(5);
  ImageF& depth = corner.depths[2].depth;
  for (int y = 70; y < 85; ++y) {
    for (int x = 60; x < 80; ++x) {
      depth.at(x, y) = 0.7f * corner.truth[2].at(x, y);
      corner.depths[2].certainty.at(x, y) = 0.5f;
      corner.views[2].luma.at(x, y) = 0.1f;
    }
  }
  corner.lay();
  EXPECT_NEAR(depth.at(70, 77) / corner.truth[2].at(70, 77), 0.7f, 0.01f);
}

TEST(BarePlanes, AClassThatWasNeverMeasuredOnThePlaneStaysOffIt) {
  BareCorner wall(5), lamp(5);
  wall.settings.doubts.foreign = lamp.settings.doubts.foreign = 3;
  wall.label(4, 4);
  lamp.label(7, 4);
  wall.lay();
  lamp.lay();
  for (size_t i = 0; i < wall.views.size(); ++i) {
    EXPECT_GT(wall.right(i), 0.95) << i;
    EXPECT_LT(lamp.right(i), 0.05) << i;
  }
}

TEST(BarePlanes, DepthFarFromThePlaneIsBelievedWhereANetworkMadeIt) {
  BareCorner corner(5);
  corner.settings.doubts.far = 4;  // the bare part is 15 % off, which costs a third of it
  corner.lay();
  for (size_t i = 0; i < corner.views.size(); ++i) EXPECT_LT(corner.right(i), 0.05) << i;
}

TEST(BarePlanes, DepthThatFacesAnotherWayIsBelievedWhereANetworkMadeIt) {
  BareCorner corner(5);
  corner.settings.doubts.turned = 4;
  corner.settings.doubts.turn = 10;
  for (size_t i = 0; i < corner.views.size(); ++i) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {  // a surface that recedes by 1 % a pixel: it is turned by more than 45 degrees
        if (corner.bare[i].at(x, y)) corner.depths[i].depth.at(x, y) = 1.5f * std::exp(0.01f * static_cast<float>(x));
      }
    }
  }
  corner.lay();
  for (size_t i = 0; i < corner.views.size(); ++i) EXPECT_LT(corner.right(i), 0.2) << i;
}

/// A door 2 cm before the back wall, measured in every photo of a corner: its pixels, 1 = door.
std::vector<Image<uint8_t>> hang_door(BareCorner& corner) {
  constexpr float kBefore = 0.993f;  // of the depth
  std::vector<Image<uint8_t>> door;
  for (size_t i = 0; i < corner.views.size(); ++i) {
    door.emplace_back(kWidth, kHeight, 1);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const Vec3d at =
            corner.views[i].camera.unproject(x + 0.5, y + 0.5, static_cast<double>(corner.truth[i].at(x, y)));
        if (at.z < 2.999 || at.x > BareCorner::kLeft) continue;
        door.back().at(x, y) = 1;
        corner.truth[i].at(x, y) *= kBefore;
        corner.depths[i].depth.at(x, y) *= kBefore;
      }
    }
  }
  return door;
}

/// Mean |log(depth / truth)| of the door's pixels in one photo.
double door_error(const BareCorner& corner, const std::vector<Image<uint8_t>>& door, size_t i) {
  double sum = 0, count = 0;
  for (size_t p = 0; p < door[i].data.size(); ++p) {
    if (!door[i].data[p]) continue;
    sum += std::abs(std::log(static_cast<double>(corner.depths[i].depth.data[p] / corner.truth[i].data[p])));
    ++count;
  }
  return sum / count;
}

TEST(BarePlanes, ADoorKeepsItsDistanceFromItsKnownWall) {
  BareCorner corner(5), without_knowledge(5);
  const auto door = hang_door(corner);
  hang_door(without_knowledge);
  KnownSurfaces known;
  ScenePlane wall;
  wall.normal = {0, 0, -1};
  wall.offset = 3;
  wall.kind = PlaneKind::kWall;
  known.planes = {wall};
  for (const Image<uint8_t>& part : door) {
    known.views.push_back({ImageF(kWidth, kHeight, 1), ImageF(kWidth, kHeight, 1), Image<uint8_t>(kWidth, kHeight, 1)});
    for (size_t p = 0; p < part.data.size(); ++p) known.views.back().weight.data[p] = part.data[p];
  }
  ThreadPool pool(2);
  lay_on_bare_planes(corner.views, {}, corner.settings, {}, pool, corner.depths, known);
  without_knowledge.lay();
  EXPECT_GT(door_error(without_knowledge, door, 2), 0.0008);  // it is drawn towards the wall
  EXPECT_LT(door_error(corner, door, 2), 0.0002);
  EXPECT_GT(corner.right(2), 0.95);  // and the bare part of the wall lies on the known plane
}

TEST(BarePlanes, APlaneThatIsKnownIsNotFoundAgain) {
  BareCorner corner(5);
  KnownSurfaces known;
  ScenePlane wall;
  wall.normal = {0, 0, -1};
  wall.offset = 3;
  known.planes = {wall};
  ThreadPool pool(2);
  const BarePlaneReport report = lay_on_bare_planes(corner.views, {}, corner.settings, {}, pool, corner.depths, known);
  int parallel = 0;
  for (const ScenePlane& plane : report.planes) parallel += dot(plane.normal, wall.normal) > 0.99;
  EXPECT_EQ(parallel, 1);
}

TEST(BarePlanes, WithoutMeasurementsNothingChanges) {
  BareCorner corner(3);
  for (PhotoDepth& depth : corner.depths) depth.certainty = ImageF(kWidth, kHeight, 1);
  corner.depths[1] = {};
  const ImageF before = corner.depths[0].depth;
  EXPECT_TRUE(corner.lay().planes.empty());
  EXPECT_EQ(corner.depths[0].depth.data, before.data);
}

TEST(BarePlanes, DoNotDependOnTheNumberOfThreads) {
  BareCorner one(3), three(3);
  one.lay(1);
  three.lay(3);
  for (size_t i = 0; i < one.depths.size(); ++i) EXPECT_EQ(one.depths[i].depth.data, three.depths[i].depth.data);
}

}  // namespace
}  // namespace aligngs
