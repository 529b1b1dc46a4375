#include "io/output_place.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <vector>

#include "core/testing/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class OutputPlace : public testing::Test {
 protected:
  void SetUp() override {
    base_ =
        fs::path(testing::TempDir()) / "output_place" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(base_);
    fs::create_directories(base_ / "capture" / "images");
    fs::create_directories(base_ / "other");
  }
  bool apart(const fs::path& output, const fs::path& source) const {
    try {
      require_apart(base_ / output, {base_ / source});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      return false;
    }
    return true;
  }
  fs::path base_;
};

TEST_F(OutputPlace, AFolderBesideTheSourceIsApart) {
  EXPECT_TRUE(apart("scene", "capture"));
  EXPECT_TRUE(apart("capture2", "capture")) << "a common beginning of the name is no common folder";
  EXPECT_TRUE(apart("other/deep/down", "capture"));
}

TEST_F(OutputPlace, TheSourceWhatLiesInItAndWhatHoldsItAreNot) {
  for (const char* output : {"capture", "capture/", "capture/scene", "capture/images/new/deep", "."})
    EXPECT_FALSE(apart(output, "capture")) << output;
}

TEST_F(OutputPlace, DotsDoNotHideTheSource) {
  for (const char* output : {"other/../capture", "./capture/.", "other/../capture/images/../scene"})
    EXPECT_FALSE(apart(output, "capture")) << output;
  EXPECT_TRUE(apart("capture/../scene", "capture"));
}

TEST_F(OutputPlace, LinksDoNotHideTheSource) {
  fs::create_directory_symlink(base_ / "capture", base_ / "link");
  fs::create_directory_symlink(base_ / "capture" / "images", base_ / "other" / "photos");
  EXPECT_FALSE(apart("link", "capture"));
  EXPECT_FALSE(apart("link/scene", "capture"));
  EXPECT_FALSE(apart("capture", "link"));
  EXPECT_FALSE(apart("other/photos/../scene", "capture")) << "beside what the link points to, which is in the capture";
}

TEST_F(OutputPlace, ALinkInTheOutputToTheSourceIsNoDanger) {
  fs::create_directory_symlink(base_ / "capture", base_ / "other" / "data");
  EXPECT_TRUE(apart("other", "capture")) << "replacing the folder removes the link, not what it points to";
}

TEST_F(OutputPlace, ASourceMayBeAbsent) { EXPECT_NO_THROW(require_apart(base_ / "capture", {fs::path()})); }

TEST_F(OutputPlace, RealPlaceKeepsWhatIsNotThereYet) {
  EXPECT_EQ(real_place(base_ / "new" / "deep" / ""), fs::canonical(base_) / "new" / "deep");
  EXPECT_EQ(real_place("/"), "/");
}

TEST_F(OutputPlace, OnlyAFileOrNothingIsReplacedByAFile) {
  const auto kind = [](const fs::path& file) -> std::optional<ErrorKind> {
    try {
      require_file_place(file);
    } catch (const Error& error) {
      return error.kind();
    }
    return std::nullopt;
  };
  write_file_atomically(base_ / "file", "x");
  fs::create_symlink(base_ / "file", base_ / "link");
  ASSERT_EQ(mkfifo((base_ / "pipe").c_str(), 0600), 0);
  for (const fs::path& good : {base_ / "file", base_ / "link", base_ / "new", base_ / "new" / "deep"})
    EXPECT_EQ(kind(good), std::nullopt) << good;
  for (const fs::path& bad : {base_ / "pipe", base_, base_ / "", fs::path("/dev/null"), fs::path("-"), fs::path()})
    EXPECT_EQ(kind(bad), ErrorKind::kUsage) << bad;
}

TEST(OutputExtension, ANameThatPromisesAnotherFormatIsAUsageError) {
  using Names = std::vector<std::pair<const char*, const char*>>;
  for (const auto& [file, format] : Names{{"a.glb", "glb"},
                                          {"a.GLB", "glb"},
                                          {"a.labels.ply", "labels.ply"},
                                          {"a.ply", "labels.ply"},
                                          {"a.labels.ply", "LABELS.PLY"},
                                          {"a.collision.glb", "collision.glb"},
                                          {"a", "spz"},
                                          {"room.v2", "obj"},
                                          {"page.htm", "html"},
                                          {"folder.obj/a", "spz"}}) {
    EXPECT_NO_THROW(require_extension(file, format)) << file;
  }
  for (const auto& [file, format] : Names{{"a.spz", "glb"},
                                          {"a.gltf", "glb"},
                                          {"a.OBJ", "ply"},
                                          {"a.ply", "splat"},
                                          {"a.html", "sog"},
                                          {"a.labels.ply", "ply"},
                                          {"a.Collision.glb", "glb"}}) {
    try {
      require_extension(file, format);
      ADD_FAILURE() << file;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
    }
  }
}

