#include "scene/scene_place.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/folder_replacement.h"
#include "scene/scene_json.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ScenePlace : public testing::Test {
 protected:
  void SetUp() override {
    base_ =
        fs::path(testing::TempDir()) / "scene_place" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(base_);
    fs::create_directories(base_ / "folder");
  }
  /// Empty when the folder may be taken, else why not.
  std::string refusal(bool overwrite, const std::vector<fs::path>& sources = {}) const {
    try {
      require_scene_place(base_ / "folder", overwrite, sources);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      return error.what();
    }
    return "";
  }
  fs::path base_;
};

TEST_F(ScenePlace, WhatIsAbsentOrEmptyIsFree) {
  EXPECT_EQ(refusal(false), "");
  fs::remove(base_ / "folder");
  EXPECT_EQ(refusal(false), "");
}

TEST_F(ScenePlace, AnOwnSceneIsReplacedOnlyWhenAsked) {
  write_scene_json(base_ / "folder" / "scene.json", {});
  EXPECT_THAT(refusal(false), HasSubstr("--overwrite"));
  EXPECT_EQ(refusal(true), "");
}

TEST_F(ScenePlace, AFolderWithoutTheMarkIsNeverReplaced) {
  fs::create_directories(base_ / "folder" / "sparse");
  EXPECT_THAT(refusal(true), HasSubstr("never replaced")) << "a COLMAP folder";
  write_file_atomically(base_ / "folder" / "scene.json", "{\"units\": \"metres\"}");
  EXPECT_THAT(refusal(true), HasSubstr("never replaced")) << "a scene written by hand";
  for (const char* text : {"[]", "{", "{\"written_by\": \"somebody\"}", "{\"written_by\": 7}"}) {
    write_file_atomically(base_ / "folder" / "scene.json", text);
    EXPECT_THAT(refusal(true), HasSubstr("never replaced")) << text;
  }
}

TEST_F(ScenePlace, TheMarkLeavesOtherFieldsAlone) {
  write_file_atomically(base_ / "folder" / "scene.json", "{\"units\": \"metres\", \"note\": [1, 2]}");
  mark_as_own(base_ / "folder");
  EXPECT_TRUE(is_own_scene(base_ / "folder"));
  EXPECT_TRUE(read_scene_json(base_ / "folder" / "scene.json").metric);
  EXPECT_THAT(read_file(base_ / "folder" / "scene.json"), HasSubstr("\"note\""));
}

TEST_F(ScenePlace, FilesOfOthersStayWhenASceneIsReplaced) {
  const fs::path scene = base_ / "folder";
  write_scene_json(scene / "scene.json", {});
  write_file_atomically(scene / "sparse" / "cameras.bin", "former");
  write_file_atomically(scene / "notes.txt", "mine");
  write_file_atomically(scene / "my photos" / "a.jpg", "photo");
  fs::create_symlink("nowhere", scene / "link");
  FolderReplacement replacement(scene);
  write_scene_json(replacement.path() / "scene.json", {});
  write_file_atomically(replacement.path() / "notes.txt", "of the source, which was copied");
  place_scene(replacement, true);
  EXPECT_EQ(read_file(scene / "notes.txt"), "mine");
  EXPECT_EQ(read_file(scene / "my photos" / "a.jpg"), "photo");
  EXPECT_TRUE(fs::is_symlink(scene / "link"));
  EXPECT_FALSE(fs::exists(scene / "sparse")) << "a part of the former scene";
}

TEST_F(ScenePlace, MasksOfAReplacedSceneAreKeptAsideWhereTheNewOneHasNone) {
  const fs::path scene = base_ / "folder";
  for (const char* name : {"masks.old", "masks.old-2"}) {
    write_scene_json(scene / "scene.json", {});
    write_file_atomically(scene / "masks" / "a.png", "drawn by hand");
    FolderReplacement replacement(scene);
    write_scene_json(replacement.path() / "scene.json", {});
    place_scene(replacement, true);
    EXPECT_EQ(read_file(scene / name / "a.png"), "drawn by hand");
    EXPECT_FALSE(fs::exists(scene / "masks")) << "the new photos are perhaps others";
  }
  write_file_atomically(scene / "masks" / "a.png", "former");
  FolderReplacement replacement(scene);
  write_scene_json(replacement.path() / "scene.json", {});
  write_file_atomically(replacement.path() / "masks" / "a.png", "new");
  place_scene(replacement, true);
  EXPECT_EQ(read_file(scene / "masks" / "a.png"), "new");
  EXPECT_FALSE(fs::exists(scene / "masks.old-3"));
}

TEST_F(ScenePlace, NotEvenAnOwnSceneThatIsASourceIsReplaced) {
  write_scene_json(base_ / "folder" / "scene.json", {});
  fs::create_directories(base_ / "folder" / "images");
  EXPECT_THAT(refusal(true, {base_ / "folder"}), HasSubstr("source"));
  EXPECT_THAT(refusal(true, {base_ / "folder" / "images"}), HasSubstr("source"));
}

TEST_F(ScenePlace, FilesAndLinksToNothingAreNoPlace) {
  fs::remove(base_ / "folder");
  fs::create_symlink(base_ / "nowhere", base_ / "folder");
  EXPECT_THAT(refusal(true), HasSubstr("link to nothing"));
  fs::remove(base_ / "folder");
  write_file_atomically(base_ / "folder", "text");
  EXPECT_THAT(refusal(true), HasSubstr("this is a file"));
}

TEST_F(ScenePlace, PartsOfADataSetAreNoPlace) {
  fs::create_directories(base_ / "folder" / "sparse" / "0");
  for (const char* name : {"cameras.txt", "images.txt", "points3D.txt"})
    write_file_atomically(base_ / "folder" / "sparse" / "0" / name, "# none\n");
  for (const char* part : {"sparse/0/scene", "images/scene", "depth"})
    EXPECT_THROW(require_scene_place(base_ / "folder" / part, true), Error) << part;
  EXPECT_NO_THROW(require_scene_place(base_ / "folder" / "scene", true));
  EXPECT_NO_THROW(require_scene_place(base_ / "sparse" / "scene", true)) << "no data set";
}

}  // namespace
}  // namespace aligngs
