// Many rooms through the program itself: done, broken, stopped, killed, collected, tried again.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "batch/batch_folder.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "support/process.h"
#include "support/small_scene.h"
#include "support/started_process.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;
using testing_support::StartedProcess;
using testing_support::wait_until;

constexpr double kPatienceOfWorkers = 120;  // seconds: a tenth on a machine that does nothing else
constexpr const char* kOptions = "--no-refine --set checkpoint.every=20";

class BatchCommand : public testing::Test {
 protected:
  /// One scene for all rooms. Without the truth nothing is compared with it, which takes longer than all the rest.
  static void SetUpTestSuite() {
    scene_ = fs::path(testing::TempDir()) / "batch_command" / "scene";
    testing_support::write_small_scene(scene_, {48, 36, 6, 2, true, false});
  }
  void SetUp() override {
    root_ =
        fs::path(testing::TempDir()) / "batch_command" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  std::string path(const std::string& name) const { return (root_ / name).string(); }
  ProcessResult run(const std::string& arguments) const { return run_aligngs(arguments, root_ / "scratch"); }
  std::string ply(const std::string& batch, const std::string& room) const {
    return read_file(BatchFolder(root_ / batch).run(room) / "scene.ply");
  }

  /// A line of a list.
  static std::string room(const std::string& name, const std::string& source, const std::string& options) {
    return name + "\t" + source + "\t" + options + " " + kOptions + "\n";
  }

  static inline fs::path scene_;
  fs::path root_;
};

TEST_F(BatchCommand, ABrokenRoomDoesNotKeepTheOthersFromTheEnd) {
  write_file_atomically(root_ / "rooms.tsv", room("one", scene_, "-n 10") + room("broken", "nowhere", "-n 10") +
                                                 room("two", scene_, "-n 10 --seed 2"));
  const ProcessResult first = run("batch '" + path("rooms.tsv") + "' -o '" + path("out") + "' --jobs 2");
  EXPECT_EQ(first.status, 1);
  EXPECT_THAT(first.err, HasSubstr("1 of 3 rooms failed: broken"));
  EXPECT_THAT(first.err, HasSubstr("aligngs batch retry " + path("out") + " broken"));

  const nlohmann::json status = parse_json(run("batch status '" + path("out") + "' --json").out);
  ASSERT_EQ(status["rooms"].size(), 3u);
  EXPECT_EQ(status["rooms"][0]["state"], "done");
  EXPECT_EQ(status["rooms"][1]["state"], "failed");
  EXPECT_EQ(status["rooms"][1]["exit_status"], 3);
  EXPECT_THAT(std::string(status["rooms"][1]["message"]), HasSubstr("no such folder"));

  EXPECT_EQ(run("batch collect '" + path("out") + "'").status, 0);
  for (const char* file : {"results.csv", "results.json", "results.html"})
    EXPECT_TRUE(fs::exists(root_ / "out" / file)) << file;
  EXPECT_THAT(read_file(root_ / "out" / "results.html"), HasSubstr("data:image/jpeg"));

  fs::copy(scene_, root_ / "nowhere", fs::copy_options::recursive);  // what was missing
  const ProcessResult again = run("batch '" + path("rooms.tsv") + "' -o '" + path("out") + "' --json");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(parse_json(again.out)["done"].size(), 3u);
}

/// Stopped with a checkpoint, then killed, then finished: the same bytes as without all that.
TEST_F(BatchCommand, AStoppedAndAKilledWorkerLeaveRoomsThatEndTheSame) {
  write_file_atomically(root_ / "rooms.tsv", room("one", scene_, "-n 150"));
  const std::string list = path("rooms.tsv");
  ASSERT_EQ(run("batch '" + list + "' -o '" + path("plain") + "'").status, 0);

  const std::vector<std::string> command = {"batch", list, "-o", path("out")};
  const fs::path checkpoints = root_ / "out" / "rooms" / "one" / "checkpoints";
  const auto training = [&] { return fs::exists(checkpoints) && !fs::is_empty(checkpoints); };
  {
    StartedProcess worker(command, root_ / "first");
    ASSERT_TRUE(wait_until(training, kPatienceOfWorkers)) << worker.err();
    worker.send(SIGUSR1);
    EXPECT_EQ(worker.wait(kPatienceOfWorkers), 75) << worker.err();
  }
  EXPECT_THAT(run("batch status '" + path("out") + "'").out, HasSubstr("stopped"));
  {
    StartedProcess worker(command, root_ / "second");
    ASSERT_TRUE(wait_until([&] { return !fs::is_empty(root_ / "out" / "leases"); }, kPatienceOfWorkers))
        << worker.err();
    worker.send(SIGKILL);
    EXPECT_EQ(worker.wait(kPatienceOfWorkers), 128 + SIGKILL);
  }
  const ProcessResult last = run("batch '" + list + "' -o '" + path("out") + "'");
  EXPECT_EQ(last.status, 0) << last.err;
  EXPECT_EQ(ply("out", "one"), ply("plain", "one"));
  EXPECT_TRUE(fs::is_empty(root_ / "out" / "leases"));
}

TEST_F(BatchCommand, MistakesOfTheCommandLine) {
  write_file_atomically(root_ / "rooms.tsv", "one\tdemo\n");
  const std::string list = "'" + path("rooms.tsv") + "'";
  EXPECT_EQ(run("batch").status, 2);
  EXPECT_EQ(run("batch " + list).status, 2);
  EXPECT_EQ(run("batch " + list + " -o x --shard 3/2").status, 2);
  EXPECT_EQ(run("batch status '" + path("nothing") + "'").status, 2);
  EXPECT_EQ(run("batch '" + path("absent.tsv") + "' -o x").status, 3);
  EXPECT_FALSE(fs::exists("x"));
}

TEST_F(BatchCommand, PrintingWritesAScriptAndNothingElse) {
  write_file_atomically(root_ / "rooms.tsv", "one\tdemo\ntwo\tdemo\n");
  const ProcessResult printed =
      run("batch '" + path("rooms.tsv") + "' -o '" + path("out") + "' --print slurm --jobs 1");
  EXPECT_EQ(printed.status, 0);
  EXPECT_THAT(printed.out, HasSubstr("#SBATCH --array=0-1%1\n"));
  EXPECT_FALSE(fs::exists(root_ / "out"));
}

}  // namespace
}  // namespace aligngs
