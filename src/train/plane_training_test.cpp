// Runs whose planes are fitted in the loop, on the box room.
#include <gtest/gtest.h>

#include "core/log.h"
#include "core/stop_signal.h"
#include "io/atomic_file.h"
#include "scene/test_scene_folder.h"
#include "train/resumed_runs_for_tests.h"
#include "train/run_folder.h"
#include "train/train_run.h"
#include "train/trained_room_for_tests.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

SceneViewParts photo(int index, const Camera& camera) {
  const LayoutView seen = box_room::look(camera);
  SceneViewParts view;
  view.name = "v" + std::to_string(index);
  view.camera = camera;
  view.image = Image<uint8_t>(camera.width, camera.height, 3);
  for (size_t i = 0; i < view.image.data.size(); ++i) view.image.data[i] = static_cast<uint8_t>(255 * seen.color.data[i]);
  view.prior_depth = seen.plane.depth;
  view.semantics = {4, camera.width, camera.height, std::vector<float>(4 * seen.plane.labels.data.size(), 0.01f)};
  for (size_t i = 0; i < seen.plane.labels.data.size(); ++i) {
    view.semantics.values[seen.plane.labels.data[i] * seen.plane.labels.data.size() + i] = 0.97f;
  }
  return view;
}

fs::path write_room() {
  const fs::path folder = test_scene::fresh_folder("room");
  SceneWriter writer(folder, false);
  SceneParts parts = test_scene::scene_parts();
  parts.split.train = {std::vector<std::string>()};
  parts.split.test = {{"v5"}};
  parts.labels = box_room::room_labels();
  int index = 0;
  for (const Camera& camera : box_room::cameras()) {
    writer.add_view(photo(index, camera.resized(camera.width / 2, camera.height / 2)));
    if (index < 5) parts.split.train->push_back("v" + std::to_string(index));
    ++index;
  }
  writer.finish(parts);
  return folder;
}

class PlaneTraining : public testing::Test {
 protected:
  void SetUp() override {
    set_log_level(LogLevel::kSilent);
    clear_stop_request();
    static const fs::path scene = write_room();
    scene_ = scene;
    base_ = test_scene::fresh_folder("runs");
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  TrainOptions options(const std::string& run, const std::string& weight = "1") const {
    TrainOptions o;
    o.scene = scene_;
    o.run = base_ / run;
    o.config.iterations = 24;
    o.config.sets = {"checkpoint.every=10", "train.reference_iterations=240", "loss.plane_every=80", "loss.plane_weight=" + weight,
                     "train.closed_room=false", "loss.depth_align_every=110"};
    o.progress.enabled = false;
    o.threads = 2;
    return o;
  }
  static std::string ply(const TrainOptions& o) { return read_file(RunFolder(o.run).scene_ply()); }
  fs::path scene_, base_;
};

TEST_F(PlaneTraining, SaysWhatItFittedAndChangesTheResult) {
  const TrainOptions with = options("with"), without = options("without", "0");
  train_run(with);
  train_run(without);
  EXPECT_NE(read_file(RunFolder(with.run).events()).find("planes of walls, floor and ceiling under"), std::string::npos);
  EXPECT_FALSE(ply(with) == ply(without));
}

TEST_F(PlaneTraining, KilledBetweenFitsAndResumedEndsByteIdentical) {
  const TrainOptions whole = options("whole");
  train_run(whole);
  test_train::expect_resumes(whole, [&](const std::string& name) { return options(name); }, {}, {9, 13, 22});  // fits at 8 and 16, checkpoints at 10 and 20
}

}  // namespace
}  // namespace aligngs
