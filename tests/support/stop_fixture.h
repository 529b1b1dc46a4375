// A folder for the outputs of commands that signals stop.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace aligngs::testing_support {

constexpr int kStatusOfAStop = 75;         // docs/formats.md: the program heard the signal
constexpr double kPatienceWithAStop = 60;  // seconds: three on a machine that does nothing else

class StopFixture : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    root_ = std::filesystem::path(testing::TempDir()) / test.test_suite_name() / test.name();
    std::filesystem::remove_all(root_);
    std::filesystem::create_directories(root_ / "work");
  }
  std::string path(const std::string& name) const { return (root_ / name).string(); }

  std::filesystem::path root_;
};

}  // namespace aligngs::testing_support
