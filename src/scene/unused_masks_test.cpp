#include "scene/unused_masks.h"

#include <gmock/gmock.h>

#include <fstream>

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

class UnusedMasks : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             ("unused_masks_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
  }
  fs::path file(const std::string& name) const {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << "x";
    return folder / name;
  }
  /// The only warning, with its remedy; empty: none.
  std::string warning(const std::vector<fs::path>& photos, const std::vector<fs::path>& named = {}) const {
    const std::vector<SceneProblem> problems = unused_masks(folder, photos, named);
    EXPECT_LE(problems.size(), 1u);
    return problems.empty() ? "" : text_of_unused_masks(problems[0]);
  }
  fs::path folder;
};

TEST_F(UnusedMasks, MasksOfAllPhotosGiveNoWarning) {
  const fs::path a = file("images/a.jpg"), b = file("images/left/b.jpg");
  file("masks/a.jpg.png");
  file("masks/left/b.png");
  EXPECT_EQ(warning({a, b}), "");
}

TEST_F(UnusedMasks, OneThatFitsNoPhotoIsNamedWithTheRule) {
  const fs::path a = file("images/a.jpg");
  file("masks/IMG_1.png");
  EXPECT_THAT(warning({a}), HasSubstr("a mask in masks/ fits no photo: IMG_1.png"));
  EXPECT_THAT(warning({a}), HasSubstr("images/a.jpg has masks/a.jpg.png or masks/a.png"));
}

TEST_F(UnusedMasks, SeveralAreCountedWithAnExample) {
  const fs::path a = file("images/a.jpg");
  file("masks/a.png");
  for (int i = 0; i < 10; ++i) file("masks/IMG_" + std::to_string(i) + ".png");
  EXPECT_THAT(warning({a}), HasSubstr("10 masks in masks/ fit no photo, e.g. IMG_0.png"));
}

TEST_F(UnusedMasks, TheExtensionOfAnotherPhotoFitsNone) {
  const fs::path photo = file("images/view_000.png");
  file("masks/view_000.jpg.png");
  EXPECT_THAT(warning({photo}), HasSubstr("fits no photo: view_000.jpg.png"));
}

TEST_F(UnusedMasks, AFolderInCapitalsIsNamed) {
  const fs::path a = file("images/a.jpg");
  file("Masks/a.png");
  EXPECT_THAT(warning({a}), HasSubstr("1 picture is in Masks/ not used: the folder is not called masks/"));
}

TEST_F(UnusedMasks, AMaskThatAFileOfCamerasNamesIsUsed) {
  const fs::path a = file("images/a.jpg"), mask = file("mask/0001.png");
  EXPECT_EQ(warning({a}, {mask}), "");
}

TEST_F(UnusedMasks, AMaskOfAPhotoWithoutACameraFitsIt) {
  const fs::path a = file("images/a.jpg");
  file("images/b.jpg");
  file("masks/b.png");
  EXPECT_EQ(warning({a}), "");
}

TEST_F(UnusedMasks, ThoseBesideTheFolderOfImagesCount) {
  const fs::path a = file("images/a.jpg");
  file("masks/b.png");
  EXPECT_EQ(unused_masks(folder / "images", {a}).size(), 1u);
}

TEST_F(UnusedMasks, ThoseOfOthersDoNot) {
  const fs::path a = file("capture/images/a.jpg");
  file("masks/b.png");
  EXPECT_THAT(unused_masks(folder / "capture", {a}), IsEmpty());
}

}  // namespace
}  // namespace aligngs
