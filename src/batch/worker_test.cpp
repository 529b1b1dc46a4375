#include "batch/worker.h"

#include <gmock/gmock.h>

#include <thread>

#include "batch/batch_status.h"
#include "batch/testing/fake_program.h"
#include "core/error.h"
#include "core/stop_signal.h"

namespace aligngs {
namespace {

using test_batch::FakeBatch;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;
namespace fs = std::filesystem;

class WorkerTest : public FakeBatch {};

TEST_F(WorkerTest, FinishedRoomsAreNotStartedAgain) {
  add("good1");
  add("good2");
  EXPECT_THAT(work().done, ElementsAre("good1", "good2"));
  EXPECT_THAT(work().done, ElementsAre("good1", "good2"));
  EXPECT_EQ(starts().size(), 2u);
}

TEST_F(WorkerTest, AFailedRoomIsRecordedAndLeftAloneUntilItsInputsChange) {
  add("broken");
  add("good");
  const WorkerSummary first = work();
  EXPECT_THAT(first.failed, ElementsAre("broken"));
  EXPECT_THAT(first.done, ElementsAre("good"));
  const auto record = read_room_record(folder().record("broken"));
  ASSERT_TRUE(record);
  EXPECT_EQ(record->exit_status, 3);
  EXPECT_EQ(record->message, "no photos are here");
  EXPECT_EQ(record->remedy, "take some");
  EXPECT_THAT(work().failed, ElementsAre("broken"));
  EXPECT_EQ(starts().size(), 2u);
  write_file_atomically(base_ / "broken" / "photo.jpg", "another");
  work();
  EXPECT_EQ(starts().size(), 3u);
}

TEST_F(WorkerTest, AForgottenFailureIsTriedAgain) {
  add("broken");
  work();
  EXPECT_TRUE(forget_failure(folder(), "broken", false, options_.times));
  work();
  EXPECT_EQ(starts().size(), 2u);
}

TEST_F(WorkerTest, ARoomThatASignalEndedFails) {
  add("killed");
  EXPECT_THAT(work().failed, ElementsAre("killed"));
  EXPECT_EQ(read_room_record(folder().record("killed"))->exit_status, 128 + 9);
}

TEST_F(WorkerTest, RoomsRunTogetherOnlyWhereTheirMemoryFits) {
  options_.jobs = 2;
  for (const char* room : {"meets1", "meets2"}) {
    add(room);
    batch_.rooms.back().options = {"--memory", "0.6"};  // GB
  }
  options_.memory_bytes = 1'000'000'000;
  EXPECT_EQ(work().done.size(), 2u);
  EXPECT_FALSE(fs::exists(base_ / "met.txt"));

  for (RoomEntry& room : batch_.rooms) room.options.push_back("--strict");  // other inputs: both begin anew
  options_.memory_bytes = 2'000'000'000;
  EXPECT_EQ(work().done.size(), 2u);
  EXPECT_TRUE(fs::exists(base_ / "met.txt"));
}

/// In its first milliseconds a process does not answer signals yet.
TEST_F(WorkerTest, ARoomThatWasAskedToStopBeforeItListenedDidNotFail) {
  add("early");
  EXPECT_THAT(work().stopped, ElementsAre("early"));
  EXPECT_EQ(read_room_record(folder().record("early"))->state, AttemptState::kStopped);
}

TEST_F(WorkerTest, AFinishedRoomWithOtherInputsBeginsAnew) {
  add("good");
  work();
  batch_.rooms[0].options = {"--strict"};
  EXPECT_EQ(batch_status(folder(), batch_, options_.times)[0].state, RoomState::kChanged);
  work();
  EXPECT_THAT(starts(), ElementsAre("good --overwrite", "good --overwrite"));
}

TEST_F(WorkerTest, AStopRequestLetsRoomsWriteTheirCheckpointsAndTheyGoOn) {
  add("slow");
  add("good");
  options_.jobs = 1;
  std::thread stopper([this] {
    for (int i = 0; i < 500 && !fs::exists(folder().run("slow") / "run.json"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    request_stop();
  });
  const WorkerSummary summary = work();
  stopper.join();
  clear_stop_request();
  EXPECT_TRUE(summary.interrupted);
  EXPECT_THAT(summary.stopped, UnorderedElementsAre("slow", "good"));
  EXPECT_EQ(batch_status(folder(), batch_, options_.times)[0].state, RoomState::kStopped);
  EXPECT_THAT(work().done, ElementsAre("slow", "good"));
  EXPECT_THAT(starts(), ElementsAre("slow --overwrite", "slow --resume", "good --overwrite"));
}

TEST_F(WorkerTest, ManyWorkersStartEveryRoomOnce) {
  for (int i = 0; i < 12; ++i) add("good" + std::to_string(i));
  folder().prepare(batch_);
  std::vector<std::thread> workers;
  for (int i = 0; i < 4; ++i)
    workers.emplace_back([this] { work_on(BatchFolder(base_ / "out"), batch_, batch_.rooms, options_); });
  for (std::thread& worker : workers) worker.join();
  std::vector<std::string> names = starts();
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names.size(), 12u);
  EXPECT_EQ(std::unique(names.begin(), names.end()), names.end());
  EXPECT_TRUE(fs::is_empty(folder().leases()));
}

TEST_F(WorkerTest, ARoomOfALivingWorkerIsLeftToIt) {
  add("good");
  folder().prepare(batch_);
  const auto lease = Lease::take(folder().leases(), "good", options_.times);
  ASSERT_TRUE(lease);
  EXPECT_THAT(work().elsewhere, ElementsAre("good"));
  EXPECT_TRUE(starts().empty());
}

TEST_F(WorkerTest, ARoomOfADeadWorkerIsTakenOver) {
  add("good");
  folder().prepare(batch_);
  options_.times.stale_seconds = 0.3;
  write_file_atomically(folder().leases() / "good.1",
                        R"({"host": "far", "pid": 1, "process_space": "another", "beginning": "5"})");
  EXPECT_THAT(work().done, ElementsAre("good"));
  EXPECT_TRUE(fs::is_empty(folder().leases()));
}

TEST_F(WorkerTest, ARoomThatDiedAfterItWasDoneCountsAsDone) {
  add("good");
  work();
  RoomRecord record = *read_room_record(folder().record("good"));
  record.state = AttemptState::kRunning;
  write_room_record(folder().record("good"), record);
  EXPECT_THAT(work().done, ElementsAre("good"));
  EXPECT_EQ(starts().size(), 1u);
}

TEST_F(WorkerTest, AFolderWithOtherFilesIsRefused) {
  add("good");
  write_file_atomically(base_ / "out" / "notes.txt", "mine");
  EXPECT_THROW(work(), Error);
}

TEST_F(WorkerTest, AListOfSomebodyIsNeverReplaced) {
  const fs::path list = base_ / "mine" / "list.json";
  write_file_atomically(list, R"({"mine": 1})");
  EXPECT_THROW(BatchFolder(list.parent_path()).prepare(Batch{}), Error);
  EXPECT_EQ(read_file(list), R"({"mine": 1})");
}

/// Without a list, what lies in folders of these names is of somebody else.
TEST_F(WorkerTest, RecordsOfSomebodyAreNeverReplaced) {
  const fs::path record = base_ / "mine" / "records" / "one.json";
  fs::create_directories(record.parent_path());
  BatchFolder(base_ / "mine").prepare(Batch{});  // empty folders are free
  fs::remove(base_ / "mine" / "list.json");
  write_file_atomically(record, "mine");
  EXPECT_THROW(BatchFolder(base_ / "mine").prepare(Batch{}), Error);
  EXPECT_EQ(read_file(record), "mine");
}

TEST_F(WorkerTest, TheListComesBackFromTheFolder) {
  add("good");
  batch_.rooms[0].options = {"--set", "a=1 2"};
  folder().prepare(batch_);
  const Batch back = folder().read();
  EXPECT_EQ(back.list, batch_.list);
  ASSERT_EQ(back.rooms.size(), 1u);
  EXPECT_EQ(back.rooms[0].options, batch_.rooms[0].options);
  EXPECT_THROW(back.room("goood"), Error);
}

}  // namespace
}  // namespace aligngs
