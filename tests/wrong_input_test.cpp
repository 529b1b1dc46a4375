// Files, folders and options that a command cannot use, as a user names them by mistake.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "io/atomic_file.h"
#include "io/json_text.h"
#include "support/process.h"
#include "support/small_scene.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ProcessResult;
using testing_support::run_aligngs;

class WrongInput : public testing::Test {
 protected:
  static fs::path root() { return fs::path(testing::TempDir()) / "wrong_input"; }
  static fs::path run() { return root() / "run"; }
  static std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }
  static ProcessResult aligngs(const std::string& arguments) { return run_aligngs(arguments, root() / "scratch"); }

  static void SetUpTestSuite() {
    fs::remove_all(root());
    testing_support::write_small_scene(root() / "scene");
    ASSERT_EQ(aligngs("train " + quoted(root() / "scene") + " -o " + quoted(run()) + " -n 20 -q").status, 0);
    ASSERT_EQ(aligngs("mesh " + quoted(run()) + " -q --set mesh.voxel=0.1").status, 0);
    write_file_atomically(run() / "metrics.json", "{}");
  }
  static void expect(const std::string& arguments, int status, const char* words) {
    const ProcessResult result = aligngs(arguments);
    EXPECT_EQ(result.status, status) << arguments << result.err;
    EXPECT_THAT(result.err, HasSubstr(words)) << arguments;
  }
};

TEST_F(WrongInput, MeshesThatAreNotThereLeaveTheFigures) {
  expect("eval " + quoted(run()) + " --gt-mesh typo.ply", 3, "typo.ply: --gt-mesh");
  expect("eval " + quoted(run()) + " --mesh nope.ply", 3, "nope.ply: --mesh");
  EXPECT_EQ(read_file(run() / "metrics.json"), "{}");
}

TEST_F(WrongInput, AFileWithoutSplatsIsNotShown) {
  write_file_atomically(root() / "text.ply", "not a ply");
  expect("view " + quoted(root() / "text.ply"), 3, "text.ply");
  expect("view " + quoted(run() / "mesh" / "mesh.ply"), 3, "vertex: no property");
}

TEST_F(WrongInput, AFolderIsCalledByItsKind) {
  expect("info " + quoted(run() / "mesh"), 3, "a part of the run");
  expect("compare " + quoted(run()) + " " + quoted(root() / "scene"), 3, "this is a scene folder");
  expect("compare " + quoted(run()) + " " + quoted(root() / "nope"), 3, "there is no such folder");
}

TEST_F(WrongInput, OptionsThatDoNothingAreRefused) {
  expect("mesh " + quoted(run()) + " --set loss.ssim=0.3", 2, "has no effect on a mesh");
  expect("export " + quoted(run()) + " -f glb --texture-size 512", 2, "--texture-size is for");
}

TEST_F(WrongInput, InfoTellsOfEditsAndOfUnusableFiles) {
  ASSERT_EQ(aligngs("edit " + quoted(run()) + " -q --select bed --recolor red").status, 0);
  const nlohmann::json told = parse_json(aligngs("info --json " + quoted(run())).out);
  EXPECT_EQ(told["edit_count"], 1);
  EXPECT_THAT(told["edits"][0].get<std::string>(), HasSubstr("recolor bed"));
  write_file_atomically(root() / "few.ply",
                        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                        "property float z\nproperty float scale_0\nproperty float rot_0\nend_header\n1 2 3 4 5\n");
  EXPECT_THAT(aligngs("info " + quoted(root() / "few.ply")).out, HasSubstr("not_usable: vertex: no property"));
}

}  // namespace
}  // namespace aligngs
