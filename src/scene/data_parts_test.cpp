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
  for (const char* place : {"images", "images/new", "depth", "sparse/0/run"}) {
    EXPECT_EQ(data_set_with_part(data / place), data) << place;
    EXPECT_THROW(require_outside_of_data(data / place), Error) << place;
  }
}

TEST(DataParts, OtherFoldersOfADataSetAreFree) {
  const fs::path data = data_set("others");
  for (const char* place : {"run", "out/run", "../images"})
    EXPECT_NO_THROW(require_outside_of_data(data / place)) << place;
}

TEST(DataParts, PlacesInFoldersThatAreStillToComeAreFree) {
  EXPECT_NO_THROW(require_outside_of_data(data_set("to_come") / "new" / "runs" / "depth"));
  EXPECT_NO_THROW(require_outside_of_data("nowhere/depth"));
}

}  // namespace
}  // namespace aligngs
