#include "edit/fill/fill_removed.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

constexpr int kWall = 0, kWindow = 8, kCabinet = 10, kTable = 15, kRug = 28, kBook = 67;  // ADE20K class numbers
const Vec3f kFloorColor{0.6f, 0.5f, 0.4f}, kWallColor{0.8f, 0.8f, 0.7f}, kBookColor{0.5f, 0.1f, 0.6f};

/// A corner of a room: a floor of 3 m x 2 m (y = 0, up is -y) and a wall of 1.6 m. The wall is at z = 1. A box is 25 cm
/// before the wall, and a camera in the middle of the room looks at it. Places that the box hides have no Gaussians.
class FillRemoved : public testing::Test {
 protected:
  FillRemoved() {
    model_.semantic_channels = 150;
    Camera camera;
    camera.width = camera.height = 200;
    camera.fx = camera.fy = 100;
    camera.cx = camera.cy = 100;
    camera.world_to_camera.translation = {0, 0.8, 2};  // at (0, -0.8, -2), looking along +z
    cameras_ = {camera};
  }
  static bool is_behind_box(float x, float y, float z) {
    return z > 0.7f && std::abs(x) < 0.4f && y > -0.6f;  // about what the camera cannot see
  }
  void add_floor() {
    for (float x = -1.48f; x < 1.5f; x += small_room::kSpacing) {
      for (float z = -0.98f; z < 1; z += small_room::kSpacing) {
        const bool under = std::abs(x) < 0.2f && z > 0.35f && z < 0.75f;
        if (!under && !is_behind_box(x, 0, z))
          small_room::add_gaussian(model_, {x, 0, z}, {0, -1, 0}, kFloorColor, small_room::kFloor);
      }
    }
  }
  /// A floor whose colour is a function of x and z.
  template <class Color>
  void color_floor(const Color& color) {
    add_floor();
    for (size_t i = 0; i < model_.size(); ++i) {
      const Vec3f c = color(model_.positions[3 * i], model_.positions[3 * i + 2]);
      for (size_t a = 0; a < 3; ++a)
        model_.sh[3 * kShCoefficients * i + a] = (c[static_cast<int>(a)] - 0.5f) / static_cast<float>(kSh0);
    }
  }
  void add_wall(float hole_low = 9, float hole_high = 9) {
    for (float x = -1.48f; x < 1.5f; x += small_room::kSpacing) {
      for (float y = -1.58f; y < 0; y += small_room::kSpacing) {
        if (is_behind_box(x, y, 1) || (x > hole_low && x < hole_high && y < -0.3f)) continue;
        small_room::add_gaussian(model_, {x, y, 1}, {0, 0, -1}, kWallColor, kWall);
      }
    }
  }
  void add_box() {
    small_room::add_box(model_, mesh_, {-0.2f, -0.4f, 0.35f}, {0.2f, 0, 0.75f}, {0.8f, 0.3f, 0.3f}, small_room::kBox);
  }

  std::vector<SupportPatch> fill() {
    const LabelSet& labels = ade20k_labels();
    room_ = label_objects(model_, labels, small_room::kExtent, pool_);
    for (const size_t row : called_floor_) room_.labels.label[row] = small_room::kFloor;
    for (const size_t row : crumbs_) room_.labels.instance[row] = 0;
    selected_.clear();
    for (const uint16_t l : room_.labels.label) selected_.push_back(l == taken_);
    for (const size_t row : unselected_) selected_[row] = 0;
    Filling filling = fill_removed({room_, labels, selected_, Vec3d{0, -1, 0}, cameras_});
    debris_ = std::move(filling.debris);
    shaded_ = std::move(filling.shaded);
    lighter_ = std::move(filling.lighter);
    return std::move(filling.patches);
  }
  /// New Gaussians within 6 cm of a place.
  static size_t near(const std::vector<SupportPatch>& patches, const Vec3d& place) {
    size_t count = 0;
    for (const SupportPatch& patch : patches) {
      for (size_t i = 0; i < patch.gaussians.size(); ++i) {
        const float* p = &patch.gaussians.positions[3 * i];
        count += norm(Vec3d{p[0], p[1], p[2]} - place) < 0.06;
      }
    }
    return count;
  }
  /// Debris farther than a distance from the middle of the box, along x or z.
  size_t debris_beyond(float distance) const {
    size_t count = 0;
    for (size_t i = 0; i < debris_.size(); ++i) {
      const float* p = &model_.positions[3 * i];
      count += debris_[i] && (std::abs(p[0]) > distance || std::abs(p[2] - 0.55f) > distance);
    }
    return count;
  }
  ThreadPool pool_{2};
  GaussianModel model_;
  TriangleMesh mesh_;
  LabelledGaussians room_;
  std::vector<uint8_t> selected_, debris_, shaded_;
  SupportPatch lighter_;
  int taken_ = small_room::kBox;      ///< class whose Gaussians go
  std::vector<size_t> called_floor_;  ///< rows whose label is wrong
  std::vector<size_t> crumbs_;        ///< rows of no object
  std::vector<size_t> unselected_;    ///< rows of the box that the selection leaves out
  std::vector<Camera> cameras_;
};

