#include "priors/child_process.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

fs::path log_of(const std::string& test) {
  const fs::path log = fs::path(testing::TempDir()) / ("child_" + test + ".log");
  fs::remove(log);
  return log;
}

TEST(ChildProcess, LinesOfBothStreamsArriveAndAreKept) {
  std::vector<std::string> lines;
  const fs::path log = log_of("lines");
  const ChildResult result = run_child({"sh", "-c", "echo one; echo two >&2; printf three"}, log,
                                       [&](const std::string& line) { lines.push_back(line); });
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(lines, testing::ElementsAre("one", "two", "three"));
  EXPECT_EQ(read_file(log), "one\ntwo\nthree\n");
}

TEST(ChildProcess, ExitStatusAndSignalAreTold) {
  EXPECT_EQ(run_child({"sh", "-c", "exit 7"}, log_of("status")).status, 7);
  EXPECT_EQ(run_child({"sh", "-c", "kill -9 $$"}, log_of("signal")).status, 128 + 9);
}

TEST(ChildProcess, ArgumentsAreNotShellText) {
  std::string got;
  run_child({"printf", "%s\\n", "a b; $HOME"}, log_of("text"), [&](const std::string& line) { got = line; });
  EXPECT_EQ(got, "a b; $HOME");
}

TEST(ChildProcess, OnlyTheEndOfLongOutputIsReturned) {
  const ChildResult result =
      run_child({"sh", "-c", "i=0; while [ $i -lt 2000 ]; do echo line $i; i=$((i+1)); done"}, log_of("long"));
  EXPECT_LE(result.last_lines.size(), 2000u);
  EXPECT_THAT(result.last_lines, testing::EndsWith("line 1999\n"));
}

TEST(ChildProcess, AProgramThatIsNotThereIsAnError) {
  try {
    run_child({"no-such-program-here"}, log_of("missing"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kFailed);
  }
  EXPECT_TRUE(find_program("no-such-program-here").empty());
  EXPECT_FALSE(find_program("sh").empty());
}

}  // namespace
}  // namespace aligngs
