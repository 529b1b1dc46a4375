// Every command reports Ctrl-C, SIGTERM and SIGHUP, and leaves the old output and nothing half-written.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <map>

#include "edit/edit_lock.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "support/process.h"
#include "support/small_scene.h"
#include "support/started_process.h"
#include "support/stop_fixture.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::kPatienceWithAStop;
using testing_support::kStatusOfAStop;
using testing_support::run_aligngs;
using testing_support::StartedProcess;
using testing_support::StopFixture;
using testing_support::wait_until;
using Words = std::vector<std::string>;

class Stop : public StopFixture {
 protected:
  /// Content of work/, the folder for outputs, including earlier output.
  void remember() {
    for (const auto& entry : fs::recursive_directory_iterator(root_ / "work")) {
      if (entry.is_regular_file()) before_[entry.path()] = read_file(entry.path());
    }
  }
  void expect_as_before() const {
    size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(root_ / "work")) {
      EXPECT_EQ(entry.path().string().find(".tmp"), std::string::npos) << entry.path();
      EXPECT_EQ(entry.path().string().find(".work-"), std::string::npos) << entry.path();
      if (!entry.is_regular_file()) continue;
      ++files;
      const auto old = before_.find(entry.path());
      EXPECT_TRUE(old != before_.end() && read_file(entry.path()) == old->second) << entry.path();
    }
    EXPECT_EQ(files, before_.size());
  }
  /// Starts a command that would take much longer, sends it a signal when `begun` holds, and looks at how it ends.
  void expect_stopped(const Words& command, int signal, const std::function<bool()>& begun) {
    StartedProcess process(command, root_ / "scratch");
    ASSERT_TRUE(wait_until([&] { return process.catches(signal) && begun(); }, kPatienceWithAStop))
        << command[0] << process.err();
    process.send(signal);
    EXPECT_EQ(process.wait(kPatienceWithAStop), kStatusOfAStop) << command[0] << process.err();
    EXPECT_THAT(process.err(), HasSubstr(signal == SIGINT    ? "Ctrl-C was heard"
                                         : signal == SIGTERM ? "SIGTERM was heard"
                                                             : "SIGHUP was heard"));
    expect_as_before();
  }
  static bool at_once() { return true; }
  /// Something half-written is in work/.
  std::function<bool()> writing() const {
    return [this] {
      for (const auto& entry : fs::directory_iterator(root_ / "work")) {
        const std::string name = entry.path().filename().string();
        if (name.find(".tmp-") != std::string::npos || name.find(".work-") != std::string::npos) return true;
      }
      return false;
    };
  }
  std::map<fs::path, std::string> before_;
};

/// Photos whose lens has to be undone, so that reading them takes long.
void write_distorted_capture(const fs::path& folder) {
  constexpr int kPhotos = 200;
  Image<uint8_t> photo(1600, 1200, 3);
  for (size_t i = 0; i < photo.data.size(); ++i) photo.data[i] = static_cast<uint8_t>(i * 2654435761u >> 24);
  fs::create_directories(folder / "images");
  write_jpeg(folder / "images" / "p000.jpg", photo);
  std::string images;
  for (int i = 0; i < kPhotos; ++i) {
    const std::string name = "p" + std::string(i < 10 ? "00" : i < 100 ? "0" : "") + std::to_string(i) + ".jpg";
    if (i > 0) fs::copy_file(folder / "images" / "p000.jpg", folder / "images" / name);
    images += std::to_string(i + 1) + " 1 0 0 0 " + std::to_string(i) + " 0 0 1 " + name + "\n\n";
  }
  write_file_atomically(folder / "sparse" / "cameras.txt", "1 SIMPLE_RADIAL 1600 1200 1400 800 600 0.05\n");
  write_file_atomically(folder / "sparse" / "images.txt", images);
  write_file_atomically(folder / "sparse" / "points3D.txt", "1 0 0 2 100 100 100 0.5 1 0 2 0\n");
}

TEST_F(Stop, Synth) {
  expect_stopped({"synth", path("work/out"), "--size", "1280x960", "--views", "200", "--test-views", "20"}, SIGTERM,
                 at_once);
}

TEST_F(Stop, ImportKeepsTheOldScene) {
  write_distorted_capture(root_ / "capture");
  testing_support::write_small_scene(root_ / "work" / "out");
  remember();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    expect_stopped(
        {"import", path("capture"), "-o", path("work/out"), "--overwrite", "--stride", "1", "--test-views", "0"},
        signal, writing());
  }
}