TEST_F(FillRemoved, FloorAndWallContinueWhereTheBoxHidThem) {
  add_floor();
  add_wall();
  add_box();
  const auto patches = fill();
  EXPECT_GT(near(patches, {0, 0, 0.55}), 0u) << "under the box";
  EXPECT_GT(near(patches, {0, -0.2, 1}), 0u) << "the wall behind it";
  EXPECT_EQ(near(patches, {1, -0.5, 1}), 0u) << "what photos show stays";
  EXPECT_EQ(near(patches, {0, -0.2, 0.35}), 0u) << "nothing is left of the box";
  constexpr float kThickness = 0.035f;  // metres: of a trained surface
  for (const SupportPatch& patch : patches) {
    for (size_t i = 0; i < patch.gaussians.size(); ++i) {
      EXPECT_LT(patch.gaussians.positions[3 * i + 1], kThickness) << "not under the floor";
      EXPECT_LT(patch.gaussians.positions[3 * i + 2], 1 + kThickness) << "not behind the wall";
    }
  }
}

TEST_F(FillRemoved, ABookBesideIsNoSource) {
  add_floor();
  for (float x = 0.24f; x < 0.5f; x += 0.02f) {
    for (float z = 0.35f; z < 0.7f; z += 0.02f)
      small_room::add_gaussian(model_, {x, -0.005f, z}, {0, -1, 0}, kBookColor, kBook);
  }
  add_box();
  const auto patches = fill();
  ASSERT_FALSE(patches.empty());
  for (const SupportPatch& patch : patches) {
    for (size_t i = 0; i < patch.gaussians.size(); ++i) {
      EXPECT_NEAR(base_color_of(patch.gaussians, i).y, kFloorColor.y, 0.05);
      EXPECT_EQ(room_.labels.label[patch.sources[i]], small_room::kFloor);
    }
  }
}

TEST_F(FillRemoved, WhatNobodyCouldSeeIsMadeAnew) {
  add_floor();
  add_wall();
  small_room::add_gaussian(model_, {0, -0.2f, 1}, {0, 0, -1}, kBookColor, kWall);      // behind the box
  small_room::add_gaussian(model_, {1.2f, -0.22f, 1}, {0, 0, -1}, kBookColor, kWall);  // beside, in view
  add_box();
  const auto patches = fill();
  size_t behind = 0, beside = 0;
  for (size_t i = 0; i < debris_.size(); ++i) {
    if (!debris_[i]) continue;
    (model_.positions[3 * i] > 1 ? beside : behind) += 1;
  }
  EXPECT_GE(behind, 1u);
  EXPECT_EQ(beside, 0u);
  EXPECT_GT(near(patches, {0, -0.2, 1}), 0u) << "its place is filled";
}

TEST_F(FillRemoved, ASpeckOfTheBoxOnTheFloorGoesWithIt) {
  add_floor();
  add_box();
  small_room::add_gaussian(model_, {0.23f, 0, 0.4f}, {0, -1, 0}, {0.8f, 0.3f, 0.3f}, small_room::kFloor);
  called_floor_ = {model_.size() - 1};
  cameras_.clear();
  fill();
  EXPECT_EQ(debris_[called_floor_[0]], 1);
  EXPECT_EQ(debris_beyond(0.3f), 0u) << "the floor around stays";
}

