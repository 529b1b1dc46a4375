#include "train/replaceable_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/drawn_picture.h"
#include "io/image_file.h"
#include "scene/scene_place.h"
#include "train/run_folder.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class ReplaceableFile : public testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::path(testing::TempDir()) / "replaceable_file";
    fs::remove_all(base_);
    fs::create_directories(base_);
  }
  fs::path written(const fs::path& name) const {
    fs::create_directories((base_ / name).parent_path());
    std::ofstream(base_ / name) << "x";
    return base_ / name;
  }
  fs::path written(const fs::path& name, const std::string& content) const {
    write_file_atomically(written(name), content);
    return base_ / name;
  }
  static bool free(const fs::path& file, std::string_view own_beginning = {}) {
    try {
      require_replaceable(file, own_beginning);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      return false;
    }
    return true;
  }
  fs::path base_;
};

TEST_F(ReplaceableFile, NothingAndPlainFilesAreFree) {
  EXPECT_TRUE(free(base_ / "absent.png"));
  EXPECT_TRUE(free(written("room.glb")));
  EXPECT_TRUE(free(written("table.csv")));
}

TEST_F(ReplaceableFile, APhotoIsNotAndADrawnPictureIs) {
  write_png(base_ / "photo.png", Image<uint8_t>(4, 4, 3, 9));
  write_drawn_picture(base_ / "drawn.png", Image<uint8_t>(4, 4, 3, 9));
  fs::create_symlink(base_ / "photo.png", base_ / "link.png");
  EXPECT_FALSE(free(base_ / "photo.png"));
  EXPECT_FALSE(free(base_ / "link.png"));
  EXPECT_FALSE(free(written("holiday.MP4")));
  EXPECT_TRUE(free(base_ / "drawn.png"));
}

TEST_F(ReplaceableFile, FilesOfAnotherRunAreNotButItsExportsAre) {
  fs::create_directories(base_ / "run");
  write_run_record(base_ / "run" / "run.json", RunRecord{});
  written("run/transforms.json");
  for (const char* own : {"run/scene.ply", "run/mesh/mesh.ply", "run/scene/sparse/points3D.ply"})
    EXPECT_FALSE(free(written(own))) << own;
  for (const char* other : {"run/scene.export.ply", "run/scene.glb"}) EXPECT_TRUE(free(written(other))) << other;
}

TEST_F(ReplaceableFile, FilesOfASceneAreNot) {
  fs::create_directories(base_ / "scene" / "sparse");
  mark_as_own(base_ / "scene");
  EXPECT_FALSE(free(written("scene/sparse/points3D.ply")));
  EXPECT_FALSE(free(written("scene/notes.txt")));
}

TEST_F(ReplaceableFile, FilesOfADataSetAreNotButExportsBesideThemAre) {
  for (const char* file : {"data/sparse/0/cameras.txt", "data/sparse/0/images.txt", "data/images/a.jpg"}) written(file);
  EXPECT_FALSE(free(written("data/sparse/0/points3D.ply")));
  EXPECT_FALSE(free(written("data/meshes/bought.glb")));
  EXPECT_FALSE(free(written("data/cloud.ply")));
  EXPECT_TRUE(free(written("data/room.glb")));
  EXPECT_TRUE(free(base_ / "data" / "meshes" / "new.ply"));
  EXPECT_FALSE(free(base_ / "data" / "sparse" / "0" / "new.ply")) << "a file more would be part of the data set";
  EXPECT_FALSE(free(base_ / "data" / "images" / "renders"));
}

TEST_F(ReplaceableFile, ATableIsFreeIfItBeginsAsTheProgramsOwn) {
  for (const char* file : {"data/sparse/0/cameras.txt", "data/sparse/0/images.txt", "data/images/a.jpg"}) written(file);
  for (const char* place : {"own.csv", "data/own.csv", "data/tables/own.csv"})
    EXPECT_TRUE(free(written(place, "run,psnr\none,30\n"), "run,psnr\n")) << place;
  for (const char* place : {"other.csv", "data/other.csv", "data/tables/other.csv"})
    EXPECT_FALSE(free(written(place, "run,psnr,notes\n"), "run,psnr\n")) << place;
  EXPECT_FALSE(free(written("data/sparse/0/own.csv", "run,psnr\n"), "run,psnr\n")) << "part of the data set";
  EXPECT_TRUE(free(base_ / "absent.csv", "run,psnr\n"));
}

TEST_F(ReplaceableFile, APageIsFreeIfItsTitleNamesTheProgram) {
  EXPECT_TRUE(free(written("own.html", "<!doctype html><title>aligngs: comparison</title>")));
  EXPECT_FALSE(free(written("recipe.HTM", "<!doctype html><title>Soup</title>")));
}

}  // namespace
}  // namespace aligngs