TEST_F(Stop, PosesGivenKeepsTheOldScene) {
  write_distorted_capture(root_ / "capture");
  testing_support::write_small_scene(root_ / "work" / "out");
  remember();
  const Words command = {
      "poses",     path("capture/images"), "-o", path("work/out"), "--overwrite", "--method", "given",
      "--cameras", path("capture/sparse")};
  expect_stopped(command, SIGHUP, writing());
}

TEST_F(Stop, RefineSimulateAndTheRefinementInsideARun) {
  testing_support::write_small_scene(root_ / "scene", {160, 120, 40, 4, true});
  const std::string scene = path("scene");
  expect_stopped({"refine", scene, "-o", path("work/out"), "--passes", "5"}, SIGINT, at_once);
  expect_stopped({"data", "simulate", scene, "-o", path("work/out")}, SIGTERM, at_once);
  StartedProcess run({"run", scene, "-o", path("work/run"), "-n", "100000"}, root_ / "scratch");
  ASSERT_TRUE(
      wait_until([&] { return run.catches(SIGTERM) && fs::exists(root_ / "work" / "run"); }, kPatienceWithAStop))
      << run.err();
  run.send(SIGTERM);
  EXPECT_EQ(run.wait(kPatienceWithAStop), kStatusOfAStop) << run.err();
  EXPECT_THAT(run.err(), HasSubstr("SIGTERM was heard"));
  for (const auto& entry : fs::recursive_directory_iterator(root_ / "work" / "run")) {
    EXPECT_EQ(entry.path().string().find(".tmp"), std::string::npos) << entry.path();
  }
}

/// A command that waits for a file hears signals, too: here for run.json, which is a pipe that nobody writes to.
/// Reading a pipe would wait for somebody to write.
TEST_F(Stop, CommandsOnARunDoNotWaitForAPipe) {
  fs::create_directories(root_ / "work" / "run");
  for (const char* file : {"scene.ply", "edits.json", "metrics.json"})
    write_file_atomically(root_ / "work" / "run" / file, "old");
  remember();
  ASSERT_EQ(mkfifo((root_ / "work" / "run" / "run.json").c_str(), 0600), 0);
  const std::string run = path("work/run");
  for (const std::string& command :
       {"mesh " + run, "eval " + run, "render " + run, "export " + run + " -f spz",
        "edit " + run + " --select bed --delete", "export " + run + " -f glb -o " + path("work/out.glb")}) {
    const auto result = run_aligngs(command, root_ / "scratch");
    EXPECT_EQ(result.status, 3) << command;
    EXPECT_THAT(result.err, HasSubstr("this is a pipe")) << command;
    expect_as_before();
  }
}

TEST_F(Stop, AnEditThatWaitsForAnother) {
  testing_support::write_small_scene(root_ / "scene");
  ASSERT_EQ(run_aligngs("train " + path("scene") + " -o " + path("run") + " -n 2", root_ / "scratch").status, 0);
  const EditLock lock(root_ / "run", "an edit of somebody else", 0);
  expect_stopped({"edit", path("run"), "--select", "wall", "--recolor", "#ff0000", "--wait", "600"}, SIGTERM, at_once);
}

TEST_F(Stop, ATrainingStopsWithACheckpoint) {
  testing_support::write_small_scene(root_ / "scene");
  StartedProcess training({"train", path("scene"), "-o", path("run"), "-n", "1000000"}, root_ / "scratch");
  ASSERT_TRUE(wait_until([&] { return fs::exists(root_ / "run" / "events.ndjson"); }, kPatienceWithAStop))
      << training.err();
  training.send(SIGHUP);
  EXPECT_EQ(training.wait(kPatienceWithAStop), kStatusOfAStop) << training.err();
  EXPECT_THAT(training.err(), HasSubstr("a checkpoint is written"));
  EXPECT_FALSE(fs::is_empty(root_ / "run" / "checkpoints"));
}

TEST_F(Stop, NohupIsRespected) {
  StartedProcess process({"synth", path("work/out"), "--size", "1280x960", "--views", "200", "--test-views", "20"},
                         root_ / "scratch", SIGHUP);
  ASSERT_TRUE(wait_until([&] { return process.catches(SIGTERM); }, kPatienceWithAStop));
  EXPECT_TRUE(process.ignores(SIGHUP));
  process.send(SIGTERM);
  EXPECT_EQ(process.wait(kPatienceWithAStop), kStatusOfAStop);
}

}  // namespace
}  // namespace aligngs