TEST_F(FillRemoved, FloorUnderAnOverhangIsMadeAnew) {
  add_floor();
  small_room::add_gaussian(model_, {0, 0, 0.55f}, {0, -1, 0}, kFloorColor, small_room::kFloor);
  const size_t under = model_.size() - 1;
  called_floor_ = {under};
  small_room::add_box(model_, mesh_, {-0.2f, -0.4f, 0.35f}, {0.2f, -0.1f, 0.75f}, {0.8f, 0.3f, 0.3f},
                      small_room::kBox);  // on legs of 10 cm
  cameras_.clear();
  EXPECT_GT(near(fill(), {0, 0, 0.55}), 0u);
  EXPECT_EQ(debris_[under], 1);
}

TEST_F(FillRemoved, TheShadeAroundTheBoxGoesWithIt) {
  add_floor();
  for (float z = 0.36f; z < 0.75f; z += 0.02f)
    small_room::add_gaussian(model_, {0.3f, 0, z}, {0, -1, 0}, kFloorColor * 0.6f, small_room::kFloor);
  const size_t shaded = model_.size() - 1;
  add_box();
  cameras_.clear();
  fill();
  EXPECT_EQ(debris_[shaded], 1);
}

TEST_F(FillRemoved, FaintShadeAroundTheBoxIsLifted) {
  constexpr float kFaint = 0.9f;
  const auto is_shaded = [](float x, float z) { return std::abs(x) < 0.45f && z > 0.1f; };
  color_floor([&](float x, float z) { return kFloorColor * (is_shaded(x, z) ? kFaint : 1.f); });
  add_box();
  fill();
  size_t lifted = 0;
  for (size_t i = 0; i < lighter_.gaussians.size(); ++i) {
    const float* p = &lighter_.gaussians.positions[3 * i];
    if (std::abs(p[0]) > 0.35f || p[2] < 0.2f) continue;  // the edge of the shade is in the same cell as the light
    ++lifted;
    EXPECT_NEAR(base_color_of(lighter_.gaussians, i).x, kFloorColor.x, 0.03);
  }
  EXPECT_GT(lifted, 50u);
}

TEST_F(FillRemoved, ALighterCopyReplacesEachShadedGaussian) {
  color_floor([&](float x, float z) { return kFloorColor * (std::abs(x) < 0.45f && z > 0.1f ? 0.9f : 1.f); });
  add_box();
  fill();
  EXPECT_EQ(static_cast<size_t>(std::count(shaded_.begin(), shaded_.end(), 1)), lighter_.sources.size());
  for (const uint32_t row : lighter_.sources) EXPECT_TRUE(shaded_[row]);
}

TEST_F(FillRemoved, LightFarFromTheBoxStays) {
  color_floor([](float x, float) { return kFloorColor * (x > 0.9f ? 0.9f : 1.f); });
  add_box();
  fill();
  EXPECT_TRUE(lighter_.sources.empty()) << "darkness beyond its reach is not its shade";
}

TEST_F(FillRemoved, AWallGoesOnDownToTheFootOfWhatHidIt) {
  add_floor();
  for (float x = -1.48f; x < 1.5f; x += small_room::kSpacing) {
    for (float y = -1.58f; y < -0.7f; y += small_room::kSpacing)
      small_room::add_gaussian(model_, {x, y, 1}, {0, 0, -1}, kWallColor, kWall);
  }
  add_box();
  EXPECT_GT(near(fill(), {0, -0.15, 1}), 0u);
}

