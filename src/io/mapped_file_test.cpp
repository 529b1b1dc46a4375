#include "io/mapped_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>

#include "core/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr size_t kPages = size_t(1) << 20;  // bytes; some hundred pages

fs::path file_of(const std::string& name, const std::string& bytes) {
  const fs::path path = fs::path(testing::TempDir()) / "mapped_file_test" / name;
  fs::create_directories(path.parent_path());
  write_file_atomically(path, bytes);
  return path;
}

std::string part(const MappedFile& file, uint64_t offset, size_t count) {
  std::string out(count, '?');
  file.copy(offset, count, out.data());
  return out;
}

std::string numbered(size_t count) {
  std::string bytes(count, '\0');
  for (size_t i = 0; i < count; ++i) bytes[i] = char(i * 2654435761u >> 24);
  return bytes;
}

TEST(MappedFile, GivesTheBytesOfTheFile) {
  const std::string bytes = numbered(300'001);
  const MappedFile file(file_of("plain", bytes));
  EXPECT_EQ(file.size(), bytes.size());
  EXPECT_EQ(part(file, 0, bytes.size()), bytes);
  EXPECT_EQ(part(file, 65'535, 65'538), bytes.substr(65'535, 65'538));
  EXPECT_EQ(part(file, bytes.size() - 1, 1), bytes.substr(bytes.size() - 1));
}

TEST(MappedFile, AnEmptyFileHasNoBytes) {
  const MappedFile file(file_of("empty", ""));
  EXPECT_EQ(file.size(), 0u);
  EXPECT_EQ(part(file, 0, 0), "");
}

TEST(MappedFile, AFileThatShrinksIsAnErrorNotASignal) {
  const fs::path path = file_of("shrinking", std::string(kPages, 'a'));
  const MappedFile file(path);
  EXPECT_EQ(part(file, kPages / 2, 3), "aaa");
  fs::resize_file(path, 10);
  for (int again = 0; again < 2; ++again) {
    try {
      part(file, kPages / 2, kPages / 2);
      FAIL() << "read";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      EXPECT_EQ(error.details().path, path);
      EXPECT_THAT(error.details().message, HasSubstr("shorter"));
    }
  }
  EXPECT_EQ(part(file, 0, 10), "aaaaaaaaaa");
}

TEST(MappedFile, AReplacedFileKeepsItsOldBytes) {
  const fs::path path = file_of("replaced", "old bytes");
  const MappedFile file(path);
  write_file_atomically(path, "new");
  EXPECT_EQ(part(file, 0, 9), "old bytes");
}

TEST(MappedFile, RefusesFoldersAndMissingFiles) {
  EXPECT_THROW(MappedFile(fs::path(testing::TempDir())), Error);
  EXPECT_THROW(MappedFile(fs::path(testing::TempDir()) / "no such file"), Error);
}

TEST(MappedFileDeathTest, SignalsOfOthersStillEndTheProgram) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        const MappedFile file(file_of("signal", "bytes"));
        signal(SIGALRM, SIG_DFL);
        alarm(10);  // a handler that never lets go must not hang the test
        raise(SIGBUS);
      },
      [](int status) { return WIFSIGNALED(status) ? WTERMSIG(status) == SIGBUS : WEXITSTATUS(status) != 0; }, "");
}

}  // namespace
}  // namespace aligngs
