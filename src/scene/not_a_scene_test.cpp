#include "scene/not_a_scene.h"

#include <gmock/gmock.h>

#include "core/error.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class NotAScene : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "not_a_scene";
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  std::string refusal() const {
    try {
      refuse_what_is_no_scene(folder_, "runs/one");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      return error.what();
    }
    return "";
  }
  fs::path folder_;
};

TEST_F(NotAScene, ARunNamesItsScene) {
  write_file_atomically(folder_ / "run.json", R"({"scene": "../../scenes/my room", "fingerprint": "0"})");
  write_file_atomically(folder_ / "sparse" / "0" / "cameras.bin", "x");
  EXPECT_THAT(refusal(), HasSubstr("this is a run of aligngs"));
  EXPECT_THAT(refusal(), HasSubstr("'scenes/my room'"));
}

TEST_F(NotAScene, ATransformsFileNamesTheImport) {
  write_file_atomically(folder_ / "transforms.json", "{}");
  EXPECT_THAT(refusal(), HasSubstr("aligngs import runs/one -o SCENE"));
}

TEST_F(NotAScene, ACaptureNamesItsLayoutAndTheImport) {
  write_file_atomically(folder_ / "rgb.txt", "");
  write_file_atomically(folder_ / "groundtruth.txt", "");
  EXPECT_THAT(refusal(), HasSubstr("this is a capture (TUM RGB-D)"));
  EXPECT_THAT(refusal(), HasSubstr("aligngs import runs/one -o SCENE"));
}

TEST_F(NotAScene, OtherFoldersPass) {
  EXPECT_EQ(refusal(), "");
  for (const char* others : {"[", "[]", R"({"scene": 3})", R"({"scene": "x"})"}) {
    write_file_atomically(folder_ / "run.json", others);
    EXPECT_EQ(refusal(), "") << others;
  }
}

}  // namespace
}  // namespace aligngs
