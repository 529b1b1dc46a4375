#include "edit/edit_lock.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "core/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kShort = 0.2;  // seconds: long enough for several tries

class EditLockTest : public testing::Test {
 protected:
  EditLockTest() : run_(fs::path(testing::TempDir()) / "edit_lock_run") { fs::remove_all(run_); }
  std::string refusal() const {
    try {
      const EditLock lock(run_, "delete bed", kShort);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      return error.what();
    }
    return "";
  }
  fs::path run_;
};

TEST_F(EditLockTest, TheSecondEditIsToldWhoHoldsTheFirst) {
  const EditLock first(run_, "recolor sofa to #add8e6", kShort);
  const std::string text = refusal();
  EXPECT_THAT(text, HasSubstr("process " + std::to_string(getpid()) + " on host"));
  EXPECT_THAT(text, HasSubstr("recolor sofa to #add8e6"));
}

TEST_F(EditLockTest, AWaitingEditGoesOnWhenTheFirstHasEnded) {
  auto first = std::make_unique<EditLock>(run_, "delete bed", kShort);
  std::thread ends([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    first.reset();
  });
  constexpr double kPatient = 20;  // seconds; the lock is free after 0.15
  EXPECT_NO_THROW(EditLock(run_, "delete sofa", kPatient));
  ends.join();
}

TEST_F(EditLockTest, TheLockOfADeadProcessIsTakenOver) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const EditLock lock(run_, "delete bed", kShort);
    [[maybe_unused]] const ssize_t told = write(ready[1], "x", 1);
    pause();
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_THAT(refusal(), HasSubstr("process " + std::to_string(child)));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_THAT(read_file(edit_lock_file(run_)), HasSubstr(std::to_string(child))) << "its record is still there";
  EXPECT_EQ(refusal(), "");
  close(ready[0]);
  close(ready[1]);
}

TEST_F(EditLockTest, ARecordThatCannotBeReadDoesNoHarm) {
  write_file_atomically(edit_lock_file(run_), "\x01 no json");
  EXPECT_EQ(refusal(), "");
}

TEST_F(EditLockTest, AFolderThatCannotBeWrittenIsAnErrorOfTheDisk) {
  write_file_atomically(run_ / "control", "a file where the folder belongs");
  try {
    const EditLock lock(run_, "delete bed", kShort);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kResources);
  }
}

/// An undo frees space, so that it must work where nothing can be written.
TEST_F(EditLockTest, AFullDiskLeavesTheRecordOut) {
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  auto* handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit nothing{0, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &nothing);  // write() fails, much as on a full disk
  EXPECT_NO_THROW(EditLock(run_, "undo", kShort));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
}

}  // namespace
}  // namespace aligngs
