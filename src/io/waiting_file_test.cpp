#include "io/waiting_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/image_file.h"
#include "io/mapped_file.h"
#include "io/npy.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

TEST(WaitingFile, EveryReaderRefusesAPipeInsteadOfWaiting) {
  const fs::path pipe = fs::path(testing::TempDir()) / "waiting_file.png";
  fs::remove(pipe);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  alarm(20);  // a reader that waits fails the test
  EXPECT_THROW(read_file(pipe), Error);
  EXPECT_THROW(read_image_info(pipe), Error);
  EXPECT_THROW(read_npy_header(pipe), Error);
  EXPECT_THROW(MappedFile{pipe}, Error);
  alarm(0);
}

TEST(WaitingFile, PipesOfAShellAndFilesPass) {
  EXPECT_NO_THROW(require_no_waiting("/dev/null"));
  EXPECT_NO_THROW(require_no_waiting("/dev/stdin"));
  EXPECT_NO_THROW(require_no_waiting("/nowhere"));
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(write(ends[1], "words", 5), 5);
  close(ends[1]);
  EXPECT_EQ(read_file("/dev/fd/" + std::to_string(ends[0])), "words");
  close(ends[0]);
}

}  // namespace
}  // namespace aligngs