TEST_F(FillRemoved, TheShadeBetweenLegsGoesWithThem) {
  add_floor();
  std::vector<size_t> shade;
  for (float x = -0.1f; x < 0.1f; x += 0.02f) {  // farther from the legs than shade falls beside them
    shade.push_back(model_.size());
    small_room::add_gaussian(model_, {x, 0, 0.5f}, {0, -1, 0}, kFloorColor * 0.3f, small_room::kFloor);
  }
  const Vec3f color{0.8f, 0.3f, 0.3f};
  for (const float x : {-0.4f, 0.36f}) {
    for (const float z : {0.2f, 0.76f})
      small_room::add_box(model_, mesh_, {x, -0.4f, z}, {x + 0.04f, 0, z + 0.04f}, color, small_room::kBox);
  }
  small_room::add_box(model_, mesh_, {-0.4f, -0.5f, 0.2f}, {0.4f, -0.4f, 0.8f}, color, small_room::kBox);
  cameras_.clear();
  fill();
  for (const size_t row : shade) EXPECT_EQ(debris_[row], 1);
}

TEST_F(FillRemoved, ShadeThatPhotosCallTheBoxGoesWithIt) {
  add_floor();
  const size_t shaded = model_.size();
  small_room::add_gaussian(model_, {0.36f, 0, 0.5f}, {0, -1, 0}, kFloorColor * 0.3f, small_room::kBox);
  add_box();
  cameras_.clear();
  unselected_ = {shaded};
  crumbs_ = {shaded};
  fill();
  EXPECT_EQ(debris_[shaded], 1);
}

TEST_F(FillRemoved, AThinRimOfTheSurfaceIsFilledToo) {
  add_floor();
  for (size_t i = 0; i < model_.size(); ++i) {
    const float* p = &model_.positions[3 * i];
    if (std::abs(p[0]) < 0.3f && p[2] > 0.3f && p[2] < 0.8f) model_.opacity_logits[i] = 1;  // opacity 0.73
  }
  const auto new_beside = [&] {
    size_t count = 0;
    for (const SupportPatch& patch : fill()) {
      for (size_t i = 0; i < patch.gaussians.size(); ++i) count += std::abs(patch.gaussians.positions[3 * i]) > 0.24f;
    }
    return count;
  };
  add_box();
  cameras_.clear();
  const size_t thin = new_beside();
  for (float& logit : model_.opacity_logits) logit = 5;
  EXPECT_GT(thin, new_beside());
}

TEST_F(FillRemoved, ADarkColourOfTheSurfaceIsNoShade) {
  add_floor();
  for (float x = -1.4f; x < 1.5f; x += 0.05f) {  // dark stripes all over the floor
    for (float z = -0.98f; z < 1; z += 0.02f) {
      const bool under = std::abs(x) < 0.25f && z > 0.35f && z < 0.75f;
      if (!under) small_room::add_gaussian(model_, {x, 0, z}, {0, -1, 0}, kFloorColor * 0.6f, small_room::kFloor);
    }
  }
  add_box();
  cameras_.clear();
  fill();
  EXPECT_EQ(debris_beyond(0.3f), 0u);
}

TEST_F(FillRemoved, AScrapOfTheBoxInTheAirGoesWithIt) {
  add_floor();
  add_box();
  unselected_ = {model_.size() - 1};
  fill();
  EXPECT_EQ(debris_[unselected_[0]], 1);
}

TEST_F(FillRemoved, ARugContinuesWithinItsRectangle) {
  add_floor();
  for (float x = -0.6f; x < 0.6f; x += 0.03f) {
    for (float z = -0.2f; z < 1; z += 0.03f) {
      const bool under = std::abs(x) < 0.2f && z > 0.35f && z < 0.75f;
      if (!under) small_room::add_gaussian(model_, {x, -0.01f, z}, {0, -1, 0}, {0.2f, 0.2f, 0.6f}, kRug);
    }
  }
  add_box();
  size_t rug = 0, floor = 0;
  for (const SupportPatch& patch : fill()) {
    for (size_t i = 0; i < patch.gaussians.size(); ++i) {
      const bool under =
          std::abs(patch.gaussians.positions[3 * i]) < 0.18f && patch.gaussians.positions[3 * i + 2] < 0.73f;
      if (!under) continue;
      (room_.labels.label[patch.sources[i]] == kRug ? rug : floor) += 1;
    }
  }
  EXPECT_GT(rug, 20u);
  EXPECT_EQ(floor, 0u);
}

