#include "train/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "core/log.h"
#include "io/byte_source.h"
#include "io/safetensors.h"
#include "train/checkpoint_planes.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class Checkpoint : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "aligngs_checkpoint_test" /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    set_log_level(LogLevel::kSilent);
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  static TrainingState state_at(int64_t iteration) {
    TrainingState s;
    s.iteration = iteration;
    s.engine.model.semantic_channels = 3;
    s.engine.model.sh_degree = 2;
    s.engine.model.resize(2);
    s.engine.model.positions = {1, 2, 3, 4, 5, static_cast<float>(iteration)};
    s.engine.model.semantics[5] = 0.1f;
    s.engine.arrays["adam_m.positions"] = {0.5f, -0.25f, 1e-30f};
    s.engine.arrays["coupling"] = {};
    s.order.left = {4, 0, 2};
    s.order.random = {1, 2, 3, ~uint64_t(0)};
    s.density_random = {9, 8, 7, 6};
    s.depth_scales = {1.0f, 0.98f};
    s.facts.max_gaussians = 123;
    s.facts.dense_start = true;
    s.psnr_average = 21.123456789012345;
    return s;
  }
  static void flip_bit_of(const fs::path& path, uint64_t offset) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(static_cast<std::streamoff>(offset));
    const char byte = static_cast<char>(file.get());
    file.seekp(static_cast<std::streamoff>(offset));
    file.put(static_cast<char>(byte ^ 4));
  }
  fs::path newest() const { return list_checkpoints(folder_).front(); }

  fs::path folder_;
};

TEST_F(Checkpoint, RoundTripIsExact) {
  const TrainingState s = state_at(7000);
  write_checkpoint(folder_, s, "scene", 2);
  EXPECT_EQ(newest().filename(), "step_007000.safetensors");
  const TrainingState r = read_checkpoint(newest(), "scene");
  EXPECT_EQ(r.iteration, 7000);
  EXPECT_EQ(r.engine.model.positions, s.engine.model.positions);
  EXPECT_EQ(r.engine.model.semantics, s.engine.model.semantics);
  EXPECT_EQ(r.engine.model.sh_degree, 2);
  EXPECT_EQ(r.engine.model.semantic_channels, 3);
  EXPECT_EQ(r.engine.arrays, s.engine.arrays);
  EXPECT_EQ(r.order.left, s.order.left);
  EXPECT_EQ(r.order.random, s.order.random);
  EXPECT_EQ(r.density_random, s.density_random);
  EXPECT_EQ(r.depth_scales, s.depth_scales);
  EXPECT_EQ(r.facts.max_gaussians, 123u);
  EXPECT_TRUE(r.facts.dense_start);
  EXPECT_FALSE(r.facts.normals_at_start);
  EXPECT_EQ(r.psnr_average, s.psnr_average);
}

TEST_F(Checkpoint, MovedCamerasComeBackAndAreAppliedToTheTrainingViewsAlone) {
  TrainingState s = state_at(7);
  s.motions.resize(2);
  s.motions[1].offset = {0.1, 0, 0, 0, 2, 0};
  s.motions[1].v[5] = 1e-30;
  s.motions[1].updates = 41;
  write_checkpoint(folder_, s, "scene", 2);
  const TrainingState r = read_checkpoint(newest(), "scene");
  ASSERT_EQ(r.motions.size(), 2u);
  EXPECT_EQ(r.motions[1].offset, s.motions[1].offset);
  EXPECT_EQ(r.motions[1].v, s.motions[1].v);
  EXPECT_EQ(r.motions[1].updates, 41);

  Scene scene;
  scene.views.resize(3);
  scene.train = {0, 2};
  apply_motions(r.motions, scene);
  EXPECT_EQ(scene.views[1].camera.world_to_camera.translation.y, 0);
  EXPECT_NEAR(scene.views[2].camera.world_to_camera.translation.y, 2, 1e-12);
  scene.train = {0};
  EXPECT_THROW(apply_motions(r.motions, scene), Error);
}

TEST_F(Checkpoint, PlanesComeBack) {
  TrainingState s = state_at(7);
  ViewPlanes one, none;
  one.planes = {{{0, 0.6, -0.8}, 2.5, PlaneKind::kWall, 3}, {{0, 0, -1}, 1.5, PlaneKind::kFloor, 4}};
  one.plane = Image<uint8_t>(3, 2, 1, 2);
  one.weight = Image<uint8_t>(3, 2, 1, 200);
  one.depth_scale = 0.98f;
  none.plane = none.weight = Image<uint8_t>(2, 2, 1);
  s.planes.views = {one, none};
  write_checkpoint(folder_, s, "scene", 2);
  const PlaneTargets r = read_checkpoint(newest(), "scene").planes;
  ASSERT_EQ(r.views.size(), 2u);
  ASSERT_EQ(r.views[0].planes.size(), 2u);
  EXPECT_EQ(r.views[0].planes[0].normal.y, 0.6);
  EXPECT_EQ(r.views[0].planes[1].distance, 1.5);
  EXPECT_EQ(r.views[0].plane.width, 3);
  EXPECT_EQ(r.views[0].plane.data, one.plane.data);
  EXPECT_EQ(r.views[0].weight.data, one.weight.data);
  EXPECT_EQ(r.views[0].depth_scale, 0.98f);
  EXPECT_TRUE(r.views[1].planes.empty());
}

