#include "core/stop_signal.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>

namespace aligngs {
namespace {

/// Ends with status 0 when a write beyond the limit of file sizes is an error.
[[noreturn]] void write_beyond_the_limit() {
  install_stop_handlers();
  const rlimit limit{10, 10};
  setrlimit(RLIMIT_FSIZE, &limit);
  FILE* file = std::tmpfile();
  std::fputs("longer than ten bytes", file);
  std::_Exit(std::fflush(file) != 0 && errno == EFBIG ? 0 : 1);
}

TEST(StopSignalDeathTest, ALimitOfFileSizesEndsNoProcess) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(write_beyond_the_limit(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace aligngs
