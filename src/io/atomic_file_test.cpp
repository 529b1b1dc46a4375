#include "io/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "core/error.h"

namespace aligngs {
namespace {

std::filesystem::path folder_of_files(const std::string& name) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "atomic_file_test" / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

size_t files_in(const std::filesystem::path& folder) {
  size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) count += entry.is_regular_file();
  return count;
}

/// While alive, a file of this process cannot grow beyond `bytes`: write() fails with EFBIG, much
/// like a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit before_{};
  void (*old_handler_)(int);
};

TEST(AtomicFile, WritesAndCreatesTheFolder) {
  const auto path = folder_of_files("write") / "a" / "b" / "file.txt";
  AtomicFile file(path);
  file.write("hello ");
  file.write(std::string(3 << 20, 'x'));
  file.commit();
  EXPECT_EQ(read_file(path), "hello " + std::string(3 << 20, 'x'));
  EXPECT_EQ(files_in(path.parent_path()), 1u);
}

TEST(AtomicFile, APipeIsNotReplaced) {
  const auto pipe = folder_of_files("pipe") / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  try {
    write_file_atomically(pipe, "x");
    ADD_FAILURE() << "written";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  }
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST(AtomicFile, LeavesTheOldFileWithoutCommit) {
  const auto folder = folder_of_files("no_commit");
  write_file_atomically(folder / "file.txt", "old");
  {
    AtomicFile file(folder / "file.txt");
    file.write("new");
    EXPECT_EQ(read_file(folder / "file.txt"), "old");
  }
  EXPECT_EQ(read_file(folder / "file.txt"), "old");
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(AtomicFile, FullDiskIsAResourceErrorAndKeepsTheOldFile) {
  const auto folder = folder_of_files("full");
  write_file_atomically(folder / "file.txt", "old");
  {
    const FileSizeLimit limit(1000);
    try {
      write_file_atomically(folder / "file.txt", std::string(5000, 'x'));
      FAIL() << "written";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kResources);
      EXPECT_EQ(error.details().path, folder / "file.txt");
      EXPECT_FALSE(error.details().remedy.empty());
    }
  }
  EXPECT_EQ(read_file(folder / "file.txt"), "old");
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(AtomicFile, AParentThatIsAFileIsAResourceError) {
  const auto folder = folder_of_files("parent");
  write_file_atomically(folder / "file", "x");
  try {
    AtomicFile file(folder / "file" / "below.txt");
    FAIL() << "opened";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kResources);
    EXPECT_EQ(error.details().path, folder / "file" / "below.txt");
  }
}

TEST(AtomicFile, CannotReplaceAFolder) {
  const auto folder = folder_of_files("replace");
  std::filesystem::create_directories(folder / "taken");
  EXPECT_THROW(write_file_atomically(folder / "taken", "x"), Error);
  EXPECT_EQ(files_in(folder), 0u);
}

TEST(ReadFile, RefusesAbsentFilesFoldersAndLargeFiles) {
  const auto folder = folder_of_files("read");
  write_file_atomically(folder / "file", "12345");
  EXPECT_EQ(read_file(folder / "file", 5), "12345");
  for (const auto& path : {folder / "absent", folder}) {
    try {
      read_file(path);
      FAIL() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      EXPECT_EQ(error.details().path, path);
    }
  }
  EXPECT_THROW(read_file(folder / "file", 4), Error);
}

TEST(ReadFile, ReadsFilesThatDoNotTellTheirSize) { EXPECT_FALSE(read_file("/proc/self/stat").empty()); }

}  // namespace
}  // namespace aligngs
