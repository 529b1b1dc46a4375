// The whole program on a small synthetic room: 300 iterations must clearly improve on the start. A run that was killed
// and resumed must end with the same bytes.
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "io/json_text.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

std::string bytes_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

class Pipeline : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    base_ = fs::path(testing::TempDir()) / "pipeline_test";
    fs::remove_all(base_);
    fs::create_directories(base_);
    testing_support::SmallSceneOptions options;
    options.width = 128;
    options.height = 96;
    options.views = 12;
    options.test_views = 3;
    options.exact = false;
    testing_support::write_small_scene(scene(), options);
  }
  static void TearDownTestSuite() { fs::remove_all(base_); }

  static fs::path scene() { return base_ / "scene"; }
  static std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }

  static nlohmann::json run_and_measure(const std::string& name, int iterations, const std::string& more = "") {
    const ProcessResult result = run_aligngs("run " + quoted(scene()) + " -o " + quoted(base_ / name) +
                                                 " -q --json -n " + std::to_string(iterations) + " " + more,
                                             base_);
    EXPECT_EQ(result.status, 0) << result.err;
    return parse_json(result.out);
  }

  static fs::path base_;
};

fs::path Pipeline::base_;

TEST_F(Pipeline, ThreeHundredIterationsImproveOnTheStart) {
  // A start from random points has learnt nothing: everything that is good about the trained run comes from training.
  const nlohmann::json start = run_and_measure("start", 1, "--set init.start=random --set semantic.lift=false");
  const nlohmann::json trained = run_and_measure("trained", 300);
  EXPECT_GT(trained["nvs"]["psnr"].get<double>(), start["nvs"]["psnr"].get<double>() + 3);
  EXPECT_GT(trained["nvs"]["psnr"].get<double>(), 16);
  EXPECT_GT(trained["semantics"]["miou"].get<double>(), start["semantics"]["miou"].get<double>() + 0.2);
  const nlohmann::json& iou = trained["semantics"]["iou"];  // by class, of those that count in the mean
  EXPECT_EQ(iou.size(), trained["semantics"]["classes"].get<size_t>());
  EXPECT_GT(iou["wall"].get<double>(), 0.5);
  const double start_f = start["geometry"].is_null() || !start["geometry"]["fscore"].is_number()
                             ? 0
                             : start["geometry"]["fscore"].get<double>();
  EXPECT_GT(trained["geometry"]["fscore"].get<double>(), start_f + 0.3);
  EXPECT_LT(trained["geometry"]["accuracy"].get<double>(), 0.12);  // metres
  for (const char* file : {"scene.ply", "scene.labels.ply", "mesh/mesh.ply", "report.html", "overview.jpg",
                           "metrics.json", "cameras.json", "classes.json"}) {
    EXPECT_TRUE(fs::exists(base_ / "trained" / file)) << file;
  }
}

TEST_F(Pipeline, AKilledRunEndsWithTheSameBytes) {
  const std::string settings = " -q -n 60 --seed 5 ";
  ASSERT_EQ(run_aligngs("train " + quoted(scene()) + " -o " + quoted(base_ / "whole") + settings +
                            "--threads 1 --set checkpoint.every=60",
                        base_)
                .status,
            0);
  // Killed with signal 9 at a few arbitrary moments, with other checkpoint intervals and thread counts.
  const fs::path run = base_ / "killed";
  std::string resume;
  for (const char* seconds : {"1.3", "2.1", "1.7"}) {
    // In the foreground: else timeout(1) kills itself with its group and returns while the training still holds its
    // run.
    const std::string command = "timeout --foreground -s KILL " + std::string(seconds) +
                                " '" ALIGNGS_PROGRAM "' train " + quoted(scene()) + " -o " + quoted(run) + settings +
                                "--set checkpoint.every=7 " + resume + " >/dev/null 2>&1";
    [[maybe_unused]] const int status = std::system(command.c_str());
    resume = "--resume";
  }
  const ProcessResult end = run_aligngs(
      "train " + quoted(scene()) + " -o " + quoted(run) + settings + "--set checkpoint.every=7 --resume", base_);
  ASSERT_EQ(end.status, 0) << end.err;
  EXPECT_TRUE(bytes_of(run / "scene.ply") == bytes_of(base_ / "whole" / "scene.ply"));

  // On a finished run --resume changes nothing.
  const auto before = fs::last_write_time(run / "scene.ply");
  EXPECT_EQ(run_aligngs("train -o " + quoted(run) + " --resume -q", base_).status, 0);
  EXPECT_EQ(fs::last_write_time(run / "scene.ply"), before);
}

TEST_F(Pipeline, CtrlCLeavesAResumableRun) {
  const fs::path run = base_ / "stopped";
  const std::string program = ALIGNGS_PROGRAM, scene_folder = scene().string(), errors = (base_ / "stop.txt").string();
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (!freopen(errors.c_str(), "w", stderr)) _exit(127);
    execl(program.c_str(), "aligngs", "train", scene_folder.c_str(), "-o", run.c_str(), "-q", "-n", "100000", nullptr);
    _exit(127);
  }
  // The first event says that steps are being made; a slow machine takes its time until then.
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(3);
  while (bytes_of(run / "events.ndjson").empty() && std::chrono::steady_clock::now() < give_up) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  kill(child, SIGINT);
  kill(child, SIGINT);  // timeout(1) and shells tell the process and its group: an echo is no second wish
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 75);  // stopped, with a checkpoint
  EXPECT_THAT(bytes_of(base_ / "stop.txt"), HasSubstr("--resume"));
  EXPECT_FALSE(fs::is_empty(run / "checkpoints"));
  EXPECT_THAT(bytes_of(run / "run.json"), HasSubstr("stopped"));
}

TEST_F(Pipeline, AnExistingRunIsReplacedWithOverwriteAlone) {
  const fs::path run = base_ / "again";
  ASSERT_EQ(run_aligngs("train " + quoted(scene()) + " -o " + quoted(run) + " -q -n 3", base_).status, 0);
  EXPECT_EQ(run_aligngs("train " + quoted(scene()) + " -o " + quoted(run) + " -q -n 3", base_).status, 2);
  EXPECT_EQ(run_aligngs("train " + quoted(scene()) + " -o " + quoted(run) + " -q -n 3 --overwrite", base_).status, 0);
}

TEST_F(Pipeline, FailUnderIsStatusSix) {
  const ProcessResult result = run_aligngs("run " + quoted(scene()) + " -o " + quoted(base_ / "under") +
                                               " -q -n 5 --set mesh.voxel=0.05 --fail-under psnr=99",
                                           base_);
  EXPECT_EQ(result.status, 6) << result.err;
}

}  // namespace
}  // namespace aligngs
