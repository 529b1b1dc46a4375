#include "core/standard_streams.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace aligngs {
namespace {

/// 0 where a file that is opened after the call has the number of no standard stream.
[[noreturn]] void open_a_file_without(std::initializer_list<int> streams) {
  for (const int stream : streams) close(stream);
  reserve_standard_streams();
  const int file = open("/proc/self/status", O_RDONLY);
  const char text[] = "x";
  for (const int stream : streams) {
    if (stream != STDIN_FILENO && write(stream, text, 1) >= 0) _exit(2);  // it is no place for messages
  }
  _exit(file > STDERR_FILENO ? 0 : 1);
}

TEST(StandardStreams, FilesNeverTakeTheNumberOfAClosedStream) {
  EXPECT_EXIT(open_a_file_without({STDERR_FILENO}), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(open_a_file_without({STDIN_FILENO, STDERR_FILENO}), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(open_a_file_without({STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}), testing::ExitedWithCode(0), "");
}

TEST(StandardStreams, OpenStreamsStayAsTheyAre) {
  const int before = dup(STDERR_FILENO);
  reserve_standard_streams();
  const int after = dup(STDERR_FILENO);
  EXPECT_EQ(after, before + 1) << "nothing was opened";
  close(before), close(after);
}

}  // namespace
}  // namespace aligngs