/// The selection leaves some rows of it out, for their neighbours are floor.
TEST_F(FillRemoved, RemainsOfARemovedRugAreNoSource) {
  add_floor();
  const Vec3f blue{0.2f, 0.2f, 0.6f};
  for (float x = -0.6f; x < 0.6f; x += 0.03f) {
    for (float z = -0.2f; z < 0.9f; z += 0.03f) {
      small_room::add_gaussian(model_, {x, -0.01f, z}, {0, -1, 0}, blue, kRug);
      if (model_.size() % 40 == 0) unselected_.push_back(model_.size() - 1);
    }
  }
  ASSERT_GE(unselected_.size(), 20u);
  taken_ = kRug;
  size_t made = 0;
  for (const SupportPatch& patch : fill()) {
    for (size_t i = 0; i < patch.gaussians.size(); ++i, ++made) {
      EXPECT_NEAR(base_color_of(patch.gaussians, i).z, kFloorColor.z, 0.05);
      EXPECT_EQ(room_.labels.label[patch.sources[i]], small_room::kFloor);
    }
  }
  EXPECT_GT(made, 20u);
  for (const size_t row : unselected_) EXPECT_EQ(debris_[row], 1) << "its colour is none of the floor's";
}

TEST_F(FillRemoved, AWindowStaysOpen) {
  add_floor();
  add_wall(-0.4f, 0.4f);
  for (float x = -0.38f; x < 0.4f; x += small_room::kSpacing) {
    for (float y = -1.5f; y < -0.3f; y += small_room::kSpacing)
      small_room::add_gaussian(model_, {x, y, 1.1f}, {0, 0, -1}, {0.9f, 0.95f, 1}, kWindow);
  }
  add_box();
  EXPECT_EQ(near(fill(), {0, -0.45, 1}), 0u);
}

/// Two legs of a table beyond the box, 74 cm apart, with nothing between them.
TEST_F(FillRemoved, LegsAreNoPlate) {
  add_floor();
  for (const float side : {-0.37f, 0.37f}) {
    for (float x = side - 0.02f; x < side + 0.03f; x += 0.02f) {
      for (float y = -0.5f; y < -0.02f; y += 0.02f)
        small_room::add_gaussian(model_, {x, y, 0.8f}, {0, 0, -1}, kFloorColor, kTable);
    }
  }
  add_box();
  cameras_.clear();
  for (const SupportPatch& patch : fill()) {
    for (const uint32_t source : patch.sources) EXPECT_NE(room_.labels.label[source], kTable);
  }
}

/// The front of a cabinet behind the box and beside it.
TEST_F(FillRemoved, AHiddenSideOfAThingGoesWhereItsColourIsForeign) {
  add_floor();
  const Vec3f brown{0.5f, 0.35f, 0.2f};
  for (float x = -0.1f; x < 1; x += 0.03f) {
    for (float y = -0.34f; y < 0; y += 0.03f)
      small_room::add_gaussian(model_, {x, y, 0.9f}, {0, 0, -1}, brown, kCabinet);
  }
  const size_t like = model_.size();
  small_room::add_gaussian(model_, {0.01f, -0.2f, 0.9f}, {0, 0, -1}, brown, kCabinet);
  const size_t foreign = model_.size();
  small_room::add_gaussian(model_, {0, -0.2f, 0.9f}, {0, 0, -1}, kBookColor, kCabinet);
  add_box();
  fill();
  EXPECT_EQ(debris_[foreign], 1);
  EXPECT_EQ(debris_[like], 0);
}

