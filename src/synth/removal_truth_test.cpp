#include "synth/removal_truth.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/image_file.h"
#include "scene/label_set.h"
#include "scene/mesh_ply.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A draft of a bedroom: no shadows, so that only the object itself can change a pixel.
class RemovalTruthTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    SynthOptions options;
    options.views = 8;
    options.test_views = 4;
    options.width = 64;
    options.height = 48;
    options.teacher = TeacherKind::kExact;
    options.shadows = false;
    options.samples_per_side = 1;
    options.degrade_images = false;
    ThreadPool pool(2);
    scene_ = new SynthScene(make_synth_scene(options, pool));
  }
  static void TearDownTestSuite() { delete scene_; }
  static SynthScene* scene_;
  ThreadPool pool_{2};
};
SynthScene* RemovalTruthTest::scene_ = nullptr;

TEST_F(RemovalTruthTest, ObjectsAreNamedByClassAndNumber) {
  const Removal two = parse_removal(scene_->room, "bed#1, chest of drawers#1");
  EXPECT_EQ(two.objects.size(), 2u);
  EXPECT_THAT(two.name, HasSubstr("bed#1+chest_of_drawers#1"));
  EXPECT_GE(parse_removal(scene_->room, "pillow").objects.size(), 2u) << "a class alone means all its objects";
}

TEST_F(RemovalTruthTest, WhatTheRoomLacksIsRefusedWithWhatItHas) {
  for (const char* text : {"spaceship", "bed#9", "", "wall#1"}) {
    try {
      parse_removal(scene_->room, text);
      FAIL() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      EXPECT_THAT(error.what(), HasSubstr("bed#1"));
    }
  }
}

TEST_F(RemovalTruthTest, OnlyTheObjectIsGone) {
  const Removal removal = parse_removal(scene_->room, "bed#1");
  const RoomModel without = room_without(scene_->room, removal);
  EXPECT_LT(without.triangles.size(), scene_->room.triangles.size());
  for (const uint16_t object : without.triangle_object) EXPECT_NE(object, removal.objects[0]);
  EXPECT_EQ(without.objects.size(), scene_->room.objects.size()) << "numbers of objects stay";
}

TEST_F(RemovalTruthTest, PicturesDifferWhereTheObjectWasSeen) {
  const RemovalTruth truth = make_removal_truth(*scene_, parse_removal(scene_->room, "bed#1"), pool_);
  ASSERT_EQ(truth.pictures.size(), scene_->test.size());
  size_t seen = 0, changed_inside = 0, changed_outside = 0;
  for (size_t i = 0; i < truth.pictures.size(); ++i) {
    const Image<uint8_t>& before = scene_->views[static_cast<size_t>(scene_->test[i])].image;
    const Image<uint8_t>& after = truth.pictures[i];
    for (size_t p = 0; p < truth.masks[i].data.size(); ++p) {
      const bool inside = truth.masks[i].data[p] != 0;
      int difference = 0;
      for (size_t c = 0; c < 3; ++c)
        difference = std::max(difference, std::abs(before.data[3 * p + c] - after.data[3 * p + c]));
      constexpr int kVisible = 12;  // levels of 255
      seen += inside;
      changed_inside += inside && difference > kVisible;
      changed_outside += !inside && difference > kVisible;
    }
  }
  EXPECT_GT(seen, 100u);
  EXPECT_GT(2 * changed_inside, seen);
  EXPECT_LT(20 * changed_outside, seen) << "light that the bed threw back is all that may differ";
}

TEST_F(RemovalTruthTest, TheFolderHoldsPicturesMasksMeshAndNames) {
  const fs::path folder = fs::path(testing::TempDir()) / "removal_truth";
  fs::remove_all(folder);
  const RemovalTruth truth = make_removal_truth(*scene_, parse_removal(scene_->room, "bed#1"), pool_);
  write_removal_truth(*scene_, truth, folder);
  const std::string view = scene_->views[static_cast<size_t>(scene_->test[0])].name + ".png";
  EXPECT_TRUE(fs::exists(folder / "bed#1" / "rgb" / view));
  EXPECT_TRUE(fs::exists(folder / "bed#1" / "mask" / view));
  EXPECT_TRUE(fs::exists(folder / "bed#1" / "removal.json"));
  EXPECT_EQ(read_mesh_ply(folder / "bed#1" / "mesh.ply").triangles.size(), truth.mesh.triangles.size());
}

TEST_F(RemovalTruthTest, EveryVertexOfTheMeshIsOfOneListedObject) {
  const nlohmann::json objects = nlohmann::json::parse(room_objects_json(scene_->room)).at("objects");
  EXPECT_EQ(objects.size(), scene_->room.objects.size());
  std::vector<int> owners(scene_->mesh.vertices.size(), 0);
  for (const nlohmann::json& object : objects) {
    const int label = ade20k_labels().find(object.at("class").get<std::string>());
    for (size_t v = object.at("vertices")[0]; v < object.at("vertices")[1].get<size_t>(); ++v) {
      ++owners.at(v);
      EXPECT_EQ(scene_->mesh.labels[v], label);
    }
  }
  EXPECT_EQ(std::count(owners.begin(), owners.end(), 1), static_cast<std::ptrdiff_t>(owners.size()));
}

}  // namespace
}  // namespace aligngs