TEST_F(OutputPlace, TheNameOfAnotherKindOfFileIsRefused) {
  for (const char* other : {"rooms.tsv", "film.mp4", "photo.HEIC", "points3D.bin", "config.toml", "notes.txt"})
    EXPECT_THROW(require_extension(other, "csv"), Error) << other;
  for (const char* fine : {"rooms.csv", "rooms", "rooms.v2"}) EXPECT_NO_THROW(require_extension(fine, "csv")) << fine;
}

TEST_F(OutputPlace, AFileOfAnotherKindIsNeverReplaced) {
  for (const char* mine : {"database.db", "LICENSE", "notes.md"}) {
    write_file_atomically(base_ / mine, "of the user");
    EXPECT_THROW(require_extension(base_ / mine, "ply"), Error) << mine;
    EXPECT_THROW(require_extension(base_ / mine, "splat"), Error) << mine;
  }
  write_file_atomically(base_ / "room", "ply\nformat");
  EXPECT_NO_THROW(require_extension(base_ / "room", "labels.ply")) << "an earlier export";
}

TEST_F(OutputPlace, AFolderThatCannotBeMadeIsAnError) {
  EXPECT_THAT(error_of(ErrorKind::kResources, [] { require_folder_place("/proc/aligngs"); }),
              testing::HasSubstr("/proc/aligngs: the folder cannot be created"));
}

TEST_F(OutputPlace, AFileIsRefusedWhoseFolderCannotBeMade) {
  EXPECT_THAT(error_of(ErrorKind::kResources, [] { require_output_file("/proc/aligngs/room.ply"); }),
              testing::HasSubstr("/proc/aligngs: the folder cannot be created"));
  EXPECT_THROW(require_output_file(base_), Error) << "a folder";
  require_output_file(base_ / "new" / "room.ply");
  EXPECT_FALSE(fs::exists(base_ / "new")) << "nothing is left behind";
}

TEST_F(OutputPlace, AFileIsRefusedWhoseFolderTakesNone) {
  const fs::path closed = fs::temp_directory_path() / ("aligngs_closed_" + std::to_string(::getpid()));
  fs::create_directories(closed);
  fs::permissions(closed, fs::perms(0555));
  constexpr uid_t kNobody = 65534;
  const bool root = ::geteuid() == 0;  // protection does not bind root
  ASSERT_TRUE(!root || ::seteuid(kNobody) == 0);
  const std::string message = error_of(ErrorKind::kResources, [&] { require_output_file(closed / "room.ply"); });
  ASSERT_TRUE(!root || ::seteuid(0) == 0);
  EXPECT_THAT(message, testing::HasSubstr("Permission denied"));
  fs::remove_all(closed);
}

TEST_F(OutputPlace, StandardOutputIsNoFolder) {
  EXPECT_THAT(error_of(ErrorKind::kUsage, [] { require_folder_place("-"); }),
              testing::HasSubstr("no name of a folder"));
}

TEST_F(OutputPlace, AFileInTheWayOfAFolderIsNamed) {
  write_file_atomically(base_ / "file", "x");
  EXPECT_THAT(error_of(ErrorKind::kUsage, [&] { require_folder_place(base_ / "file" / "scene"); }),
              testing::HasSubstr("there is a file in its way"));
}

TEST_F(OutputPlace, TheCheckOfAFolderLeavesNothing) {
  write_file_atomically(base_ / "file", "x");
  require_folder_place(base_ / "new" / "scene");
  std::vector<std::string> entries;
  for (const auto& entry : fs::directory_iterator(base_)) entries.push_back(entry.path().filename().string());
  EXPECT_THAT(entries, testing::UnorderedElementsAre("file", "capture", "other"));
}

}  // namespace
}  // namespace aligngs
