#include "io/abandoned_paths.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>
#include <vector>

#include "core/log.h"
#include "core/temporary_paths.h"
#include "io/atomic_file.h"
#include "io/folder_replacement.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// The id of a process that has ended.
std::string dead_process() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return std::to_string(child);
}

class AbandonedPaths : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) / "abandoned_paths" /
             testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder);
    fs::create_directories(folder);
    set_log_level(LogLevel::kSilent);
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  fs::path with_file(const std::string& name) const {
    std::ofstream(folder / name) << "half";
    return folder / name;
  }
  fs::path with_folder(const std::string& name) const {
    fs::create_directories(folder / name / "images");
    std::ofstream(folder / name / "images" / "a.png") << name;
    return folder / name;
  }

  fs::path folder;
  const std::string dead = dead_process();
};

TEST_F(AbandonedPaths, AFileOfADeadProcessIsRemovedByTheNextWriter) {
  const fs::path left = with_file("scene.ply.tmp-" + dead + "-3");
  write_file_atomically(folder / "scene.ply", "whole");
  EXPECT_FALSE(fs::exists(left));
  EXPECT_EQ(read_file(folder / "scene.ply"), "whole");
}

TEST_F(AbandonedPaths, AFolderOfADeadProcessIsRemovedByTheNextWriter) {
  const fs::path left = with_folder("scene.tmp-" + dead);
  const fs::path cut_short = with_folder("scene.tmp-" + dead + ".removed");
  { FolderReplacement next(folder / "scene"); }
  EXPECT_FALSE(fs::exists(left));
  EXPECT_FALSE(fs::exists(cut_short));
}

TEST_F(AbandonedPaths, FilesOfALivingProcessStay) {
  const fs::path file = with_file("scene.ply.tmp-" + std::to_string(getppid()) + "-0");
  const fs::path replaced = with_folder("scene.tmp-" + std::to_string(getppid()));
  remove_abandoned(folder / "scene.ply");
  remove_abandoned(folder / "scene");
  EXPECT_TRUE(fs::exists(file));
  EXPECT_TRUE(fs::exists(replaced));
}

/// Another container: the process has an id that is not seen here.
TEST_F(AbandonedPaths, WhatSomebodyHasLockedStays) {
  const fs::path left = with_folder("scene.tmp-" + dead);
  {
    const TemporaryFolderLock lock(left);
    remove_abandoned(folder / "scene");
    EXPECT_TRUE(fs::exists(left));
  }
  remove_abandoned(folder / "scene");
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(AbandonedPaths, AWriterHoldsTheLockOfItsFile) {
  AtomicFile file(folder / "scene.ply");
  const std::string own = ".tmp-" + std::to_string(getpid());
  std::string name;
  for (const auto& entry : fs::directory_iterator(folder)) name = entry.path().filename().string();
  ASSERT_NE(name.find(own), std::string::npos);
  fs::rename(folder / name, folder / ("scene.ply.tmp-" + dead + "-0"));
  remove_abandoned(folder / "scene.ply");
  EXPECT_TRUE(fs::exists(folder / ("scene.ply.tmp-" + dead + "-0")));
}

TEST_F(AbandonedPaths, AnOwnIdOfAFormerProcessIsNoReasonToKeep) {
  const std::string own = ".tmp-" + std::to_string(getpid());
  const fs::path former = with_file("scene.ply" + own + "-4000000000"), noted = with_file("scene.ply" + own + "-7");
  note_temporary_path(noted);
  remove_abandoned(folder / "scene.ply");
  forget_temporary_path(noted);
  EXPECT_FALSE(fs::exists(former));
  EXPECT_TRUE(fs::exists(noted));
}

TEST_F(AbandonedPaths, OtherNamesStay) {
  for (const std::string& name :
       std::vector<std::string>{"scene.ply.tmp-" + dead + "-1.bak", "scene.ply.tmp-0" + dead, "a.tmp-x",
                                "other.ply.tmp-" + dead + "-1", "scene.ply.tmp-" + dead + "-", "scene.ply.tmp--1",
                                "scene.ply.tmp-" + dead + "-1.old", "scene.ply.work-" + dead + "-1"}) {
    const fs::path file = with_file(name);
    remove_abandoned(folder / "scene.ply");
    EXPECT_TRUE(fs::exists(file)) << name;
  }
}

TEST_F(AbandonedPaths, ALinkIsNotFollowed) {
  const fs::path precious = with_folder("precious");
  fs::create_directory_symlink(precious, folder / ("scene.tmp-" + dead));
  remove_abandoned(folder / "scene");
  EXPECT_TRUE(fs::exists(precious / "images" / "a.png"));
}

TEST_F(AbandonedPaths, AFolderThatLostItsPlaceIsPutBack) {
  const std::string old = "scene.tmp-" + dead + ".old";
  with_folder(old);
  remove_abandoned(folder / "scene");
  EXPECT_EQ(read_file(folder / "scene" / "images" / "a.png"), old);
}

TEST_F(AbandonedPaths, AFolderWhoseSuccessorIsThereIsRemoved) {
  const fs::path old = with_folder("scene.tmp-" + dead + ".old");
  with_folder("scene");
  remove_abandoned(folder / "scene");
  EXPECT_FALSE(fs::exists(old));
  EXPECT_EQ(read_file(folder / "scene" / "images" / "a.png"), "scene");
}

TEST_F(AbandonedPaths, CutNamesAreRecognised) {
  const std::string long_name(255, 'n');
  const fs::path left = with_file(std::string(255 - dead.size() - 7, 'n') + ".tmp-" + dead + "-0");
  write_file_atomically(folder / long_name, "whole");
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(AbandonedPaths, AWholeFolderIsCleared) {
  const fs::path file = with_file("a.tmp-" + dead + "-1"), work = with_folder("b.work-" + dead);
  const fs::path mine = with_file("notes.tmp-monday");
  remove_abandoned_in(folder);
  EXPECT_FALSE(fs::exists(file));
  EXPECT_FALSE(fs::exists(work));
  EXPECT_TRUE(fs::exists(mine));
}

}  // namespace
}  // namespace aligngs
