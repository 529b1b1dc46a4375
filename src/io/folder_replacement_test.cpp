#include "io/folder_replacement.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "core/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// An empty folder of its own for each test.
fs::path fresh_folder(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / ("folder_replacement_" + name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

size_t entries(const fs::path& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(FolderReplacement, AppearsOnCommit) {
  const fs::path folder = fresh_folder("commit");
  FolderReplacement replacement(folder / "out/");  // a trailing slash names the same folder
  write_file_atomically(replacement.path() / "file", "new");
  EXPECT_FALSE(fs::exists(folder / "out"));
  replacement.commit();
  EXPECT_EQ(read_file(folder / "out" / "file"), "new");
  EXPECT_EQ(entries(folder), 1u);
}

TEST(FolderReplacement, TakesThePlaceOfWhatStoodThere) {
  const fs::path folder = fresh_folder("replace");
  fs::create_directories(folder / "out");
  write_file_atomically(folder / "out" / "old", "old");
  FolderReplacement replacement(folder / "out");
  write_file_atomically(replacement.path() / "file", "new");
  replacement.commit();
  EXPECT_FALSE(fs::exists(folder / "out" / "old"));
  EXPECT_EQ(read_file(folder / "out" / "file"), "new");
  EXPECT_EQ(entries(folder), 1u);
}

TEST(FolderReplacement, WithoutCommitNothingIsChangedOrLeft) {
  const fs::path folder = fresh_folder("abandon");
  fs::create_directories(folder / "out");
  write_file_atomically(folder / "out" / "old", "old");
  {
    FolderReplacement replacement(folder / "out");
    write_file_atomically(replacement.path() / "file", "half");
  }
  EXPECT_EQ(read_file(folder / "out" / "old"), "old");
  EXPECT_EQ(entries(folder), 1u);
}

/// Protection binds nobody who is root: a child process gives that up.
TEST(FolderReplacement, AProtectedFolderIsRefusedBeforeAnything) {
  const fs::path folder = fs::temp_directory_path() / ("aligngs_protected_" + std::to_string(::getpid()));
  write_file_atomically(folder / "out" / "images" / "old", "old");
  constexpr uid_t kNobody = 65534;
  for (const fs::path& place : {folder, folder / "out", folder / "out" / "images"}) {
    fs::permissions(place, fs::perms::all);
    if (::geteuid() == 0) {
      ASSERT_EQ(::chown(place.c_str(), kNobody, kNobody), 0);
    }
  }
  fs::permissions(folder / "out" / "images", fs::perms(0555));
  const pid_t child = ::fork();
  if (child == 0) {
    if (::geteuid() == 0 && (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0)) ::_exit(3);
    try {
      const FolderReplacement replacement(folder / "out");
      ::_exit(1);
    } catch (const Error& error) {
      ::_exit(error.kind() == ErrorKind::kResources && error.details().path.filename() == "images" ? 0 : 2);
    }
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(entries(folder), 1u);
  fs::permissions(folder / "out" / "images", fs::perms::all);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace aligngs
