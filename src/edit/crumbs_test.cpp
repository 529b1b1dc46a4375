#include "edit/crumbs.h"

#include <gmock/gmock.h>

#include "edit/apply_edit.h"
#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

class Crumbs : public testing::Test {
 protected:
  Crumbs() : room_(small_room::make(pool_)) {}

  /// Gives the `count` Gaussians nearest to a place another class and object.
  void relabel(const Vec3f& place, size_t count, int label, int instance) {
    const PointTree tree(positions_of(room_.gaussians.model));
    std::vector<PointTree::Neighbour> near;
    tree.nearest(place, count, near);
    for (const PointTree::Neighbour& n : near) {
      room_.gaussians.labels.label[n.index] = static_cast<uint16_t>(label);
      room_.gaussians.labels.instance[n.index] = static_cast<uint16_t>(instance);
    }
  }
  size_t gaussians_of(int label, int number) const {
    for (const Instance& o : list_instances(room_.gaussians.model, room_.gaussians.labels)) {
      if (o.label == label && o.number == number) return o.gaussians;
    }
    return 0;
  }
  ThreadPool pool_{2};
  EditableRoom room_;
};

constexpr int kBed = 7;  // ADE20K class number

TEST_F(Crumbs, ASpeckOnTheFloorBecomesFloor) {
  const size_t floor = gaussians_of(small_room::kFloor, 1);
  relabel({1, 0, 0.6f}, 10, kBed, 1);
  EXPECT_EQ(join_crumbs(room_.gaussians, {}, pool_), 10u);
  EXPECT_EQ(gaussians_of(kBed, 1), 0u);
  EXPECT_EQ(gaussians_of(small_room::kFloor, 1), floor);
}

TEST_F(Crumbs, ACrumbOfAClassJoinsItsObject) {
  const size_t pillow = gaussians_of(small_room::kPillow, 1);
  relabel({-0.56f, -0.12f, 0.04f}, 6, small_room::kPillow, 0);
  join_crumbs(room_.gaussians, {}, pool_);
  EXPECT_EQ(gaussians_of(small_room::kPillow, 1), pillow);
}

TEST_F(Crumbs, ThingsOfASensibleSizeStay) {
  relabel({1, 0, 0.6f}, 80, kBed, 1);
  EXPECT_EQ(join_crumbs(room_.gaussians, {}, pool_), 0u);
  EXPECT_EQ(gaussians_of(kBed, 1), 80u);
}

TEST_F(Crumbs, GaussiansAmongTheirLikeJoinNoOtherClass) {
  relabel({1, 0, 0.6f}, 60, kBed, 0);
  CrumbOptions options;
  options.majority = 0.9;  // of a flat patch, also its rim lies among its like
  join_crumbs(room_.gaussians, options, pool_);
  EXPECT_GT(small_room::count_label(room_, kBed), 30u);
}

TEST_F(Crumbs, NothingIsLeftOfADeletedObject) {
  relabel({1, 0, 0.6f}, 1, small_room::kPillow, 1);  // a speck in the floor that the selection leaves out
  EditOperation edit;
  edit.select = "pillow#1";
  apply_edit(room_, edit, pool_);
  EXPECT_EQ(gaussians_of(small_room::kPillow, 1), 0u);
  EXPECT_GT(gaussians_of(small_room::kPillow, 2), 0u);
}

}  // namespace
}  // namespace aligngs
