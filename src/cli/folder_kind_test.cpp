#include "cli/folder_kind.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class FolderKindTest : public testing::Test {
 protected:
  FolderKindTest() {
    fs::remove_all(root());
    for (const char* file : {"run/run.json", "run/renders/test/rgb/a.png", "scene/scene.json", "scene/images/a.jpg",
                             "batch/list.json", "batch/leases/a", "batch/records/a", "other/a.txt"})
      write_file_atomically(root() / file, "{}");
  }
  static fs::path root() {
    return fs::path(testing::TempDir()) /
           (std::string("folder_kind_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  static std::string refusal(const char* name) {
    try {
      require_run_of(root() / name);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      return error.what();
    }
    return "";
  }
};

TEST_F(FolderKindTest, EachKindIsKnownByItsFiles) {
  const std::pair<const char*, FolderKind> kinds[] = {{"run", FolderKind::kRun},
                                                      {"scene", FolderKind::kScene},
                                                      {"batch", FolderKind::kBatch},
                                                      {"run/renders/test/rgb", FolderKind::kPartOfRun},
                                                      {"scene/images", FolderKind::kPartOfScene},
                                                      {"other", FolderKind::kOther},
                                                      {"other/a.txt", FolderKind::kFile},
                                                      {"absent", FolderKind::kAbsent}};
  for (const auto& [name, kind] : kinds) EXPECT_EQ(kind_of_folder(root() / name), kind) << name;
}

TEST_F(FolderKindTest, AnErrorSaysWhatTheFolderIs) {
  EXPECT_EQ(refusal("run"), "");
  EXPECT_THAT(refusal("absent"), HasSubstr("there is no such folder"));
  EXPECT_THAT(refusal("scene"), HasSubstr("this is a scene folder, not a run folder"));
  EXPECT_THAT(refusal("batch"), HasSubstr("this is the folder of a batch"));
  EXPECT_THAT(refusal("run/renders"), HasSubstr("a part of the run"));
  EXPECT_THAT(refusal("other"), HasSubstr("this is not a run folder"));
}

}  // namespace
}  // namespace aligngs
