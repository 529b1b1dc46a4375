#include "refine/plane_hypothesis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "refine/testing/wall_photos.h"

namespace aligngs {
namespace {

using namespace wall_photos;

constexpr uint16_t kHypothesisWall = 0, kFloor = 1;
const std::vector<PlaneClass> kHypothesisClasses = {{PlaneKind::kWall, false}, {PlaneKind::kFloor, false}};
constexpr double kBackWall = 3, kFloorHeight = 0.8;  // of wall_photos

/// Photos of a textured corner whose depth all views misjudge alike: the middle of the back wall or of the floor.
struct MisjudgedPhotos {
  std::vector<MatchView> photos;
  std::vector<PlaneView> views;
  std::vector<ImageF> truth;
  std::vector<Image<uint8_t>> wrong;  ///< pixels that are misjudged
  std::vector<ScenePlane> planes;
  ThreadPool pool{2};

  /// `factor` on the depth of places for which `is_wrong` holds.
  template <class Where>
  MisjudgedPhotos(double factor, const Where& is_wrong) {
    for (int i = 0; i < 5; ++i) {
      MatchView photo = wall_photos::photo(true_camera(i), 0.2).match;
      PlaneView view;
      view.camera = photo.camera;
      view.labels = Image<uint16_t>(kWidth, kHeight, 1);
      truth.push_back(photo.depth);
      wrong.emplace_back(kWidth, kHeight, 1);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Vec3d place = photo.camera.unproject(x + 0.5, y + 0.5, photo.depth.at(x, y));
          view.labels.at(x, y) = place.y > kFloorHeight - 0.01 ? kFloor : kHypothesisWall;
          if (!is_wrong(place)) continue;
          photo.depth.at(x, y) *= static_cast<float>(factor);
          wrong.back().at(x, y) = 1;
        }
      }
      view.depth = photo.depth;
      views.push_back(std::move(view));
      photos.push_back(std::move(photo));
    }
    planes.push_back({{0, 0, -1}, kBackWall, {0, 0, kBackWall}, PlaneKind::kWall});
    planes.push_back({{0, -1, 0}, kFloorHeight, {0, kFloorHeight, 2}, PlaneKind::kFloor});
  }

  void remove_texture() {
    for (MatchView& photo : photos) std::fill(photo.luma.data.begin(), photo.luma.data.end(), 0.5f);
  }

  /// Share of the misjudged pixels, away from edges of labels, that are on their plane afterwards.
  double brought_home() {
    std::vector<PlaneMeasurement> measured(views.size());
    for (PlaneMeasurement& m : measured)
      m = {ImageF(kWidth, kHeight, 1), ImageF(kWidth, kHeight, 1), Image<uint8_t>(kWidth, kHeight, 1)};
    try_planes(photos, views, kHypothesisClasses, planes, {}, {}, {}, pool, measured);
    double home = 0, all = 0;
    for (size_t i = 0; i < views.size(); ++i) {
      for (size_t p = 0; p < truth[i].pixels(); ++p) {
        if (!wrong[i].data[p]) continue;
        const double depth = views[i].depth.data[p] * std::exp(static_cast<double>(measured[i].log_factor.data[p]));
        all += 1;
        home += measured[i].weight.data[p] > 0 && std::abs(depth / truth[i].data[p] - 1) < 1e-3;
      }
    }
    return all > 0 ? home / all : 0;
  }
};

bool middle_of_wall(const Vec3d& place) {
  return place.z > kBackWall - 0.01 && std::abs(place.x) < 0.5 && std::abs(place.y) < 0.4;
}
bool middle_of_floor(const Vec3d& place) {
  return place.y > kFloorHeight - 0.01 && std::abs(place.x) < 0.4 && std::abs(place.z - 2.3) < 0.3;
}

TEST(PlaneHypothesis, PhotosBringAWallThatAllViewsMisjudgeHome) {
  EXPECT_GT(MisjudgedPhotos(1.2, middle_of_wall).brought_home(), 0.9);
  EXPECT_GT(MisjudgedPhotos(0.8, middle_of_wall).brought_home(), 0.9);
}

TEST(PlaneHypothesis, NothingLiesUnderAFloorEvenWherePhotosAreBare) {
  MisjudgedPhotos under(1.2, middle_of_floor), over(0.8, middle_of_floor);
  under.remove_texture();
  over.remove_texture();
  EXPECT_GT(under.brought_home(), 0.7);  // the rest is at the edge of the label
  EXPECT_EQ(over.brought_home(), 0);     // something may lie on it
}

TEST(PlaneHypothesis, ABareWallKeepsItsDepth) {
  MisjudgedPhotos bare(1.2, middle_of_wall);
  bare.remove_texture();
  EXPECT_EQ(bare.brought_home(), 0);
}

TEST(PlaneHypothesis, ANicheThatThePhotosShowStays) {
  MisjudgedPhotos room(1, [](const Vec3d& place) { return place.z > kBackWall - 0.01; });  // depth is right
  room.planes[0] = {{0, 0, -1}, 2.5, {0, 0, 2.5}, PlaneKind::kWall};                       // the wall around is nearer
  std::vector<PlaneMeasurement> measured(room.views.size());
  for (PlaneMeasurement& m : measured)
    m = {ImageF(kWidth, kHeight, 1), ImageF(kWidth, kHeight, 1), Image<uint8_t>(kWidth, kHeight, 1)};
  try_planes(room.photos, room.views, kHypothesisClasses, room.planes, {}, {}, {}, room.pool, measured);
  size_t moved = 0, all = 0;
  for (size_t i = 0; i < measured.size(); ++i) {
    for (size_t p = 0; p < measured[i].weight.data.size(); ++p) {
      all += room.wrong[i].data[p];
      moved += room.wrong[i].data[p] && measured[i].weight.data[p] > 0;
    }
  }
  EXPECT_LT(moved, all / 100);
}

TEST(PlaneHypothesis, DoesNotDependOnTheNumberOfThreads) {
  MisjudgedPhotos room(1.2, middle_of_wall);
  std::vector<PlaneMeasurement> one(room.views.size()), three;
  for (PlaneMeasurement& m : one)
    m = {ImageF(kWidth, kHeight, 1), ImageF(kWidth, kHeight, 1), Image<uint8_t>(kWidth, kHeight, 1)};
  three = one;
  ThreadPool few(1), more(3);
  try_planes(room.photos, room.views, kHypothesisClasses, room.planes, {}, {}, {}, few, one);
  try_planes(room.photos, room.views, kHypothesisClasses, room.planes, {}, {}, {}, more, three);
  for (size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].log_factor.data, three[i].log_factor.data);
}

}  // namespace
}  // namespace aligngs
