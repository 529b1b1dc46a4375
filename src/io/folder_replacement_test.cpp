#include "io/folder_replacement.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

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

}  // namespace
}  // namespace aligngs
