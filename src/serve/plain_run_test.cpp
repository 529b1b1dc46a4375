#include "serve/plain_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "core/error.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class PlainRun : public testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::path(testing::TempDir()) /
            ("aligngs_plain_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    run_ = base_ / "run";
    fs::remove_all(base_);
    fs::create_directories(run_ / "checkpoints");
    fs::create_directories(base_ / "elsewhere");
    std::ofstream(run_ / "checkpoints" / "step_1.safetensors") << "x";
  }
  void TearDown() override { fs::remove_all(base_); }
  std::string fault() const {
    try {
      require_plain_run(run_);
      return "";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      return error.what();
    }
  }

  fs::path base_, run_;
};

TEST_F(PlainRun, FilesAndLinksWithinTheRunAreFine) {
  fs::create_symlink("step_1.safetensors", run_ / "checkpoints" / "last.safetensors");
  EXPECT_EQ(fault(), "");
}

TEST_F(PlainRun, AFolderElsewhereIsNotWrittenTo) {
  fs::create_directory_symlink(base_ / "elsewhere", run_ / "edits");
  EXPECT_THAT(fault(), HasSubstr("link out of the run folder"));
}

TEST_F(PlainRun, AFileElsewhereIsNotRead) {
  std::ofstream(base_ / "elsewhere" / "step_2.safetensors") << "x";
  fs::create_symlink(base_ / "elsewhere" / "step_2.safetensors", run_ / "checkpoints" / "step_2.safetensors");
  EXPECT_THAT(fault(), HasSubstr("step_2.safetensors"));
}

TEST_F(PlainRun, AFifoIsNotRead) {
  ASSERT_EQ(mkfifo((run_ / "checkpoints" / "step_9.safetensors").c_str(), 0600), 0);
  EXPECT_THAT(fault(), HasSubstr("no regular file"));
}

}  // namespace
}  // namespace aligngs
