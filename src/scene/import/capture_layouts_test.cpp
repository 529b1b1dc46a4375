// The rows of the layouts, and what is made from them.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>

#include "core/error.h"
#include "io/atomic_file.h"
#include "scene/import/capture.h"

namespace aligngs {
namespace {

TEST(CaptureLayouts, NamesAreUnique) {
  std::set<std::string> names = {"auto"};
  for (const CaptureLayout& layout : capture_layouts()) EXPECT_TRUE(names.insert(layout.name).second) << layout.name;
}

TEST(CaptureLayouts, TheManualHasTheRowsInTheirOrder) {
  const std::string manual = read_file(std::string(ALIGNGS_SOURCE_DIR) + "/docs/formats.md");
  std::string table = "| `--layout` | layout | recognised by |\n|---|---|---|\n";
  for (const CaptureLayout& layout : capture_layouts())
    table += std::string("| `") + layout.name + "` | " + layout.title + " | " + layout.files + " |\n";
  EXPECT_NE(manual.find(table + "\n"), std::string::npos) << "docs/formats.md should have:\n" << table;
}

TEST(CaptureLayouts, TheReadmeNamesThoseThatAreThere) {
  const std::string readme = read_file(std::string(ALIGNGS_SOURCE_DIR) + "/README.md");
  const size_t call = readme.find("aligngs import scan -o scene"), begin = readme.find("# ", call) + 2;
  const size_t end = readme.find(" and others\n", begin);
  ASSERT_LT(end, readme.find('\n', begin)) << "README.md lists layouts behind its first import";
  std::stringstream list(readme.substr(begin, end - begin));
  for (std::string title; std::getline(list, title, ',');) {
    title.erase(0, title.find_first_not_of(' '));
    const bool found = std::any_of(capture_layouts().begin(), capture_layouts().end(),
                                   [&](const auto& layout) { return std::string(layout.title).starts_with(title); });
    EXPECT_TRUE(found) << "README.md names \"" << title << "\", and no layout has this title";
  }
}

TEST(CaptureLayouts, AnUnknownFolderIsToldAllOfThem) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "no_layout";
  std::filesystem::create_directories(folder);
  try {
    read_capture(folder);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
    for (const CaptureLayout& layout : capture_layouts())
      EXPECT_NE(error.details().remedy.find(layout.files), std::string::npos) << layout.name;
  }
}

TEST(CaptureLayouts, PosesOfAllPhotosInOneArrayAreNamed) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "poses_in_one_array";
  write_file_atomically(folder / "images" / "a.jpg", "x");
  write_file_atomically(folder / "poses.npy", "x");
  try {
    read_capture(folder);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(error.details().remedy.find("poses/"), std::string::npos) << error.what();
  }
}

TEST(CaptureLayouts, AnUnknownNameIsAUsageError) {
  try {
    read_capture(testing::TempDir(), {.layout = "rgdb"});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  }
}

TEST(CaptureLayouts, FoldersOfPhotosThatAreCalledLikeSequencesAreNoCapture) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "photos_in_sequences";
  write_file_atomically(folder / "seq-01" / "a.jpg", "x");
  EXPECT_EQ(recognise_layout(folder), nullptr);
  EXPECT_NO_THROW(refuse_posed_capture(folder, ""));
  write_file_atomically(folder / "seq-01" / "frame-000000.pose.txt", "x");
  ASSERT_NE(recognise_layout(folder), nullptr);
  EXPECT_STREQ(recognise_layout(folder)->name, "7scenes");
  EXPECT_THROW(refuse_posed_capture(folder, ""), Error);
}

}  // namespace
}  // namespace aligngs
