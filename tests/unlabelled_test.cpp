// A run whose scene has no labels: all of it works but selecting by name.
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

class Unlabelled : public testing::Test {
 protected:
  static fs::path root() { return fs::path(testing::TempDir()) / "unlabelled"; }
  static std::string quoted(const fs::path& path) { return "'" + path.string() + "'"; }
  static ProcessResult aligngs(const std::string& arguments) {
    return run_aligngs(arguments + " -q", root() / "scratch");
  }
  static fs::path trained() { return root() / "run"; }

  static void SetUpTestSuite() {
    fs::remove_all(root());
    testing_support::write_small_scene(root() / "scene");
    fs::remove_all(root() / "scene" / "segmentation_logits");
    ASSERT_EQ(aligngs("train " + quoted(root() / "scene") + " -o " + quoted(trained()) + " -n 40").status, 0);
    ASSERT_EQ(aligngs("mesh " + quoted(trained()) + " --set mesh.voxel=0.05").status, 0);
  }
};

TEST_F(Unlabelled, EveryFormatIsExported) {
  for (const char* format : {"ply", "glb", "obj", "sog", "spz", "splat", "html"}) {
    const fs::path file = root() / (std::string("room.") + format);
    const ProcessResult result =
        aligngs("export " + quoted(trained()) + " --json -f " + format + " -o " + quoted(file));
    ASSERT_EQ(result.status, 0) << format << result.err;
    EXPECT_GT(fs::file_size(file), 1000u) << format;
    const size_t objects = std::string(format) == "glb" || std::string(format) == "obj" ? 1 : 0;
    EXPECT_EQ(parse_json(result.out)["objects"].get<size_t>(), objects) << format;
  }
}

TEST_F(Unlabelled, OnlyTheLabelsThemselvesAndNamesAreRefused) {
  for (const char* arguments : {"export RUN -f labels.ply", "edit RUN --select bed --delete"}) {
    std::string command = arguments;
    command.replace(command.find("RUN"), 3, quoted(trained()));
    const ProcessResult result = aligngs(command);
    EXPECT_EQ(result.status, 3) << command;
    EXPECT_THAT(result.err, HasSubstr("trained without semantics")) << command;
  }
  EXPECT_FALSE(fs::exists(trained() / "edits.json"));
}

TEST_F(Unlabelled, WallsAreMeasuredAndAPlanIsDrawn) {
  const fs::path copy = root() / "measured";
  fs::copy(trained(), copy, fs::copy_options::recursive);
  const std::string plan = "export " + quoted(copy) + " -f plan.svg";
  const ProcessResult early = aligngs(plan);
  EXPECT_EQ(early.status, 3);
  EXPECT_THAT(early.err, HasSubstr("aligngs room"));
  const ProcessResult measured = aligngs("room " + quoted(copy) + " --json");
  ASSERT_EQ(measured.status, 0) << measured.err;
  const nlohmann::json room = parse_json(measured.out);
  EXPECT_EQ(room["found_by"], "geometry");
  EXPECT_TRUE(room["openings"].empty());
  EXPECT_TRUE(room["objects"].empty());
  EXPECT_EQ(aligngs(plan).status, 0);
  EXPECT_TRUE(fs::exists(copy / "plan.svg"));
  EXPECT_EQ(aligngs("scale " + quoted(copy) + " --object ceiling --height 2.5").status, 0);
  EXPECT_EQ(aligngs("export " + quoted(copy) + " -f ply").status, 0);
}

/// Splats at random places are no wall.
TEST_F(Unlabelled, ARoomWithoutWallsIsRefused) {
  const fs::path run = root() / "bare";
  ASSERT_EQ(
      aligngs("train " + quoted(root() / "scene") + " -o " + quoted(run) + " -n 1 --set init.start=random").status, 0);
  const ProcessResult result = aligngs("room " + quoted(run));
  EXPECT_EQ(result.status, 3) << result.out;
  EXPECT_THAT(result.err, HasSubstr("remedy"));
  EXPECT_FALSE(fs::exists(run / "room.json"));
}

TEST_F(Unlabelled, TheWholeRoomIsListedAndEdited) {
  const fs::path copy = root() / "edited";
  fs::copy(trained(), copy, fs::copy_options::recursive);
  EXPECT_EQ(aligngs("edit " + quoted(copy) + " --list").status, 0);
  const ProcessResult edited = aligngs("edit " + quoted(copy) + " --select everything --highlight '#ff0000'");
  EXPECT_EQ(edited.status, 0) << edited.err;
  EXPECT_EQ(aligngs("export " + quoted(copy) + " -f ply").status, 0);
  EXPECT_FALSE(read_file(copy / "scene.edited.ply") == read_file(copy / "scene.ply"));
  EXPECT_EQ(aligngs("export " + quoted(copy) + " -f spz").status, 0);
  EXPECT_TRUE(fs::exists(copy / "scene.edited.spz"));
}

TEST_F(Unlabelled, ARunTooSmallForASurfaceEndsWithItsReport) {
  const fs::path run = root() / "tiny";
  const ProcessResult result = run_aligngs(
      "run " + quoted(root() / "scene") + " -o " + quoted(run) + " -n 1 --no-refine --set mesh.max_depth=0.01",
      root() / "scratch");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("no surface"));
  EXPECT_TRUE(fs::exists(run / "report.html"));
  EXPECT_THAT(read_file(run / "report.html"), HasSubstr("no surface"));
  EXPECT_FALSE(fs::exists(run / "mesh" / "mesh.ply"));
}

}  // namespace
}  // namespace aligngs
