#include "edit/whole_rugs.h"

#include <gtest/gtest.h>

#include <functional>

#include "core/random.h"
#include "edit/testing/small_room.h"

namespace aligngs {
namespace {

constexpr uint16_t kRug = 28;       // ADE20K
constexpr float kRugPitch = 0.02f;  // metres between Gaussians

/// A brown floor of three metres, brighter to one side, and in its middle a rug of 1.2 m x 0.8 m with a pattern.
class WholeRugs : public testing::Test {
 protected:
  static bool on_rug(float x, float z) { return std::fabs(x) < 0.6f && std::fabs(z) < 0.4f; }

  static Vec3f rug_color(float x, float z) {
    if (std::fabs(x) > 0.45f || std::fabs(z) > 0.25f) return {0.85f, 0.8f, 0.7f};  // a bright border
    const bool dark = (static_cast<int>(std::floor(x / 0.1f)) + static_cast<int>(std::floor(z / 0.1f))) % 2 == 0;
    return dark ? Vec3f{0.15f, 0.2f, 0.5f} : Vec3f{0.6f, 0.15f, 0.15f};
  }
  static Vec3f floor_color(float x, float) { return Vec3f{0.5f, 0.35f, 0.2f} * (1 + 0.15f * x); }

  /// `number` of the rug at a place, 0 where the labels say floor.
  void make(const std::function<uint16_t(float x, float z)>& number, bool same_colors = false) {
    room_ = {};
    room_.named = true;
    room_.extent = small_room::kExtent;
    room_.labels.label_set = labels_.name;
    Random noise(1);
    for (float z = -1.49f; z < 1.5f; z += kRugPitch) {
      for (float x = -1.49f; x < 1.5f; x += kRugPitch) {
        Vec3f color = on_rug(x, z) && !same_colors ? rug_color(x, z) : floor_color(x, z);
        for (int c = 0; c < 3; ++c) color[c] += static_cast<float>(0.02 * noise.normal());
        small_room::add_gaussian(room_.model, {x, 0, z}, {0, -1, 0}, color, -1);
        const uint16_t n = number(x, z);
        room_.labels.label.push_back(n > 0 ? kRug : small_room::kFloor);
        room_.labels.instance.push_back(n > 0 ? n : uint16_t(1));
        room_.labels.confidence.push_back(255);
        true_rug_.resize(room_.labels.label.size());
        true_rug_.back() = on_rug(x, z);
      }
    }
  }

  size_t complete() {
    Camera camera;
    camera.width = camera.height = 64;
    camera.fx = camera.fy = 50;
    camera.cx = camera.cy = 32;
    camera.world_to_camera.translation = {0, 1.5, 0};  // above the floor: up is -y
    return complete_rugs(room_, labels_, {camera});
  }

  /// Intersection over union of the Gaussians with the rug's label and those of the true rug.
  double iou() const {
    size_t both = 0, either = 0;
    for (size_t i = 0; i < true_rug_.size(); ++i) {
      const bool labelled = room_.labels.label[i] == kRug;
      both += labelled && true_rug_[i];
      either += labelled || true_rug_[i];
    }
    return static_cast<double>(both) / static_cast<double>(either);
  }
  size_t count(uint16_t number) const {
    size_t n = 0;
    for (size_t i = 0; i < true_rug_.size(); ++i)
      n += room_.labels.label[i] == kRug && room_.labels.instance[i] == number;
    return n;
  }

  LabelSet labels_ = ade20k_labels();
  LabelledGaussians room_;
  std::vector<uint8_t> true_rug_;
};

TEST_F(WholeRugs, APieceWithTheLabelBecomesTheWholeRug) {
  make([](float x, float z) { return uint16_t(on_rug(x, z) && x < -0.2f && z < x + 0.5f); });
  ASSERT_LT(iou(), 0.4);
  EXPECT_GT(complete(), 0u);
  EXPECT_GT(iou(), 0.95);
}

TEST_F(WholeRugs, TwoPiecesBecomeOneObject) {
  make([](float x, float z) {
    if (!on_rug(x, z)) return uint16_t(0);
    return x > 0.1f + 0.3f * z ? uint16_t(2) : x < -0.1f - 0.4f * z && z < 0.2f ? uint16_t(1) : uint16_t(0);
  });
  const size_t all = static_cast<size_t>(std::count(true_rug_.begin(), true_rug_.end(), 1));
  complete();
  EXPECT_GT(iou(), 0.95);
  EXPECT_NEAR(static_cast<double>(std::max(count(1), count(2))), static_cast<double>(all), 0.05 * all);
}

TEST_F(WholeRugs, AWholeRugStaysAsItIs) {
  make([](float x, float z) { return uint16_t(on_rug(x, z)); });
  EXPECT_EQ(complete(), 0u);
  EXPECT_EQ(iou(), 1);
}

TEST_F(WholeRugs, ALabelOnBareFloorDoesNotGrow) {
  make([](float x, float z) { return uint16_t(on_rug(x, z) && z < x); }, true);
  const size_t before = count(1);
  EXPECT_EQ(complete(), 0u);
  EXPECT_EQ(count(1), before);
}

TEST_F(WholeRugs, AFewGaussiansTellNoColours) {
  make([](float x, float z) { return uint16_t(std::fabs(x) < 0.02f && std::fabs(z) < 0.02f); });
  EXPECT_EQ(complete(), 0u);
}

TEST_F(WholeRugs, WithoutAFloorNothingChanges) {
  make([](float x, float z) { return uint16_t(on_rug(x, z) && z < x); });
  for (uint16_t& label : room_.labels.label) {
    if (label == small_room::kFloor) label = kNoLabel;
  }
  EXPECT_EQ(complete(), 0u);
}

TEST_F(WholeRugs, WithoutARugNothingChanges) {
  make([](float, float) { return uint16_t(0); });
  EXPECT_EQ(complete(), 0u);
}

}  // namespace
}  // namespace aligngs
