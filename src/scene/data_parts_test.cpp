#include "scene/data_parts.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// A nerfstudio data set in `name`.
fs::path data_set(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / "data_parts" / name;
  fs::create_directories(folder / "images");
  write_file_atomically(folder / "transforms.json", "{\"frames\": []}");
  return folder;
}

TEST(DataParts, PartsOfADataSetAndWhatLiesInThemBelongToIt) {
  const fs::path data = data_set("parts");
  for (const char* place :
       {"images", "images/new", "images_4", "Depth", "depth_filtered/run", "seq-01", "sparse/0/run"}) {
    EXPECT_EQ(data_set_with_part(data / place), data) << place;
    EXPECT_THROW(require_outside_of_data(data / place), Error) << place;
  }
}

TEST(DataParts, OtherFoldersOfADataSetAreFree) {
  const fs::path data = data_set("others");
  for (const char* place : {"run", "out/run", "../images"})
    EXPECT_NO_THROW(require_outside_of_data(data / place)) << place;
}

TEST(DataParts, NamesThatOnlyBeginLikeAPartAreFree) {
  const fs::path data = data_set("beginnings");
  for (const char* place : {"depth_run", "images_run/a", "depths.scene", "seq-new", "depth_2nd_try"})
    EXPECT_NO_THROW(require_outside_of_data(data / place)) << place;
}

TEST(DataParts, FoldersOfPicturesThatBeginLikeAPartBelongToTheDataSet) {
  const fs::path data = data_set("pictures");
  write_file_atomically(data / "images_undistorted" / "a.jpg", "x");
  write_file_atomically(data / "depth_raw" / "a.exr", "x");
  for (const char* place : {"images_undistorted", "images_undistorted/run", "depth_raw"})
    EXPECT_THROW(require_outside_of_data(data / place), Error) << place;
}

TEST(DataParts, ARunStaysFreeOnceItHasPictures) {
  const fs::path data = data_set("run_again");
  write_file_atomically(data / "depth_run" / "run.json", "{}");
  write_file_atomically(data / "depth_run" / "overview.jpg", "x");
  EXPECT_NO_THROW(require_outside_of_data(data / "depth_run"));
}

TEST(DataParts, PlacesInFoldersThatAreStillToComeAreFree) {
  EXPECT_NO_THROW(require_outside_of_data(data_set("to_come") / "new" / "runs" / "depth"));
  EXPECT_NO_THROW(require_outside_of_data("nowhere/depth"));
}

}  // namespace
}  // namespace aligngs