TEST_F(Checkpoint, PlanesThatDoNotFitEachOtherAreRefused) {
  PlaneTargets targets;
  targets.views.resize(1);
  targets.views[0].planes = {{{0, 0, -1}, 1.5, PlaneKind::kFloor, 1}};
  targets.views[0].plane = targets.views[0].weight = Image<uint8_t>(3, 2, 1, 1);
  TensorFile good;
  put_planes(targets, good);
  EXPECT_EQ(take_planes(good, "step").views.size(), 1u);
  const auto expect_refused = [&](const char* tensor, const auto& damage) {
    TensorFile bad = good;
    damage(bad.tensors.at(tensor));
    EXPECT_THROW(take_planes(bad, "step"), Error) << tensor;
  };
  expect_refused("planes.sizes", [](TensorBytes& t) { t.bytes.resize(8); });
  expect_refused("planes.sizes", [](TensorBytes& t) { t.bytes[7] = 0x7f; });  // a width beyond all bounds
  expect_refused("planes.sizes", [](TensorBytes& t) { t.bytes[0] = 4; });
  expect_refused("planes.frames", [](TensorBytes& t) { t.bytes.resize(24); });
  expect_refused("planes.scales", [](TensorBytes& t) { t.bytes.clear(); });
  expect_refused("planes.numbers", [](TensorBytes& t) { t.bytes[5] = 2; });
  expect_refused("planes.weights", [](TensorBytes& t) { t.dtype = "F32"; });
}

TEST_F(Checkpoint, KeepsTheLastK) {
  for (const int64_t i : {100, 200, 300, 1000000}) write_checkpoint(folder_, state_at(i), "scene", 2);
  const std::vector<fs::path> all = list_checkpoints(folder_);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].filename(), "step_1000000.safetensors");
  EXPECT_EQ(all[1].filename(), "step_000300.safetensors");
}

TEST_F(Checkpoint, WhoOnlyLooksReadsNoMoments) {
  const TrainingState s = state_at(100);
  write_checkpoint(folder_, s, "scene", 2);
  const TrainingState r = read_checkpoint(newest(), "scene", CheckpointParts::kWithoutEngineArrays);
  EXPECT_TRUE(r.engine.arrays.empty());
  EXPECT_EQ(r.engine.model.semantics, s.engine.model.semantics);
  EXPECT_EQ(r.order.random, s.order.random);
}

TEST_F(Checkpoint, TruncatedNewestFallsBackToThePrevious) {
  write_checkpoint(folder_, state_at(100), "scene", 2);
  write_checkpoint(folder_, state_at(200), "scene", 2);
  fs::resize_file(newest(), fs::file_size(newest()) / 2);
  EXPECT_EQ(read_latest_checkpoint(folder_, "scene")->iteration, 100);
}

TEST_F(Checkpoint, OneFlippedBitIsNoticed) {
  write_checkpoint(folder_, state_at(100), "scene", 2);
  write_checkpoint(folder_, state_at(200), "scene", 2);
  const TensorDirectory directory = read_safetensors_directory(*file_source(newest()));
  flip_bit_of(newest(), directory.tensors.at("engine.adam_m.positions").offset);
  for (const CheckpointParts parts : {CheckpointParts::kAll, CheckpointParts::kWithoutEngineArrays}) {
    // whether or not the damaged part is wanted
    EXPECT_EQ(read_latest_checkpoint(folder_, "scene", parts)->iteration, 100);
  }
}

TEST_F(Checkpoint, AnEmptyTensorHidesNoDamageBeforeIt) {
  TrainingState s = state_at(100);
  s.order.left.clear();  // as after each pass over the photos; in the file it comes after the model
  write_checkpoint(folder_, s, "scene", 2);
  const TensorDirectory directory = read_safetensors_directory(*file_source(newest()));
  flip_bit_of(newest(), directory.tensors.at("model.positions").offset);
  EXPECT_THROW(read_checkpoint(newest(), "scene"), Error);
}

TEST_F(Checkpoint, WithoutAGoodOneThereIsNone) {
  EXPECT_FALSE(read_latest_checkpoint(folder_, "scene").has_value());
  EXPECT_FALSE(read_latest_checkpoint(folder_ / "absent", "scene").has_value());
  std::ofstream(folder_ / "step_000100.safetensors") << "garbage";
  EXPECT_FALSE(read_latest_checkpoint(folder_, "scene").has_value());
}

TEST_F(Checkpoint, AnotherSceneIsRefused) {
  write_checkpoint(folder_, state_at(100), "scene", 2);
  try {
    read_latest_checkpoint(folder_, "another scene");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kBadInput);
    EXPECT_THAT(e.details().remedy, testing::HasSubstr("--overwrite"));
  }
}

TEST_F(Checkpoint, FilesOfOtherNamesAreIgnored) {
  for (const char* name :
       {"step_.safetensors", "step_12a.safetensors", "step_000001.safetensors.tmp-1-1", "notes.txt"}) {
    std::ofstream(folder_ / name) << "x";
  }
  EXPECT_TRUE(list_checkpoints(folder_).empty());
}

}  // namespace
}  // namespace aligngs
