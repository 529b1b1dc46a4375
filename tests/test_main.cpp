// Starts the tests of one program with this process's own folder of temporary files (testing::TempDir()). Programs and
// single tests may hence run in parallel. It is removed at the end, unless a test failed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  std::string folder = testing::TempDir() + "aligngs_tests_XXXXXX";
  if (mkdtemp(folder.data()) == nullptr || setenv("TEST_TMPDIR", (folder + "/").c_str(), 1) != 0) {
    std::perror(folder.c_str());
    return 1;
  }
  const int status = RUN_ALL_TESTS();
  std::error_code ignored;
  if (status == 0) {
    std::filesystem::remove_all(folder, ignored);
  } else {
    std::fprintf(stderr, "files of the tests: %s\n", folder.c_str());
  }
  return status;
}