TEST_F(FillRemoved, AWideGaussianThatNoPhotoShowsGoes) {
  add_floor();
  const Vec3f brown{0.5f, 0.35f, 0.2f};
  for (float x = -0.1f; x < 1; x += 0.03f) {
    for (float y = -0.34f; y < 0; y += 0.03f)
      small_room::add_gaussian(model_, {x, y, 0.9f}, {0, 0, -1}, brown, kCabinet);
  }
  const size_t wide = model_.size();
  small_room::add_gaussian(model_, {0.01f, -0.2f, 0.9f}, {0, 0, -1}, brown, kCabinet);
  for (size_t a = 0; a < 2; ++a) model_.log_scales[3 * wide + a] = std::log(0.2f);
  const size_t shown = model_.size();
  small_room::add_gaussian(model_, {0.9f, -0.2f, 0.9f}, {0, 0, -1}, brown, kCabinet);
  for (size_t a = 0; a < 2; ++a) model_.log_scales[3 * shown + a] = std::log(0.2f);
  add_box();
  fill();
  EXPECT_EQ(debris_[wide], 1);
  EXPECT_EQ(debris_[shown], 0);
}

TEST_F(FillRemoved, AColourThatNoPhotoShowsIsNoSource) {
  add_floor();
  for (float x = -0.3f; x < 0.3f; x += 0.02f)  // right behind the box, beyond its halo
    small_room::add_gaussian(model_, {x, 0, 0.84f}, {0, -1, 0}, kBookColor, small_room::kFloor);
  add_box();
  for (const SupportPatch& patch : fill()) {
    for (size_t i = 0; i < patch.gaussians.size(); ++i)
      EXPECT_NEAR(base_color_of(patch.gaussians, i).y, kFloorColor.y, 0.05);
  }
}

TEST_F(FillRemoved, StripesOfTheFloorContinueInPhase) {
  constexpr float kPeriod = 0.24f;  // metres
  const auto wave = [](float x) { return std::sin(2 * 3.14159265f * x / kPeriod); };
  color_floor([&](float x, float) { return kFloorColor * (wave(x) > 0 ? 1.f : 0.6f); });
  add_box();
  cameras_.clear();
  size_t right = 0, all = 0;
  for (const SupportPatch& patch : fill()) {
    for (size_t i = 0; i < patch.gaussians.size(); ++i) {
      const float* p = &patch.gaussians.positions[3 * i];
      if (std::abs(p[0]) > 0.18f || p[2] < 0.38f || p[2] > 0.72f || std::abs(wave(p[0])) < 0.7f) continue;
      ++all;
      right += (base_color_of(patch.gaussians, i).x > 0.8f * kFloorColor.x) == (wave(p[0]) > 0);
    }
  }
  ASSERT_GT(all, 20u);
  EXPECT_GT(static_cast<double>(right), 0.9 * static_cast<double>(all));
}

/// Squares of 12 cm, dark or bright at random.
TEST_F(FillRemoved, WhatHasNoPatternKeepsItsMeanAndItsRange) {
  const auto is_dark = [](float x, float z) {
    const uint32_t i = static_cast<uint32_t>((x + 9) / 0.12f), j = static_cast<uint32_t>((z + 9) / 0.12f);
    uint32_t hash = (i * 73856093u) ^ (j * 19349663u);
    for (int round = 0; round < 3; ++round) hash = (hash ^ (hash >> 15)) * 2246822519u;
    return (hash >> 20 & 1u) != 0;
  };
  color_floor([&](float x, float z) { return kFloorColor * (is_dark(x, z) ? 0.6f : 1.f); });
  add_box();
  cameras_.clear();
  double sum = 0;
  size_t made = 0;
  for (const SupportPatch& patch : fill()) {
    for (size_t i = 0; i < patch.gaussians.size(); ++i) {
      const float* p = &patch.gaussians.positions[3 * i];
      if (std::abs(p[0]) > 0.2f || p[2] < 0.35f || p[2] > 0.75f) continue;
      ++made;
      const double bright = base_color_of(patch.gaussians, i).x / kFloorColor.x;
      sum += bright;
      EXPECT_GT(bright, 0.55);
      EXPECT_LT(bright, 1.05);
    }
  }
  ASSERT_GT(made, 10u);
  EXPECT_NEAR(sum / static_cast<double>(made), 0.8, 0.1);
}

TEST_F(FillRemoved, WithoutSurfacesNothingIsMade) {
  add_box();
  small_room::add_gaussian(model_, {1, 0, 1}, {0, -1, 0}, kBookColor, kBook);
  EXPECT_TRUE(fill().empty());
}

}  // namespace
}  // namespace aligngs
